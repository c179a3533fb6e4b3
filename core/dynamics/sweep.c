/* Calls to all forces besides F: the update of contact candidates, the safe fraction of a displacement, the potential
 * with timed forces, products without a matrix, bounds of the stiffness, the longest step, and the notice that a step
 * was accepted. A force without the function is skipped, unless its contract names a substitute. */
#include "core/dynamics/dynamics.h"
#include "core/dynamics/implicit_matrix.h"

#include <stdlib.h>
#include <string.h>

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

static const hk_instance *force_at(const hk_dynamics *d, size_t k) { return d->plugins->kind[HK_FORCE].item[k]; }

hk_status hk_sweep_update(hk_system *s, double t, const double *X, const double *x_to) {
  hk_dynamics *d = dynamics_of(s);
  hk_status status = HK_OK;
  for (size_t k = 0; k < s->forces && status == HK_OK; k++) {
    const hk_instance *force = force_at(d, k);
    bool changed = false;
    if (!d->force_acts[k] || !force->plugin->force->update) continue;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    status = force->plugin->force->update(force->self, &view, x_to, &changed);
    hk_leave(force, outer);
    if (changed) hk_jacobian_topology(d);
  }
  return status;
}

double hk_sweep_limit(hk_system *s, double t, const double *X, const double *dx) {
  hk_dynamics *d = dynamics_of(s);
  double least = 1;
  for (size_t k = 0; k < s->forces; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !force->plugin->force->step_limit) continue;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    least = fmin(least, force->plugin->force->step_limit(force->self, &view, dx));
    hk_leave(force, outer);
  }
  return least;
}

double hk_sweep_longest_step(hk_dynamics *d) {
  double least = INFINITY;
  for (size_t k = 0; d->demands && k < d->system.forces; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !force->plugin->force->longest_step) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    double longest = force->plugin->force->longest_step(force->self, &view);
    hk_leave(force, outer);
    if (longest > 0) least = fmin(least, longest);
  }
  return least;
}

hk_status hk_sweep_accepted(hk_dynamics *d, double h) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->system.forces && status == HK_OK; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !force->plugin->force->accepted) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    status = force->plugin->force->accepted(force->self, &view, h);
    hk_leave(force, outer);
  }
  return status;
}

hk_status hk_sweep_potential(hk_system *s, double t, const double *X, double *joule) {
  hk_dynamics *d = dynamics_of(s);
  *joule = 0;
  for (size_t k = 0; k < s->forces; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !d->takes[k] || !force->plugin->force->energy) continue;
    hk_status status = hk_instance_set_time(d->plugins->kind[HK_FORCE].item[k], t, d->error);
    if (status != HK_OK) return status;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    *joule += force->plugin->force->energy(force->self, &view);
    hk_leave(force, outer);
  }
  if (d->has_timed) d->timed_at = NAN; /* the loop may have set the parameters of some forces only */
  return isfinite(*joule) ? HK_OK : HK_NOT_FINITE;
}

/* dF -= K dx + D dv with the blocks of one force. */
static hk_status product_of_blocks(hk_dynamics *d, size_t k, const hk_view *view, const double *dx, const double *dv,
                                   double *dF) {
  hk_matrix K, D;
  bool *kept = malloc(d->system.forces + 1);
  double *X = malloc(d->state->size * sizeof *X);
  hk_status status = kept && X ? HK_OK : hk_error_set(d->error, HK_NO_MEMORY, "no memory for a product");
  if (status == HK_OK) {
    memcpy(kept, d->takes, d->system.forces);
    for (size_t j = 0; j < d->system.forces; j++) d->takes[j] = j == k;
    memcpy(X, view->x, d->state->size * sizeof *X); /* x, v and y are one vector */
    status = hk_jacobian_assemble(&d->system, view->t, X, 0, &K, &D);
    memcpy(d->takes, kept, d->system.forces);
  }
  for (size_t i = 0; i < view->n && status == HK_OK; i++)
    for (size_t e = K.row_start[i]; e < K.row_start[i + 1]; e++)
      for (int p = 0; p < 9; p++) {
        size_t at = 3 * (size_t)K.column[e] + (size_t)(p % 3);
        dF[3 * i + (size_t)(p / 3)] -= K.value[9 * e + p] * dx[at] + D.value[9 * e + p] * dv[at];
      }
  free(kept);
  free(X);
  return status;
}

hk_status hk_sweep_product(hk_system *s, double t, const double *X, const double *dx, const double *dv, double *dF) {
  hk_dynamics *d = dynamics_of(s);
  hk_status status = HK_OK;
  memset(dF, 0, 3 * s->n * sizeof *dF);
  for (size_t k = 0; k < s->forces && status == HK_OK; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !d->takes[k]) continue;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    if (force->plugin->force->product)
      status = force->plugin->force->product(force->self, &view, dx, dv, dF);
    else if (force->plugin->force->jacobian)
      status = product_of_blocks(d, k, &view, dx, dv, dF);
    else if (force->plugin->force->flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V))
      status = hk_error_set(d->error, HK_FAILED,
                            "force '%s' offers neither a product nor a Jacobian, which the method needs", force->label);
    hk_leave(force, outer);
  }
  return status;
}

bool hk_sweep_stiffness(hk_system *s, hk_stiffness_part part, bool stiffening, double (*block)[6]) {
  hk_dynamics *d = dynamics_of(s);
  bool all = true;
  memset(block, 0, s->n * sizeof *block);
  for (size_t k = 0; k < s->forces; k++) {
    const hk_instance *force = force_at(d, k);
    const hk_force *functions = force->plugin->force;
    if (!d->force_acts[k] || (stiffening && !(functions->flags & HK_STIFFENS))) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    if (functions->stiffness_bound)
      functions->stiffness_bound(force->self, &view, part, block);
    else
      all &= !(functions->flags & HK_DEPENDS_ON_X);
    hk_leave(force, outer);
  }
  return all && (stiffening || d->plugins->kind[HK_CONSTRAINT].count == 0);
}
