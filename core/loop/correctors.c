/* Correctors are called after a step, in the scene's order. After a corrector changed x or v, the pins and constraints
 * are imposed again; when a corrector rejects the step, the state before the step is restored. */
#include "core/loop/loop.h"

#include <stdlib.h>
#include <string.h>

static unsigned flags_of_all(const hk_loop *loop) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  unsigned flags = 0;
  for (size_t k = 0; k < correctors->count; k++) flags |= correctors->item[k]->plugin->corrector->flags;
  return flags;
}

hk_status hk_correctors_keep(hk_loop *loop) {
  if (!(flags_of_all(loop) & (HK_WANTS_BEFORE | HK_MAY_REJECT))) return HK_OK;
  size_t size = loop->state->size;
  double *grown = size > loop->room_before ? realloc(loop->X_before, size * sizeof *grown) : loop->X_before;
  if (!grown) return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the state before a step");
  loop->X_before = grown;
  if (size > loop->room_before) loop->room_before = size;
  memcpy(grown, loop->state->X, size * sizeof *grown);
  return HK_OK;
}

static hk_status impose(hk_loop *loop) {
  hk_state *s = loop->state;
  double *x = s->X, *v = s->X + 3 * s->model.n;
  hk_status status = hk_dynamics_impose(loop->dynamics, s->t, x, v);
  return status == HK_OK && loop->dynamics->constraints ? hk_constraints_project(loop->dynamics, s->t, x, v) : status;
}

static hk_status call(hk_loop *loop, hk_instance *corrector, hk_correction *c) {
  const hk_corrector *functions = corrector->plugin->corrector;
  hk_view view = hk_instance_view(corrector, &loop->state->view);
  hk_status status = hk_instance_set_time(corrector, loop->state->t, loop->error);
  double begin = hk_clock();
  const hk_instance *outer = hk_enter(corrector);
  if (status == HK_OK) status = functions->correct(corrector->self, &view, c);
  hk_leave(corrector, outer);
  corrector->seconds += hk_clock() - begin;
  corrector->calls++;
  corrector->sampled++;
  return status;
}

static void account(hk_loop *loop, const hk_corrector *functions, const hk_correction *c) {
  loop->record->moved = true;
  if (!(functions->flags & HK_REPORTS_WORK))
    loop->record->corrected = true;
  else {
    loop->record->correction_work += c->work;
    loop->state->X[loop->state->size - 1] += c->work;
  }
}

hk_status hk_correctors_apply(hk_loop *loop, double h, bool *rejected) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  hk_state *s = loop->state;
  *rejected = false;
  for (size_t k = 0; k < correctors->count; k++) {
    const hk_corrector *functions = correctors->item[k]->plugin->corrector;
    hk_correction c = {.h = h, .x = s->X, .v = s->X + 3 * s->model.n};
    if (functions->flags & HK_WANTS_BEFORE) c.x_before = loop->X_before;
    hk_status status = call(loop, correctors->item[k], &c);
    if (status != HK_OK) return status;
    if (c.reject && functions->flags & HK_MAY_REJECT) {
      memcpy(s->X, loop->X_before, s->size * sizeof *s->X);
      *rejected = true;
      return HK_OK;
    }
    if (!c.changed) continue;
    account(loop, functions, &c);
    status = impose(loop);
    if (status != HK_OK) return status;
    hk_step_reset(loop, HK_STATE_CHANGED);
  }
  return HK_OK;
}
