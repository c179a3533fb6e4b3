/* Calls to all forces besides F: the update of contact candidates, the safe fraction of a displacement, the potential
 * with timed forces, bounds of the stiffness, the longest step, the notice that a step was accepted, and the
 * change of internal variables then. A force
 * without the function is skipped, unless its contract names a substitute. */
#include "core/engine/contract/contract.h"
#include "core/engine/evaluate/evaluate.h"

#include <string.h>

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

static const hk_instance *force_at(const hk_dynamics *d, size_t k) { return d->plugins->kind[HK_FORCE].item[k]; }

/* The timed parameters of one force alone; the other forces are then as they were. */
static hk_status set_time(hk_dynamics *d, size_t k, double t) {
  if (!d->has_timed || t == d->timed_at) return HK_OK;
  d->timed_at = NAN;
  return hk_instance_set_time(d->plugins->kind[HK_FORCE].item[k], t, d->error);
}

hk_status hk_forces_update(hk_system *s, double t, const double *X, const double *x_to) {
  hk_dynamics *d = dynamics_of(s);
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->split.forces && status == HK_OK; k++) {
    const hk_instance *force = force_at(d, k);
    bool changed = false;
    if (!d->force_acts[k] || !hk_force_of(force->plugin)->steps.update) continue;
    status = set_time(d, k, t);
    if (status != HK_OK) return status;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    status = hk_leave_with(force, outer, "update",
                           hk_force_of(force->plugin)->steps.update(force->self, &view, x_to, &changed));
    if (changed && d->blocks_changed) d->blocks_changed(d, false);
  }
  return status;
}

hk_status hk_forces_settle(hk_dynamics *d) {
  const hk_state *s = d->state;
  return d->updates ? hk_forces_update(&d->system, s->t, s->X, s->X) : HK_OK;
}

double hk_forces_step_limit(hk_system *s, double t, const double *X, const double *dx) {
  hk_dynamics *d = dynamics_of(s);
  double least = 1;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !hk_force_of(force->plugin)->surfaces.step_limit) continue;
    hk_view view = hk_force_view_at(d, k, t, X, s->n);
    const hk_instance *outer = hk_enter(force);
    least = fmin(least, hk_force_of(force->plugin)->surfaces.step_limit(force->self, &view, dx));
    hk_leave(force, outer);
  }
  return least;
}

double hk_forces_longest_step(hk_dynamics *d) {
  double least = INFINITY;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !hk_force_of(force->plugin)->bounds.longest_step) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    double longest = hk_force_of(force->plugin)->bounds.longest_step(force->self, &view);
    hk_leave(force, outer);
    if (longest > 0) least = fmin(least, longest);
  }
  return least;
}

hk_status hk_forces_accepted(hk_dynamics *d, double h) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->split.forces && status == HK_OK; k++) {
    const hk_instance *force = force_at(d, k);
    if (!d->force_acts[k] || !hk_force_of(force->plugin)->steps.accepted) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    status = hk_leave_with(force, outer, "accepted", hk_force_of(force->plugin)->steps.accepted(force->self, &view, h));
  }
  return status;
}

static hk_status evolve_one(hk_dynamics *d, size_t k, double h, hk_evolution *sum) {
  const hk_instance *force = force_at(d, k);
  hk_evolution own = {0};
  hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
  hk_status status = set_time(d, k, d->state->t);
  if (status != HK_OK) return status;
  const hk_instance *outer = hk_enter(force);
  status = hk_force_of(force->plugin)->internal.evolve(force->self, &view, h, &own);
  status = hk_leave_with(force, outer, "evolve", status);
  if (status != HK_OK) return status;
  if (!isfinite(own.dissipated))
    return hk_error_set(d->error, HK_NOT_FINITE, "%s: what it dissipated up to t = %g s is not finite", force->label,
                        d->state->t);
  sum->dissipated += own.dissipated;
  sum->changed |= own.changed;
  if (own.pattern_changed && d->blocks_changed) d->blocks_changed(d, false);
  return HK_OK;
}

hk_status hk_forces_evolve(hk_dynamics *d, double h, hk_evolution *sum) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->split.forces && status == HK_OK; k++)
    if (d->force_acts[k] && hk_force_of(force_at(d, k)->plugin)->internal.evolve) status = evolve_one(d, k, h, sum);
  return status;
}

hk_status hk_forces_potential(hk_system *s, double t, const double *X, double *joule) {
  hk_dynamics *d = dynamics_of(s);
  *joule = 0;
  for (size_t k = 0; k < d->split.forces; k++) {
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

/* Whether all that depends on x states its stiffness, or on v its damping. */
static bool is_stated(const hk_dynamics *d, hk_stiffness_part part) {
  unsigned on = part == HK_DAMPING_WHOLE ? HK_DEPENDS_ON_V : HK_DEPENDS_ON_X;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_force_tables *f = hk_force_of(force_at(d, k)->plugin);
    if (d->force_acts[k] && !f->bounds.stiffness_bound && f->own.flags & on) return false;
  }
  return true;
}

bool hk_forces_stiffness(hk_system *s, hk_stiffness_part part, bool stiffening, double (*block)[6]) {
  hk_dynamics *d = dynamics_of(s);
  bool stated = stiffening || is_stated(d, part);
  if (!stated && part != HK_DAMPING_WHOLE) return false;
  memset(block, 0, s->n * sizeof *block);
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_instance *force = force_at(d, k);
    const hk_force_tables *f = hk_force_of(force->plugin);
    if (!d->force_acts[k] || !f->bounds.stiffness_bound || (stiffening && !(f->own.flags & HK_STIFFENS))) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    f->bounds.stiffness_bound(force->self, &view, part, block);
    hk_leave(force, outer);
  }
  hk_riders_gather_bounds(&d->state->model, block);
  return stated && (stiffening || d->plugins->kind[HK_CONSTRAINT].count == 0);
}
