/* Calls to all forces besides F: the update of contact candidates, the safe fraction of a displacement, the potential
 * with timed forces, products without a matrix, bounds of the stiffness, the longest step, and the notice that a step
 * was accepted. A force without the function is skipped, unless its contract names a substitute. */
#include "core/dynamics/dynamics.h"
#include "core/dynamics/implicit_matrix.h"

#include <stdlib.h>
#include <string.h>

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

static const hk_instance *force_at(const hk_dynamics *d, size_t k) { return d->plugins->kind[HK_FORCE].item[k]; }

/* The timed parameters of one force alone; the other forces are then as they were. */
static hk_status set_time(hk_dynamics *d, size_t k, double t) {
  if (!d->has_timed || t == d->timed_at) return HK_OK;
  d->timed_at = NAN;
  return hk_instance_set_time(d->plugins->kind[HK_FORCE].item[k], t, d->error);
}

hk_status hk_sweep_update(hk_system *s, double t, const double *X, const double *x_to) {
  hk_dynamics *d = dynamics_of(s);
  hk_status status = HK_OK;
  for (size_t k = 0; k < s->forces && status == HK_OK; k++) {
    const hk_instance *force = force_at(d, k);
    bool changed = false;
    if (!d->force_acts[k] || !force->plugin->force->update) continue;
    status = set_time(d, k, t);
    if (status != HK_OK) return status;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    status = hk_leave_with(force, outer, "update", force->plugin->force->update(force->self, &view, x_to, &changed));
    if (changed) hk_jacobian_renew(d);
  }
  return status;
}

hk_status hk_sweep_settle(hk_dynamics *d) {
  const hk_state *s = d->state;
  return d->updates ? hk_sweep_update(&d->system, s->t, s->X, s->X) : HK_OK;
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
    status = hk_leave_with(force, outer, "accepted", force->plugin->force->accepted(force->self, &view, h));
  }
  return status;
}

hk_status hk_sweep_potential(hk_system *s, double t, const double *X, double *joule) {
  hk_dynamics *d = dynamics_of(s);
  *joule = 0;
  for (size_t k = 0; k < s->forces; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !d->takes[k] || !force->plugin->force->energy) continue;
    hk_status status = set_time(d, k, t);
    if (status != HK_OK) return status;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    *joule += force->plugin->force->energy(force->self, &view);
    hk_leave(force, outer);
  }
  return isfinite(*joule) ? HK_OK : HK_NOT_FINITE;
}

/* Restricts `takes` to the acting forces without a product of their own; returns how many of them have blocks. */
static size_t take_rest(hk_dynamics *d) {
  size_t rest = 0;
  for (size_t k = 0; k < d->system.forces; k++) {
    const hk_force *functions = force_at(d, k)->plugin->force;
    d->takes_kept[k] = d->takes[k];
    d->takes[k] &= d->force_acts[k] && !functions->product;
    rest += d->takes[k] && functions->jacobian;
  }
  return rest;
}

/* dF -= K dx + D dv with the blocks of the forces that `takes` includes. */
static hk_status product_of_blocks(hk_dynamics *d, double t, const double *X, const double *dx, const double *dv,
                                   double *dF) {
  hk_matrix K, D;
  hk_implicit_matrix *m = hk_implicit_matrix_of(d);
  size_t bytes = d->state->size * sizeof *X;
  if (m && !m->X) m->X = malloc(bytes);
  if (!m || !m->X) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for a product");
  memcpy(m->X, X, bytes); /* the assembly imposes the pins on it */
  hk_status status = hk_jacobian_assemble(&d->system, t, m->X, 0, &K, &D);
  for (size_t i = 0; i < d->system.n && status == HK_OK; i++)
    for (size_t e = K.row_start[i]; e < K.row_start[i + 1]; e++)
      for (int p = 0; p < 9; p++) {
        size_t at = 3 * (size_t)K.column[e] + (size_t)(p % 3);
        dF[3 * i + (size_t)(p / 3)] -= K.value[9 * e + p] * dx[at] + D.value[9 * e + p] * dv[at];
      }
  return status;
}

/* Refuses a force that has neither a product nor a Jacobian. */
static hk_status check_offers(hk_dynamics *d) {
  for (size_t k = 0; k < d->system.forces; k++) {
    const hk_force *functions = force_at(d, k)->plugin->force;
    if (d->takes[k] && !functions->jacobian && functions->flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V))
      return hk_error_set(d->error, HK_FAILED,
                          "force '%s' offers neither a product nor a Jacobian, which the method needs",
                          force_at(d, k)->label);
  }
  return HK_OK;
}

hk_status hk_sweep_product(hk_system *s, double t, const double *X, const double *dx, const double *dv, double *dF) {
  hk_dynamics *d = dynamics_of(s);
  memset(dF, 0, 3 * s->n * sizeof *dF);
  size_t rest = take_rest(d);
  hk_status status = check_offers(d);
  if (status == HK_OK && rest) status = product_of_blocks(d, t, X, dx, dv, dF);
  memcpy(d->takes, d->takes_kept, s->forces * sizeof *d->takes);
  for (size_t k = 0; k < s->forces && status == HK_OK; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !d->takes[k] || !force->plugin->force->product) continue;
    status = set_time(d, k, t);
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    if (status == HK_OK) status = force->plugin->force->product(force->self, &view, dx, dv, dF);
    status = hk_leave_with(force, outer, "product", status);
  }
  return status;
}

/* Whether all that depends on x states its stiffness, or on v its damping. */
static bool is_stated(const hk_dynamics *d, hk_stiffness_part part) {
  unsigned on = part == HK_DAMPING_WHOLE ? HK_DEPENDS_ON_V : HK_DEPENDS_ON_X;
  for (size_t k = 0; k < d->system.forces; k++) {
    const hk_force *functions = force_at(d, k)->plugin->force;
    if (d->force_acts[k] && !functions->stiffness_bound && functions->flags & on) return false;
  }
  return d->plugins->kind[HK_CONSTRAINT].count == 0;
}

bool hk_sweep_stiffness(hk_system *s, hk_stiffness_part part, bool stiffening, double (*block)[6]) {
  hk_dynamics *d = dynamics_of(s);
  bool stated = stiffening || is_stated(d, part);
  if (!stated && part != HK_DAMPING_WHOLE) return false;
  memset(block, 0, s->n * sizeof *block);
  for (size_t k = 0; k < s->forces; k++) {
    const hk_instance *force = force_at(d, k);
    const hk_force *functions = force->plugin->force;
    if (!d->force_acts[k] || !functions->stiffness_bound || (stiffening && !(functions->flags & HK_STIFFENS))) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    functions->stiffness_bound(force->self, &view, part, block);
    hk_leave(force, outer);
  }
  return stated;
}
