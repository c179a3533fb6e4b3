/* Correctors are called after a step, in the scene's order. After a corrector changed x or v, the pins and constraints
 * are imposed again; when a corrector rejects the step, the state before the step is restored. */
#include "core/engine/loop/loop.h"

#include <string.h>

bool hk_correctors_need_start(const hk_loop *loop) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  unsigned flags = 0;
  for (size_t k = 0; k < correctors->count; k++) flags |= correctors->item[k]->plugin->corrector->flags;
  return flags & (HK_WANTS_BEFORE | HK_MAY_REJECT);
}

static hk_status impose(hk_loop *loop) {
  hk_state *s = loop->state;
  double *x = s->X, *v = s->X + 3 * s->model.n;
  hk_status status = hk_dynamics_impose(loop->dynamics, s->t, x, v);
  const hk_constraint_calls *constrain = loop->dynamics->constrain;
  return status == HK_OK && constrain ? constrain->project(loop->dynamics, s->t, x, v) : status;
}

static hk_status call(hk_loop *loop, hk_instance *corrector, hk_correction *c) {
  const hk_corrector *functions = corrector->plugin->corrector;
  hk_view view = hk_instance_view(corrector, &loop->state->view);
  hk_status status = hk_instance_set_time(corrector, loop->state->t, loop->error);
  double begin = hk_clock();
  const hk_instance *outer = hk_enter(corrector);
  if (status == HK_OK) status = functions->correct(corrector->self, &view, c);
  status = hk_leave_with(corrector, outer, "correct", status);
  corrector->seconds += hk_clock() - begin;
  corrector->calls++;
  corrector->sampled++;
  return status;
}

static void filter(const hk_correction *c, double *vector) { hk_pins_filter(c->pins, vector); }

/* What the correctors did in a step, which counts only once none of them rejects it. */
typedef struct account {
  bool moved, silent; /* something was changed; and what energy that took was not said */
  double work;
} account;

static void note(account *a, hk_state *s, const hk_corrector *functions, const hk_correction *c) {
  bool reports = functions->flags & HK_REPORTS_WORK;
  a->moved = true;
  a->silent |= !reports;
  a->work += reports ? c->work : 0;
  s->X[s->size - 1] += reports ? c->work : 0;
}

static void commit(hk_record *record, const account *a) {
  record->moved |= a->moved;
  record->corrected |= a->silent;
  record->correction_work += a->work;
}

static hk_status reject(hk_loop *loop, const hk_instance *corrector, double part, bool *rejected) {
  memcpy(loop->state->X, loop->X_before, loop->state->size * sizeof *loop->X_before);
  loop->rejected_by = corrector->label;
  loop->part = part > 0 && part < 1 ? part : 0.5;
  *rejected = true;
  return HK_OK;
}

hk_status hk_correctors_apply(hk_loop *loop, double h, bool *rejected) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  hk_state *s = loop->state;
  account done = {0};
  *rejected = false;
  for (size_t k = 0; k < correctors->count; k++) {
    const hk_corrector *functions = correctors->item[k]->plugin->corrector;
    hk_correction c = {.h = h, .x = s->X, .v = s->X + 3 * s->model.n};
    if (loop->pins->has_slides) c.filter = filter, c.pins = loop->pins;
    if (functions->flags & HK_WANTS_BEFORE) c.x_before = loop->X_before, c.v_before = loop->X_before + 3 * s->model.n;
    hk_status status = call(loop, correctors->item[k], &c);
    if (status != HK_OK) return status;
    if (c.reject && functions->flags & HK_MAY_REJECT) return reject(loop, correctors->item[k], c.part, rejected);
    if (!c.changed) continue;
    note(&done, s, functions, &c);
    status = impose(loop);
    if (status != HK_OK) return status;
    hk_step_reset(loop, HK_STATE_CHANGED);
  }
  commit(loop->record, &done);
  return done.moved ? hk_forces_settle(loop->dynamics) : HK_OK;
}
