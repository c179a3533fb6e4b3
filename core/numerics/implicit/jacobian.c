/* K = -dF/dx and D = -dF/dv of all forces together, in 3x3 blocks with one pattern.
 *
 * Once per topology every force names its blocks; they and the whole diagonal are merged into one pattern, and each
 * force keeps the slots of its blocks. When an update of contact changed the blocks, the next assembly builds a new
 * pattern; until then the matrices and factors of the old pattern remain valid. An evaluation zeroes the two value
 * arrays, and every acting force adds its blocks. The pattern includes all forces, acting or not, so that a force that
 * begins to act later needs no new analysis. Invariant: slot[first[k] + e] is the slot of the e-th block of force k. In
 * a scene with constraints K includes the stiffness of their forces, at the multipliers of the last evaluation
 * (saddle_point.c). */

#include "core/engine/contract/contract.h"
#include "core/numerics/implicit/implicit.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCKS_GRAIN = 16384 };

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

static hk_status check_offers(const hk_dynamics *d) {
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++) {
    const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    const hk_force_tables *f = hk_force_of(force->plugin);
    if (d->takes[k] && !f->implicit.jacobian && f->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V))
      return hk_error_set(d->error, HK_FAILED, "force '%s' offers no Jacobian, which %s needs", force->label,
                          hk_plugins_one(d->plugins, HK_INTEGRATOR)->plugin->name);
  }
  return HK_OK;
}

static hk_status name_blocks(hk_dynamics *d, hk_implicit_matrix *s) {
  size_t n = d->state->model.n;
  hk_block_matrix_begin(&s->matrix, n, n);
  for (size_t i = 0; i < n; i++) s->matrix.naming.block(&s->matrix.naming, (uint32_t)i, (uint32_t)i);
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++) {
    hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    const hk_implicit_facet *f = &hk_force_of(force->plugin)->implicit;
    s->first[k] = s->matrix.named;
    if (!f->pattern) continue;
    const hk_instance *outer = hk_enter(force);
    f->pattern(force->self, &d->force_view[k], &s->matrix.naming);
    hk_leave(force, outer);
    if (s->matrix.out_of_range)
      return hk_error_set(d->error, HK_FAILED, "force '%s' names a block of a particle that is not there",
                          force->label);
  }
  s->first_constraint = s->matrix.named;
  hk_status status = d->saddle ? hk_saddle_point_name(d, &s->matrix.naming) : HK_OK;
  if (status == HK_OK) hk_implicit_name_carriers(d, s);
  return status;
}

static void drop(hk_implicit_matrix *s) {
  hk_block_matrix_free(&s->matrix);
  free(s->first);
  free(s->K);
  free(s->D);
  free(s->A);
  free(s->slide);
  s->first = NULL;
  s->K = s->D = s->A = NULL;
  s->slide = NULL;
}

static hk_status build(hk_dynamics *d, hk_implicit_matrix *s) {
  drop(s);
  s->first = calloc(d->plugins->kind[HK_FORCE].count + 1, sizeof *s->first);
  hk_status status = s->first ? name_blocks(d, s) : HK_NO_MEMORY;
  if (status == HK_OK) status = hk_block_matrix_build(&s->matrix);
  if (status == HK_OK) {
    size_t blocks = s->matrix.row_start[s->matrix.rows];
    s->K = malloc((9 * blocks + 1) * sizeof *s->K);
    s->D = malloc((9 * blocks + 1) * sizeof *s->D);
  }
  s->stale = false;
  if (s->K && s->D) return HK_OK;
  if (status == HK_OK) status = HK_NO_MEMORY;
  hk_error_set(d->error, status, "no memory for the Jacobian of %zu particles", d->state->model.n);
  return status;
}

static bool contributes(const hk_dynamics *d, size_t k) {
  return d->force_acts[k] && d->takes[k] && hk_force_of(d->plugins->kind[HK_FORCE].item[k]->plugin)->implicit.jacobian;
}

static bool is_symmetric(const hk_dynamics *d, unsigned want) {
  unsigned enough = HK_SYMMETRIC_JACOBIAN | (want & HK_WANT_SYMMETRIC ? HK_OFFERS_SYMMETRIC : 0);
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++)
    if (contributes(d, k) && !(d->plugins->kind[HK_FORCE].item[k]->plugin->force->flags & enough)) return false;
  return true;
}

static void clear_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  hk_implicit_matrix *s = context;
  (void)chunk;
  memset(s->K + 9 * begin, 0, 9 * (end - begin) * sizeof *s->K);
  memset(s->D + 9 * begin, 0, 9 * (end - begin) * sizeof *s->D);
}

static hk_status fill(hk_dynamics *d, hk_implicit_matrix *s, double t, const double *X, unsigned want) {
  size_t n = d->state->model.n;
  hk_threads_for(d->shared->threads, s->matrix.row_start[n], BLOCKS_GRAIN, clear_chunk, s);
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count && status == HK_OK; k++) {
    hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    if (!contributes(d, k)) continue;
    hk_view view = d->force_view[k];
    view.t = t;
    view.x = X;
    view.v = X + 3 * n;
    view.y = d->state->width ? X + 6 * n : NULL;
    view.power = NULL;
    hk_blocks into = {s->matrix.slot + s->first[k], s->K, s->D, want, d->linear.linearised, d->linear.reached};
    const hk_instance *outer = hk_enter(force);
    status = hk_force_of(force->plugin)->implicit.jacobian(force->self, &view, &into);
    status = hk_leave_with(force, outer, "jacobian", status);
  }
  if (status == HK_OK) hk_implicit_carry_over(d, s);
  if (status != HK_OK || !d->saddle) return status;
  return hk_saddle_point_stiffness(d, t, X, X + 3 * n, s->matrix.slot + s->first_constraint, s->K);
}

/* The pattern decides on the solver, and methods ask what it can do before the first assembly. */
static hk_status choose_early(hk_dynamics *d, hk_linear_system *linear) {
  hk_implicit_matrix *s = d->matrix;
  hk_status status = s->K && s->D ? HK_OK : build(d, s);
  if (status != HK_OK) return status;
  hk_matrix A = {s->matrix.rows, 3, s->matrix.row_start, s->matrix.column, NULL, true, s->matrix.number};
  status = hk_coupled_rows_of(&s->coupled, d, &A, &A);
  return status == HK_OK ? hk_linear_system_choose(d, linear, &A) : status;
}

hk_status hk_solver_choose(hk_dynamics *d) {
  const hk_instance *method = hk_plugins_one(d->plugins, HK_INTEGRATOR);
  unsigned flags;
  if (!d->special || !(method->plugin->integrator->flags & HK_NEEDS_JACOBIAN)) return HK_OK;
  return hk_implicit_solver_flags(&d->system, &flags);
}

hk_status hk_implicit_solver_flags(hk_system *system, unsigned *flags) {
  hk_dynamics *d = dynamics_of(system);
  hk_linear_system *linear = NULL;
  hk_status status = hk_implicit_linear_system(d, &linear);
  if (status == HK_OK && hk_implicit_constrained(d)) {
    *flags = hk_saddle_point_flags(d);
    return HK_OK;
  }
  if (status == HK_OK && !linear->analyzed && linear->special) status = choose_early(d, linear);
  if (status == HK_OK) *flags = linear->solver->plugin->solver->flags;
  return status;
}

hk_status hk_jacobian_assemble(hk_system *system, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D) {
  hk_dynamics *d = dynamics_of(system);
  hk_implicit_matrix *s = hk_implicit_matrix_of(d);
  hk_status status = s ? hk_dynamics_impose(d, t, X, X + 3 * d->state->model.n) : HK_NO_MEMORY;
  if (status == HK_OK) status = check_offers(d);
  if (status == HK_OK && (s->stale || !s->K || !s->D)) status = build(d, s);
  if (status == HK_OK) status = fill(d, s, t, X, want);
  if (status != HK_OK) return status;
  s->symmetric = is_symmetric(d, want);
  *K = (hk_matrix){s->matrix.rows, 3, s->matrix.row_start, s->matrix.column, s->K, s->symmetric, s->matrix.number};
  *D = *K;
  D->value = s->D;
  d->count.jacobians++;
  return HK_OK;
}

void hk_jacobian_topology(hk_dynamics *d) {
  if (!d->matrix) return;
  drop(d->matrix);
  free(d->matrix->X);
  d->matrix->X = NULL;
  d->matrix->linear.analyzed = false;
}

void hk_jacobian_close(hk_dynamics *d) {
  hk_implicit_matrix *s = d->matrix;
  if (!s) return;
  drop(s);
  hk_coupled_rows_free(&s->coupled);
  free(s->X);
  free(s);
  d->matrix = NULL;
}
