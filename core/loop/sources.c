/* Births and deaths before a step: each source is called in turn, and its births and deaths take effect in state,
 * dynamics and plugins before the next source is called. */
#include "core/loop/loop.h"

#include <stdlib.h>

static hk_status apply(hk_loop *loop, hk_population_change *change) {
  uint32_t *map = NULL;
  size_t n_old = loop->state->model.n;
  hk_status status = hk_population_apply(change, &map, loop->error);
  if (status == HK_OK) status = hk_dynamics_remap(loop->dynamics, map, n_old);
  free(map);
  return status;
}

static hk_status emit(hk_loop *loop, hk_instance *source, double h, bool *changed) {
  hk_population_change change = hk_population_begin(loop->state, loop->scene, source);
  hk_view view = hk_instance_view(source, &loop->state->view);
  hk_status status = hk_instance_set_time(source, loop->state->t, loop->error);
  const hk_instance *outer = hk_enter(source);
  if (status == HK_OK) status = source->plugin->source->emit(source->self, &view, h, &change.population);
  status = hk_leave_with(source, outer, "emit", status);
  if (status == HK_OK && change.births + change.deaths) {
    status = apply(loop, &change);
    *changed = true;
  }
  hk_population_end(&change);
  return status;
}

hk_status hk_sources_emit(hk_loop *loop, double h) {
  const hk_instances *sources = &loop->plugins->kind[HK_SOURCE];
  hk_status status = HK_OK;
  bool changed = false;
  for (size_t k = 0; k < sources->count && status == HK_OK; k++)
    if (hk_force_acts_at(sources->item[k], loop->state->t)) status = emit(loop, sources->item[k], h, &changed);
  if (status != HK_OK || !changed) return status;
  loop->record->sourced = true;
  hk_step_reset(loop, HK_PARTICLES_CHANGED);
  return hk_step_reestimate(loop->step, loop->dynamics, true);
}
