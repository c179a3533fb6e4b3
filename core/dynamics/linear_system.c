/* Linear systems through solver plugins: the choice of the solver, and its use.
 *
 * Where the scene names no solver, it is chosen by the flags of the installed solvers, the kind of the forces and the
 * number of unknowns. Times are not measured, so runs are reproducible. It is opened before the first step.
 *
 * A pattern is recognised by its number or, without one, by its hash, not by its address, since a new pattern may be in
 * the memory of an old one. A matrix that is not declared symmetric is compared with its transpose before a solver that
 * relies on symmetry gets it; one pass, small beside the factorization. */
#include "core/dynamics/linear_system.h"
#include "core/matrix/matrix.h"

#include <stdlib.h>
#include <string.h>

enum { LARGE = 300000 }; /* unknowns; the factors of a surface of this size take gigabytes */

static const double asymmetry_limit = 1e-10; /* relative to the largest number of the matrix; above rounding errors */

/* ---- choice ---- */

static bool needs_unsymmetric_solver(const hk_dynamics *d) {
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++) {
    const hk_force *force = d->plugins->kind[HK_FORCE].item[k]->plugin->force;
    if (force->jacobian && !(force->flags & (HK_SYMMETRIC_JACOBIAN | HK_OFFERS_SYMMETRIC))) return true;
  }
  return false;
}

static bool suits(const hk_plugin *plugin, const void *context) {
  const hk_dynamics *d = context;
  unsigned flags = plugin->solver->flags;
  if (flags & HK_NARROW) return false;
  if (d->plugins->kind[HK_CONSTRAINT].count)
    return needs_unsymmetric_solver(d) ? flags & HK_SOLVES_UNSYMMETRIC : !(flags & HK_ITERATIVE);
  if (needs_unsymmetric_solver(d)) return flags & HK_SOLVES_UNSYMMETRIC;
  return 3 * d->state->model.n > LARGE ? flags & HK_ITERATIVE : !(flags & HK_ITERATIVE);
}

static hk_status start(hk_dynamics *d, hk_instance *solver) {
  hk_view view = hk_instance_view(solver, &d->state->view);
  hk_status status = hk_instance_set_time(solver, d->state->t, d->error);
  return status == HK_OK ? hk_instance_start(solver, &view, d->state->size, d->error) : status;
}

hk_status hk_solver_open(hk_dynamics *d, const hk_plugin_spec *named) {
  const hk_plugin *plugin;
  hk_status status = HK_OK;
  if (d->solver) return HK_OK;
  if (!named) {
    status = hk_registry_prefer(d->scene->registry, HK_SOLVER, suits, d, &plugin, d->error);
    if (status != HK_OK) return status;
    named = d->solver_spec = hk_spec_create(plugin, plugin->name, "", d->error);
    if (!named) return HK_NO_MEMORY;
  }
  status = hk_plugins_add(d->plugins, named, d->shared, &d->solver, d->error);
  return status == HK_OK ? start(d, d->solver) : status;
}

static bool takes_saddle_points(const hk_plugin *plugin, const void *context) {
  const unsigned needed = HK_SOLVES_INDEFINITE | HK_SOLVES_UNSYMMETRIC;
  (void)context;
  return (plugin->solver->flags & (needed | HK_ITERATIVE)) == needed;
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

hk_status hk_solver_twin(hk_dynamics *d, hk_instance **solver) { return make(d, d->solver->spec, solver); }

static bool is_narrow(const hk_plugin *plugin, const void *context) {
  (void)context;
  return plugin->solver->flags & HK_NARROW;
}

hk_status hk_solver_narrow(hk_dynamics *d, hk_instance **solver, hk_plugin_spec **spec) {
  const hk_plugin *plugin;
  hk_error before = *d->error;
  if (!d->solver_spec) return HK_OK;
  if (hk_registry_prefer(d->scene->registry, HK_SOLVER, is_narrow, NULL, &plugin, d->error) != HK_OK) {
    *d->error = before; /* none is installed */
    return HK_OK;
  }
  *spec = hk_spec_create(plugin, plugin->name, "", d->error);
  return *spec ? make(d, *spec, solver) : HK_NO_MEMORY;
}

hk_status hk_solver_indefinite(hk_dynamics *d, hk_instance **solver, hk_plugin_spec **spec) {
  const hk_plugin *plugin;
  *spec = NULL;
  if (takes_saddle_points(d->solver->plugin, NULL)) return make(d, d->solver->spec, solver);
  hk_status status = hk_registry_prefer(d->scene->registry, HK_SOLVER, takes_saddle_points, NULL, &plugin, d->error);
  if (status != HK_OK) return status;
  *spec = hk_spec_create(plugin, plugin->name, "", d->error);
  return *spec ? make(d, *spec, solver) : HK_NO_MEMORY;
}

/* ---- use ---- */

static size_t find(const hk_matrix *A, size_t row, uint32_t column) {
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

/* Largest |A - A^T| relative to the largest |A|; NaN counts as 0, since the solver detects it. */
static double asymmetry(const hk_matrix *A) {
  size_t b = A->block, bb = b * b;
  double largest = 0, difference = 0;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
      size_t mirror = find(A, A->column[e], (uint32_t)r);
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
    if (force->plugin->force->jacobian && !(force->plugin->force->flags & HK_SYMMETRIC_JACOBIAN)) return force->label;
  }
  return NULL;
}

static hk_status check_symmetry(hk_dynamics *d, const hk_instance *solver, const hk_matrix *A) {
  if (A->symmetric || solver->plugin->solver->flags & HK_SOLVES_UNSYMMETRIC) return HK_OK;
  double found = asymmetry(A);
  if (!(found > asymmetry_limit)) return HK_OK;
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

static hk_status analyze_by(hk_linear_system *linear, hk_instance *solver, const hk_matrix *A) {
  const hk_solver *functions = solver->plugin->solver;
  const hk_instance *outer = hk_enter(solver);
  linear->chosen = solver;
  return hk_leave_with(solver, outer, "analyze", functions->analyze ? functions->analyze(solver->self, A) : HK_OK);
}

static hk_status analyze(hk_dynamics *d, hk_linear_system *linear, const hk_matrix *A) {
  hk_error before = *d->error;
  hk_status status = linear->narrow ? analyze_by(linear, linear->narrow, A) : HK_FAILED;
  if (status != HK_FAILED) return status;
  *d->error = before; /* removes the refusal */
  return analyze_by(linear, linear->solver, A);
}

hk_status hk_linear_system_factorize(hk_dynamics *d, hk_linear_system *linear, const hk_matrix *A) {
  uint64_t pattern = A->pattern ? A->pattern : hk_pattern_number(A->rows, A->block, A->row_start, A->column);
  hk_status status = check_symmetry(d, linear->solver, A);
  if (status == HK_OK) status = set_time(d, linear->solver);
  if (status != HK_OK) return status;
  double begin = hk_clock();
  if (!linear->analyzed || pattern != linear->pattern) {
    linear->analyzed = false;
    status = analyze(d, linear, A);
    if (status != HK_OK) return status;
    linear->pattern = pattern;
    linear->rows = A->rows * A->block;
    linear->analyzed = true;
  }
  hk_instance *solver = linear->chosen;
  const hk_instance *outer = hk_enter(solver);
  status = hk_leave_with(solver, outer, "factorize", solver->plugin->solver->factorize(solver->self, A));
  solver->seconds += hk_clock() - begin;
  solver->calls++;
  solver->sampled++;
  d->count.factorizations++;
  return status;
}

hk_status hk_linear_system_solve(hk_dynamics *d, hk_linear_system *linear, const double *b, double *x,
                                 hk_solve_info *info) {
  hk_solve_info own = {0, NAN, info ? info->tolerance : 0};
  double begin = hk_clock();
  hk_status status = set_time(d, linear->chosen);
  const hk_instance *outer = hk_enter(linear->chosen);
  if (status == HK_OK) status = linear->chosen->plugin->solver->solve(linear->chosen->self, b, x, &own);
  status = hk_leave_with(linear->chosen, outer, "solve", status);
  linear->chosen->seconds += hk_clock() - begin;
  d->count.linear_iterations += (size_t)own.iterations;
  if (info) *info = own;
  return status;
}

/* Solves column by column, for solvers without solve_columns. */
static hk_status each_column(hk_linear_system *linear, const double *b, double *x, size_t columns) {
  const hk_solver *functions = linear->chosen->plugin->solver;
  size_t rows = linear->rows;
  double *one = malloc((2 * rows + 1) * sizeof *one);
  hk_status status = one ? HK_OK : HK_NO_MEMORY;
  for (size_t c = 0; c < columns && status == HK_OK; c++) {
    hk_solve_info info = {0};
    for (size_t r = 0; r < rows; r++) one[r] = b[columns * r + c];
    status = functions->solve(linear->chosen->self, one, one + rows, &info);
    for (size_t r = 0; r < rows && status == HK_OK; r++) x[columns * r + c] = one[rows + r];
  }
  free(one);
  return status;
}

hk_status hk_linear_system_solve_columns(hk_dynamics *d, hk_linear_system *linear, const double *b, double *x,
                                         size_t columns) {
  const hk_solver *functions = linear->chosen->plugin->solver;
  double begin = hk_clock();
  const hk_instance *outer = hk_enter(linear->chosen);
  hk_status status = set_time(d, linear->chosen);
  if (status == HK_OK)
    status = functions->solve_columns ? functions->solve_columns(linear->chosen->self, b, x, columns)
                                      : each_column(linear, b, x, columns);
  status = hk_leave_with(linear->chosen, outer, "solve_columns", status);
  linear->chosen->seconds += hk_clock() - begin;
  if (status == HK_NO_MEMORY && !*d->error->text)
    hk_error_set(d->error, status, "no memory for a right-hand side of %zu rows", linear->rows);
  return status;
}
