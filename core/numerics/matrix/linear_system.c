/* Linear systems through solver plugins: the choice of the solver, and its use.
 *
 * Where the scene names no solver, it is chosen by the flags of the installed solvers, the kind of the forces,
 * contact and the number of unknowns. Times are not measured, so runs are reproducible. It is opened before the first
 * step. Where a solver for matrices of a kind is preferred to it, that one is opened, and the other when a pattern
 * comes that does not fit; every new pattern decides between the two, as patterns change with births and contact.
 *
 * A pattern is recognised by its number or, without one, by its hash, not by its address, since a new pattern may be in
 * the memory of an old one. A matrix that is not declared symmetric is compared with its transpose before a solver that
 * relies on symmetry gets it; one pass, small beside the factorization. */

#include "core/engine/contract/contract.h"
#include "core/numerics/matrix/matrix.h"

#include <stdlib.h>
#include <string.h>

/* Unknowns. The factors of a surface of the first size take gigabytes. In contact every step has patterns of its own to
 * analyse, and layers that lie on each other fill the factors: iterations take less time from a few thousand unknowns
 * on, half at 30,000, and ten sheets of 78,000 had no factors after a minute. There a residual of a tenth is asked for
 * with a matrix that is new each time: a factorization of many levels takes longer than it saves below the first size
 * (a cloth of 128 x 128: 112 + 29 ms, without levels 30 + 76). */
enum { LARGE = 300000, LARGE_IN_CONTACT = 10000 };

const double hk_asymmetry_limit = 1e-10; /* above rounding errors */

/* ---- choice ---- */

static bool needs_unsymmetric_solver(const hk_dynamics *d) {
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++) {
    const hk_force_tables *force = hk_force_of(d->plugins->kind[HK_FORCE].item[k]->plugin);
    if (force->implicit.jacobian && !(force->own.flags & (HK_SYMMETRIC_JACOBIAN | HK_OFFERS_SYMMETRIC))) return true;
  }
  return false;
}

static bool is_special(const hk_plugin *plugin) { return plugin->solver->fits != NULL; }

/* Rows of particles that are pinned are diagonal: a pinned body of many of them fills no factors. */
static size_t moving_unknowns(const hk_model *m) {
  size_t moving = 0;
  for (size_t i = 0; i < m->n; i++) moving += hk_model_moves(m, i);
  return 3 * moving;
}

static bool suits(const hk_plugin *plugin, const void *context) {
  const hk_dynamics *d = context;
  unsigned flags = plugin->solver->flags;
  if (is_special(plugin)) return false;
  if (d->plugins->kind[HK_CONSTRAINT].count)
    return needs_unsymmetric_solver(d) ? flags & HK_SOLVES_UNSYMMETRIC : !(flags & HK_ITERATIVE);
  if (needs_unsymmetric_solver(d)) return flags & HK_SOLVES_UNSYMMETRIC;
  if (3 * d->state->model.n > LARGE) return flags & HK_ITERATIVE;
  if (d->system.contact && moving_unknowns(&d->state->model) > LARGE_IN_CONTACT)
    return (flags & (HK_ITERATIVE | HK_MULTILEVEL)) == HK_ITERATIVE;
  return !(flags & HK_ITERATIVE);
}

static bool goes_first(const hk_plugin *plugin, const void *context) {
  return is_special(plugin) || suits(plugin, context);
}

static hk_status start(hk_dynamics *d, hk_instance *solver) {
  hk_view view = hk_instance_view(solver, &d->state->view);
  hk_status status = hk_instance_set_time(solver, d->state->t, d->error);
  return status == HK_OK ? hk_instance_start(solver, &view, d->state->size, d->error) : status;
}

static hk_status choose(hk_dynamics *d, bool (*criterion)(const hk_plugin *, const void *), hk_plugin_spec **spec) {
  const hk_plugin *plugin;
  hk_status status = hk_registry_prefer(d->shared->registry, HK_SOLVER, criterion, d, &plugin, d->error);
  if (status != HK_OK) return status;
  *spec = hk_spec_create(plugin, plugin->name, "", d->error);
  return *spec ? HK_OK : HK_NO_MEMORY;
}

static hk_status choose_first(hk_dynamics *d) {
  hk_status status = choose(d, goes_first, &d->solver_spec);
  if (status != HK_OK || !is_special(d->solver_spec->plugin)) return status;
  d->special_spec = d->solver_spec;
  d->solver_spec = NULL;
  return HK_OK;
}

static hk_status choose_any(hk_dynamics *d) {
  if (d->solver || d->solver_spec) return HK_OK;
  return choose(d, suits, &d->solver_spec);
}

static hk_status add(hk_dynamics *d, const hk_plugin_spec *spec, hk_instance **solver) {
  hk_status status = hk_plugins_add(d->plugins, spec, d->shared, solver, d->error);
  return status == HK_OK ? start(d, *solver) : status;
}

hk_status hk_solver_open(hk_dynamics *d, const hk_plugin_spec *named) {
  if (d->solver || d->special) return HK_OK;
  if (named) return add(d, named, &d->solver);
  hk_status status = choose_first(d);
  if (status != HK_OK) return status;
  if (d->special_spec && !needs_unsymmetric_solver(d)) return add(d, d->special_spec, &d->special);
  status = choose_any(d);
  return status == HK_OK ? add(d, d->solver_spec, &d->solver) : status;
}

static bool takes_saddle_points(const hk_plugin *plugin, const void *context) {
  const unsigned needed = HK_SOLVES_INDEFINITE | HK_SOLVES_UNSYMMETRIC;
  (void)context;
  return (plugin->solver->flags & (needed | HK_ITERATIVE)) == needed && !is_special(plugin);
}

static hk_status make(hk_dynamics *d, const hk_plugin_spec *spec, hk_instance **solver) {
  hk_instance *twin = hk_instance_create(spec, d->shared, d->error);
  if (!twin) return HK_NO_MEMORY;
  hk_status status = start(d, twin);
  if (status == HK_OK)
    *solver = twin;
  else
    hk_instance_destroy(twin);
  return status;
}

hk_status hk_solver_indefinite(hk_dynamics *d, hk_instance **solver, hk_plugin_spec **spec) {
  const hk_plugin *plugin;
  *spec = NULL;
  if (d->solver && takes_saddle_points(d->solver->plugin, NULL)) return make(d, d->solver->spec, solver);
  hk_status status = hk_registry_prefer(d->shared->registry, HK_SOLVER, takes_saddle_points, NULL, &plugin, d->error);
  if (status != HK_OK) return status;
  *spec = hk_spec_create(plugin, plugin->name, "", d->error);
  return *spec ? make(d, *spec, solver) : HK_NO_MEMORY;
}

/* J W J^T is symmetric whatever the forces are. */
hk_status hk_solver_twins(hk_dynamics *d, hk_linear_system *linear) {
  linear->apart = true;
  if (d->special_spec) return make(d, d->special_spec, &linear->special);
  hk_status status = make(d, d->solver->spec, &linear->any);
  linear->solver = linear->any;
  return status;
}

static hk_status open_any(hk_dynamics *d, hk_linear_system *linear) {
  if (linear->any) return HK_OK;
  hk_status status = choose_any(d);
  if (status == HK_OK && linear->apart) return make(d, d->solver ? d->solver->spec : d->solver_spec, &linear->any);
  if (status == HK_OK && !d->solver) status = add(d, d->solver_spec, &d->solver);
  linear->any = d->solver;
  return status;
}

/* ---- use ---- */

hk_status hk_linear_system_choose(hk_dynamics *d, hk_linear_system *linear, const hk_matrix *A) {
  bool fits = false;
  if (linear->special) {
    const hk_instance *outer = hk_enter(linear->special);
    fits = linear->special->plugin->solver->fits(linear->special->self, A);
    hk_leave(linear->special, outer);
  }
  hk_status status = fits ? HK_OK : open_any(d, linear);
  if (status == HK_OK) linear->solver = fits ? linear->special : linear->any;
  return status;
}

size_t hk_matrix_find(const hk_matrix *A, size_t row, uint32_t column) {
  size_t low = A->row_start[row], end = A->row_start[row + 1], high = end;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (A->column[middle] < column)
      low = middle + 1;
    else
      high = middle;
  }
  return low < end && A->column[low] == column ? low : SIZE_MAX;
}

/* NaN counts as 0, since the solver detects it. */
double hk_matrix_asymmetry(const hk_matrix *A) {
  size_t b = A->block, bb = b * b;
  double largest = 0, difference = 0;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
      size_t mirror = hk_matrix_find(A, A->column[e], (uint32_t)r);
      for (size_t k = 0; k < bb; k++) {
        double here = A->value[bb * e + k];
        double there = mirror == SIZE_MAX ? 0 : A->value[bb * mirror + k % b * b + k / b];
        largest = fmax(largest, fabs(here));
        difference = fmax(difference, fabs(here - there));
      }
    }
  return largest > 0 ? difference / largest : 0;
}

static const char *unsymmetric_force(const hk_dynamics *d) {
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++) {
    const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    if (hk_force_of(force->plugin)->implicit.jacobian && !(force->plugin->force->flags & HK_SYMMETRIC_JACOBIAN))
      return force->label;
  }
  return NULL;
}

static hk_status check_symmetry(hk_dynamics *d, const hk_instance *solver, const hk_matrix *A) {
  if (A->symmetric || solver->plugin->solver->flags & HK_SOLVES_UNSYMMETRIC) return HK_OK;
  double found = hk_matrix_asymmetry(A);
  if (!(found > hk_asymmetry_limit)) return HK_OK;
  const char *force = unsymmetric_force(d), *integrator = hk_plugins_one(d->plugins, HK_INTEGRATOR)->plugin->name;
  return hk_error_set(d->error, HK_FAILED,
                      "solver '%s' takes symmetric matrices only, and %s's differs from its transpose by %.2g of its "
                      "largest number%s%s%s: choose a solver for unsymmetric matrices or another integrator",
                      solver->label, integrator, found, force ? " (the Jacobian of '" : "", force ? force : "",
                      force ? "' is not symmetric)" : "");
}

/* Where a solver's parameters are functions of time, they are those of the state's. */
static hk_status set_time(hk_dynamics *d, hk_instance *solver) {
  return solver->spec->timed_count ? hk_instance_set_time(solver, d->state->t, d->error) : HK_OK;
}

static hk_status analyze(hk_instance *solver, const hk_matrix *A) {
  const hk_solver *functions = solver->plugin->solver;
  const hk_instance *outer = hk_enter(solver);
  return hk_leave_with(solver, outer, "analyze", functions->analyze ? functions->analyze(solver->self, A) : HK_OK);
}

hk_status hk_linear_system_factors(hk_dynamics *d, hk_linear_system *linear, const hk_matrix *A, uint64_t pattern) {
  hk_instance *solver = linear->solver;
  hk_status status = set_time(d, solver);
  if (status != HK_OK) return status;
  double begin = hk_clock();
  if (!linear->analyzed || pattern != linear->pattern) {
    linear->analyzed = false;
    status = analyze(solver, A);
    if (status != HK_OK) return status;
    linear->pattern = pattern;
    linear->rows = A->rows * A->block;
    linear->analyzed = true;
  }
  const hk_instance *outer = hk_enter(solver);
  status = hk_leave_with(solver, outer, "factorize", solver->plugin->solver->factorize(solver->self, A));
  solver->seconds += hk_clock() - begin;
  solver->calls++;
  solver->sampled++;
  d->count.factorizations++;
  d->count.special_factorizations += is_special(solver->plugin);
  return status;
}

hk_status hk_linear_system_factorize(hk_dynamics *d, hk_linear_system *linear, const hk_matrix *A) {
  uint64_t pattern = A->pattern ? A->pattern : hk_pattern_number(A->rows, A->block, A->row_start, A->column);
  bool known = linear->analyzed && pattern == linear->pattern;
  hk_status status = known ? HK_OK : hk_linear_system_choose(d, linear, A);
  linear->analyzed = known;
  if (status == HK_OK) status = check_symmetry(d, linear->solver, A);
  return status == HK_OK ? hk_linear_system_factors(d, linear, A, pattern) : status;
}

hk_status hk_linear_system_solve(hk_dynamics *d, hk_linear_system *linear, const double *b, double *x,
                                 hk_solve_info *info) {
  hk_solve_info own = {0, NAN, info ? info->tolerance : 0};
  double begin = hk_clock();
  hk_status status = set_time(d, linear->solver);
  const hk_instance *outer = hk_enter(linear->solver);
  if (status == HK_OK) status = linear->solver->plugin->solver->solve(linear->solver->self, b, x, &own);
  status = hk_leave_with(linear->solver, outer, "solve", status);
  linear->solver->seconds += hk_clock() - begin;
  d->count.linear_iterations += (size_t)own.iterations;
  if (info) *info = own;
  return status;
}

/* Solves column by column, for solvers without solve_columns. */
static hk_status each_column(hk_linear_system *linear, const double *b, double *x, size_t columns) {
  const hk_solver *functions = linear->solver->plugin->solver;
  size_t rows = linear->rows;
  double *one = malloc((2 * rows + 1) * sizeof *one);
  hk_status status = one ? HK_OK : HK_NO_MEMORY;
  for (size_t c = 0; c < columns && status == HK_OK; c++) {
    hk_solve_info info = {0};
    for (size_t r = 0; r < rows; r++) one[r] = b[columns * r + c];
    status = functions->solve(linear->solver->self, one, one + rows, &info);
    for (size_t r = 0; r < rows && status == HK_OK; r++) x[columns * r + c] = one[rows + r];
  }
  free(one);
  return status;
}

hk_status hk_linear_system_solve_columns(hk_dynamics *d, hk_linear_system *linear, const double *b, double *x,
                                         size_t columns) {
  const hk_solver *functions = linear->solver->plugin->solver;
  double begin = hk_clock();
  const hk_instance *outer = hk_enter(linear->solver);
  hk_status status = set_time(d, linear->solver);
  if (status == HK_OK)
    status = functions->solve_columns ? functions->solve_columns(linear->solver->self, b, x, columns)
                                      : each_column(linear, b, x, columns);
  status = hk_leave_with(linear->solver, outer, "solve_columns", status);
  linear->solver->seconds += hk_clock() - begin;
  if (status == HK_NO_MEMORY && !*d->error->text)
    hk_error_set(d->error, status, "no memory for a right-hand side of %zu rows", linear->rows);
  return status;
}
