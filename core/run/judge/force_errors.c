/* Errors of forces that are approximations, as they say themselves at frames. Their power, summed from frame to frame
 * by the trapezoidal rule, is what the energy balance may be off by without a fault of the steps. */
#include "core/engine/contract/contract.h"
#include "core/run/judge/judge.h"

static void note(hk_record *r, const hk_force_errors *e) {
  r->force_rms = fmax(r->force_rms, e->rms);
  r->force_p99 = fmax(r->force_p99, e->p99);
  r->force_largest = fmax(r->force_largest, e->largest);
}

void hk_force_errors_note(hk_loop *loop) {
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  const hk_state *s = loop->state;
  hk_record *r = loop->record;
  double power = 0;
  for (size_t k = 0; k < forces->count; k++) {
    const hk_instance *force = forces->item[k];
    hk_force_errors e = {0};
    if (!hk_force_of(force->plugin)->approximation.errors || !loop->dynamics->force_acts[k]) continue;
    hk_view view = hk_force_view_at(loop->dynamics, k, s->t, s->X, s->model.n);
    const hk_instance *outer = hk_enter(force);
    bool approximate = hk_force_of(force->plugin)->approximation.errors(force->self, &view, &e);
    hk_leave(force, outer);
    if (!approximate) continue;
    note(r, &e);
    power += e.power;
  }
  if (r->frames > 0) r->force_work += (r->force_power + power) / 2 * (s->t - r->force_at);
  r->force_power = power;
  r->force_at = s->t;
}
