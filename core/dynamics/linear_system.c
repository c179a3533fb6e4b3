/* Linear systems through solver plugins. Whether a pattern was analysed is decided by a hash of its numbers, not by its
 * address: memory of an old pattern may hold a new one. A matrix that is not declared symmetric is compared with its
 * transpose before a solver that relies on symmetry gets it; one pass, small beside the factorization. */
#include "core/dynamics/linear_system.h"

#include <stdlib.h>
#include <string.h>

static const double asymmetry_limit = 1e-10; /* of the largest number in the matrix: rounding, not physics */

static uint64_t pattern_hash(const hk_matrix *A) {
  uint64_t hash = 1469598103934665603u ^ A->block;
  for (size_t r = 0; r <= A->rows; r++) hash = (hash ^ A->row_start[r]) * 0x9E3779B97F4A7C15u + (hash >> 29);
  for (size_t e = 0; e < A->row_start[A->rows]; e++) hash = (hash ^ A->column[e]) * 0x9E3779B97F4A7C15u + (hash >> 29);
  return hash;
}

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

/* Largest |A - A^T| relative to the largest |A|; NaN counts as 0, the solver will see it. */
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

static const char *unsymmetric_force(const hk_run *run) {
  for (size_t k = 0; k < run->scene->force.count; k++) {
    const hk_instance *force = run->scene->force.item[k];
    if (force->plugin->force->jacobian && !(force->plugin->force->flags & HK_SYMMETRIC_JACOBIAN)) return force->label;
  }
  return NULL;
}

static hk_status check_symmetry(hk_run *run, const hk_instance *solver, const hk_matrix *A) {
  if (A->symmetric || solver->plugin->solver->flags & HK_SOLVES_UNSYMMETRIC) return HK_OK;
  double found = asymmetry(A);
  if (!(found > asymmetry_limit)) return HK_OK;
  const char *force = unsymmetric_force(run), *integrator = run->scene->integrator->plugin->name;
  return hk_error_set(&run->error, HK_FAILED,
                      "solver '%s' takes symmetric matrices only, and %s's differs from its transpose by %.2g of its "
                      "largest number%s%s%s: choose a solver for unsymmetric matrices or another integrator",
                      solver->label, integrator, found, force ? " (the Jacobian of '" : "", force ? force : "",
                      force ? "' is not symmetric)" : "");
}

hk_status hk_linear_system_factorize(hk_run *run, hk_linear_system *linear, const hk_matrix *A) {
  const hk_solver *functions = linear->solver->plugin->solver;
  uint64_t pattern = pattern_hash(A);
  hk_status status = check_symmetry(run, linear->solver, A);
  if (status != HK_OK) return status;
  double begin = hk_clock();
  if (!linear->analyzed || pattern != linear->pattern) {
    linear->analyzed = false;
    if (functions->analyze) status = functions->analyze(linear->solver->self, A);
    if (status != HK_OK) return status;
    linear->pattern = pattern;
    linear->rows = A->rows * A->block;
    linear->analyzed = true;
  }
  status = functions->factorize(linear->solver->self, A);
  linear->solver->seconds += hk_clock() - begin;
  linear->solver->calls++;
  linear->solver->sampled++;
  run->factorizations++;
  return status;
}

hk_status hk_linear_system_solve(hk_run *run, hk_linear_system *linear, const double *b, double *x,
                                 hk_solve_info *info) {
  hk_solve_info own = {0, NAN, info ? info->tolerance : 0};
  double begin = hk_clock();
  hk_status status = linear->solver->plugin->solver->solve(linear->solver->self, b, x, &own);
  linear->solver->seconds += hk_clock() - begin;
  run->linear_iterations += (size_t)own.iterations;
  if (info) *info = own;
  return status;
}

/* One by one, where the solver takes no more. */
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

hk_status hk_linear_system_solve_columns(hk_run *run, hk_linear_system *linear, const double *b, double *x,
                                         size_t columns) {
  const hk_solver *functions = linear->solver->plugin->solver;
  double begin = hk_clock();
  hk_status status = functions->solve_columns ? functions->solve_columns(linear->solver->self, b, x, columns)
                                              : each_column(linear, b, x, columns);
  linear->solver->seconds += hk_clock() - begin;
  if (status == HK_NO_MEMORY && !*run->error.text)
    hk_error_set(&run->error, status, "no memory for a right-hand side of %zu rows", linear->rows);
  return status;
}

static size_t field_size(hk_type type) {
  switch (type) {
  case HK_NUMBER:
    return sizeof(double);
  case HK_INTEGER:
    return sizeof(int64_t);
  case HK_BOOLEAN:
    return sizeof(bool);
  case HK_STRING:
    return sizeof(const char *);
  case HK_CHOICE:
    return sizeof(int);
  case HK_VECTOR:
    return 3 * sizeof(double);
  case HK_NUMBERS:
    return sizeof(hk_numbers);
  default:
    return 0; /* lists of particles and edges mean nothing to a solver */
  }
}

hk_status hk_linear_system_twin(hk_run *run, hk_instance **solver) {
  hk_scene *scene = run->scene;
  const hk_plugin *plugin = scene->solver ? scene->solver->plugin : NULL;
  hk_status status = plugin ? HK_OK : hk_registry_find(scene->registry, HK_SOLVER, "cholmod", &plugin, &run->error);
  if (status != HK_OK) return status;
  hk_instance *twin =
      hk_instance_create(plugin, plugin->name, scene->solver ? scene->solver->where : "", &scene->shared, &run->error);
  if (!twin) return HK_NO_MEMORY;
  for (const hk_param *p = plugin->params; scene->solver && p && p->name; p++)
    memcpy((char *)twin->self + p->offset, (const char *)scene->solver->self + p->offset, field_size(p->type));
  hk_view view = run->view;
  view.host = &twin->host;
  status = hk_instance_start(twin, &view, run->system.size, &run->error);
  if (status == HK_OK)
    *solver = twin;
  else
    hk_instance_destroy(twin);
  return status;
}
