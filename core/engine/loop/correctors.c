/* Correctors are called after a step, in the scene's order. After a corrector changed x or v, the pins and constraints
 * are imposed again; when a corrector rejects the step, the state before the step is restored. */
#include "core/engine/contract/contract.h"
#include "core/engine/loop/correction_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool hk_correctors_need_start(const hk_loop *loop) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  unsigned flags = 0;
  for (size_t k = 0; k < correctors->count; k++) flags |= correctors->item[k]->plugin->corrector->flags;
  return flags & (HK_WANTS_BEFORE | HK_MAY_REJECT);
}

static bool any_bounds_steps(const hk_instances *correctors) {
  for (size_t k = 0; k < correctors->count; k++)
    if (correctors->item[k]->plugin->corrector->longest_step) return true;
  return false;
}

/* n x 3, m/s^2, at the start of a run, for who foretells how fast things will be; the caller frees it. It is no
 * evaluation of the run. NULL: later, or they are not known. */
static double *first_accelerations(hk_loop *loop) {
  hk_state *s = loop->state;
  hk_system *system = &loop->dynamics->system;
  const hk_counts before = loop->dynamics->count;
  size_t n = s->model.n;
  if (loop->record->steps > 0) return NULL;
  double *X = malloc(s->size * sizeof *X), *a = malloc((s->size + 1) * sizeof *a);
  hk_status status = X && a ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK) memcpy(X, s->X, s->size * sizeof *X);
  if (status == HK_OK) status = system->accelerations(system, s->t, X, X + 3 * n, X + 6 * n, a, a + 3 * n);
  loop->dynamics->count = before;
  hk_error_clear(loop->error); /* the first step says what is wrong */
  free(X);
  if (status == HK_OK) return a;
  free(a);
  return NULL;
}

double hk_correctors_longest_step(hk_loop *loop) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  double least = INFINITY;
  if (!any_bounds_steps(correctors)) return least;
  double *a = first_accelerations(loop);
  for (size_t k = 0; k < correctors->count; k++) {
    const hk_instance *c = correctors->item[k];
    if (!c->plugin->corrector->longest_step) continue;
    hk_view view = hk_instance_view(c, &loop->state->view);
    const hk_instance *outer = hk_enter(c);
    double longest = c->plugin->corrector->longest_step(c->self, &view, a);
    hk_leave(c, outer);
    if (longest > 0) least = fmin(least, longest);
  }
  free(a);
  return least;
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
  bool moved, silent, touched; /* something was changed; what energy that took was not said; it was by contact */
  double before;               /* J, the energy before a corrector that is not the first to move something */
  double work, contact;        /* J, by all, and by contact */
} account;

/* J, with the forces of X, whose moves have no work but the difference of these. */
static double energy_of(hk_loop *loop, const double *X) {
  return hk_state_kinetic(loop->state, X) + hk_query_potential(loop->dynamics, loop->state->t, X);
}

static bool is_measured(const hk_loop *loop, const hk_corrector *functions) {
  return functions->flags & HK_REPORTS_WORK && loop->method->order > 1;
}

/* A corrector knows the energy of its moves to the order of the step alone, so it is measured. Its own figure counts
 * where a force has no energy in the state that was corrected, as a barrier in an overlap, and with methods of order 1,
 * whose positions and velocities are not those of one time. */
static void note(account *a, hk_loop *loop, const hk_corrector *functions, const hk_correction *c) {
  hk_state *s = loop->state;
  bool reports = functions->flags & HK_REPORTS_WORK;
  double work = reports ? NAN : 0;
  if (is_measured(loop, functions))
    work = energy_of(loop, s->X) - (a->moved ? a->before : energy_of(loop, loop->X_end));
  if (reports && !isfinite(work)) work = c->work;
  a->moved = true;
  a->silent |= !reports;
  a->touched |= functions->contacts != NULL;
  a->work += work;
  a->contact += functions->contacts ? work : 0;
  s->X[s->size - 1] += work;
}

static void commit(hk_record *record, const account *a) {
  record->moved |= a->moved;
  record->corrected |= a->silent;
  record->correction_work += a->work;
  record->contact_work += a->contact;
}

/* Where the work of the whole step is known, that stands in place of what was measured: not of methods of order 1,
 * whose positions and velocities are not those of one time, and beside constraints. */
static hk_status settle(hk_loop *loop, account *a, double h) {
  const hk_corrected_facet *facet = &hk_integrator_tables_of(loop->method)->corrected;
  hk_state *s = loop->state;
  hk_corrected whole = {.work = NAN};
  bool followed = loop->method->order > 1 && !loop->dynamics->constrain && hk_correctors_need_start(loop);
  hk_status status = hk_forces_settle(loop->dynamics);
  if (status != HK_OK || a->silent || !(facet->account || followed)) return status;
  hk_system *system = &loop->dynamics->system;
  const hk_instance *outer = hk_enter(loop->integrator);
  status = facet->account ? facet->account(loop->integrator->self, loop->method->method, system, loop->X_end, h, &whole)
                          : hk_correction_work(loop, h, &whole);
  status = hk_leave_with(loop->integrator, outer, "account", status);
  if (status != HK_OK || isnan(whole.work)) return status;
  s->X[s->size - 1] = loop->X_end[s->size - 1] + whole.work;
  a->contact += a->touched ? whole.correction - a->work : 0;
  a->work = whole.correction;
  return HK_OK;
}

static hk_status reject(hk_loop *loop, const hk_instance *corrector, double part, bool *rejected) {
  memcpy(loop->state->X, loop->X_before, loop->state->size * sizeof *loop->X_before);
  loop->rejected_by = corrector->label;
  loop->part = part > 0 && part < 1 ? part : 0.5;
  *rejected = true;
  return HK_OK;
}

hk_status hk_correctors_apply(hk_loop *loop, double h, bool last, bool *rejected) {
  const hk_instances *correctors = &loop->plugins->kind[HK_CORRECTOR];
  hk_state *s = loop->state;
  account done = {0};
  *rejected = false;
  if (!hk_state_copy(s, &loop->X_end, &loop->room_end, s->size))
    return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the state at the end of a step");
  hk_status status = HK_OK;
  for (size_t k = 0; k < correctors->count && status == HK_OK; k++) {
    const hk_corrector *functions = correctors->item[k]->plugin->corrector;
    hk_correction c = {.h = h, .x = s->X, .v = s->X + 3 * s->model.n, .last = last};
    if (loop->pins->has_slides) c.filter = filter, c.pins = loop->pins;
    if (functions->flags & HK_WANTS_BEFORE) c.x_before = loop->X_before, c.v_before = loop->X_before + 3 * s->model.n;
    if (done.moved && is_measured(loop, functions)) done.before = energy_of(loop, s->X);
    status = call(loop, correctors->item[k], &c);
    if (status != HK_OK) return status;
    if (c.reject && functions->flags & HK_MAY_REJECT) return reject(loop, correctors->item[k], c.part, rejected);
    if (!c.changed) continue;
    note(&done, loop, functions, &c);
    status = impose(loop);
    hk_step_reset(loop, HK_STATE_CHANGED);
  }
  if (done.moved && status == HK_OK) status = settle(loop, &done, h);
  commit(loop->record, &done);
  return status;
}
