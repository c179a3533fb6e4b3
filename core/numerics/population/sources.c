/* Births and deaths: before a step the sources are called, and after it those that ask for it (HK_AFTER_STEPS). What
 * they request takes effect together in state, dynamics and plugins, so that ids rise with the times of birth whatever
 * the sources' order; then newborn particles are moved from their births to the present. */
#include "core/numerics/population/population.h"

static hk_status apply(hk_loop *loop, double h) {
  hk_population_change *change = loop->population;
  size_t n_old = loop->state->model.n;
  hk_status status = hk_population_apply(change, loop->error);
  if (status == HK_OK) status = hk_dynamics_remap(loop->dynamics, change->map, n_old);
  if (status == HK_OK) status = hk_newborns_move(loop->dynamics, change->birth, change->births, h);
  if (status != HK_OK) return status;
  loop->record->sourced = true;
  hk_step_reset(loop, HK_PARTICLES_CHANGED);
  hk_step_length *step = loop->step;
  return step->review ? step->review(step, loop->dynamics, change->births, change->deaths) : HK_OK;
}

static hk_status emit(hk_loop *loop, hk_instance *source, double h) {
  hk_view view = hk_instance_view(source, &loop->state->view);
  hk_status status = hk_instance_set_time(source, loop->state->t, loop->error);
  const hk_instance *outer = hk_enter(source);
  double begin = hk_clock();
  loop->population->source = source;
  if (status == HK_OK) status = source->plugin->source->emit(source->self, &view, h, &loop->population->population);
  source->seconds += hk_clock() - begin;
  return hk_leave_with(source, outer, "emit", status);
}

/* What births and deaths take is the time of the sources, in equal parts. */
static hk_status apply_and_time(hk_loop *loop, double h) {
  const hk_instances *sources = &loop->plugins->kind[HK_SOURCE];
  double begin = hk_clock();
  hk_status status = apply(loop, h);
  for (size_t k = 0; k < sources->count; k++)
    sources->item[k]->seconds += (hk_clock() - begin) / (double)sources->count;
  return status;
}

hk_status hk_sources_emit(hk_loop *loop, double h, unsigned when) {
  const hk_instances *sources = &loop->plugins->kind[HK_SOURCE];
  if (sources->count == 0) return HK_OK;
  hk_status status = hk_population_begin(loop->population, loop->error);
  for (size_t k = 0; k < sources->count && status == HK_OK; k++)
    if ((sources->item[k]->plugin->source->flags & HK_AFTER_STEPS) == when) status = emit(loop, sources->item[k], h);
  bool any = loop->population->births + loop->population->deaths > 0;
  return status == HK_OK && any ? apply_and_time(loop, h) : status;
}
