/* Contact in a step. Forces with `update` are given the positions predicted with the present velocities. The steps of
 * methods that do not limit their moves themselves are checked afterwards: the straight line from the state before the
 * step to the state after it must be safe, so that particles cannot pass each other. A step that fails the check is
 * rejected and repeated with half its length, and so is one in which forces were not finite, because it was evaluated
 * in an overlap. In scenes without contact none of this is called. */
#include "core/engine/loop/loop.h"

#include <string.h>

hk_status hk_contact_begin(hk_loop *loop, double h) {
  const hk_state *s = loop->state;
  size_t count = 3 * s->model.n;
  double *x_to = loop->dynamics->predicted;
  for (size_t e = 0; e < count; e++) x_to[e] = s->X[e] + h * s->X[count + e];
  return hk_forces_update(&loop->dynamics->system, s->t, s->X, x_to);
}

static void restore_start(hk_loop *loop) {
  memcpy(loop->state->X, loop->X_before, loop->state->size * sizeof *loop->X_before);
  loop->rejected_by = "contact";
  loop->part = 0.5;
}

bool hk_contact_rejects(hk_loop *loop, hk_status *status) {
  if (*status != HK_NOT_FINITE) return false;
  restore_start(loop);
  hk_error_clear(loop->error);
  *status = HK_OK;
  return true;
}

hk_status hk_contact_check(hk_loop *loop, double t_before, bool *rejected) {
  hk_state *s = loop->state;
  hk_system *system = &loop->dynamics->system;
  size_t count = 3 * s->model.n;
  double *dx = loop->dynamics->predicted;
  hk_status status = hk_forces_update(system, t_before, loop->X_before, s->X);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < count; e++) dx[e] = s->X[e] - loop->X_before[e];
  *rejected = hk_forces_step_limit(system, t_before, loop->X_before, dx) < 1;
  if (*rejected) restore_start(loop);
  return HK_OK;
}
