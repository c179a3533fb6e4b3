/* Tiles, several steps at once (hk_tile_facet), where nobody needs the states between them: no corrector, source,
 * constraint, contact or moving pin does something at every step. Whether it is done, and in which order forces are
 * summed, follows from the scene, not from the number of threads or of steps. */
#include "core/engine/contract/contract.h"
#include "core/engine/loop/loop.h"

static size_t lesser(size_t a, size_t b) { return a < b ? a : b; }

/* Whether somebody may look at every step. A force that states its encounters counts as one even where nobody asks it:
 * whether a run is compared with another must not change its bits. */
static bool is_watched(const hk_loop *loop) {
  const hk_instances *kind = loop->plugins->kind;
  bool short_range = false;
  for (size_t k = 0; k < kind[HK_FORCE].count; k++)
    short_range |= hk_force_of(kind[HK_FORCE].item[k]->plugin)->encounters.find != NULL;
  return short_range || kind[HK_CORRECTOR].count || kind[HK_SOURCE].count || loop->hooks.moved ||
         loop->hooks.before_sample || loop->integrator->spec->timed_count;
}

/* Of the steps between two cuts: the first tiles are shorter, as the state is seen at their ends only. */
enum { EARLY_PARTS = 3 };

bool hk_tile_fits(const hk_loop *loop) {
  return hk_integrator_tables_of(loop->method)->tile.steps && !is_watched(loop) &&
         hk_evaluate_takes_several(loop->dynamics);
}

size_t hk_tile_length(const hk_loop *loop, const hk_piece *p) {
  size_t steps = loop->record->steps, now = loop->dynamics->count.evaluations, watch_at = loop->step->watch_at;
  size_t length = lesser(p->n - p->i + 1, HK_TILE_STEPS - steps % HK_TILE_STEPS);
  if (steps < HK_EARLY_STEPS) length = lesser(length, p->n < EARLY_PARTS ? 1 : p->n / EARLY_PARTS);
  length = lesser(length, hk_evaluate_several_most(loop->dynamics));
  if (loop->schedule.step_limit) length = lesser(length, loop->schedule.step_limit - steps);
  return watch_at > now ? lesser(length, watch_at - now) : length;
}

/* s, the end of step i of the piece. */
static double end_of(const hk_piece *p, size_t i) { return i == p->n ? p->stop : p->begin + (double)i * p->h; }

/* *length steps from step i of the piece, or none; the state changes only if they succeed. */
static hk_status advance(hk_loop *loop, const hk_piece *p, size_t i, size_t *length) {
  hk_system *s = &loop->dynamics->system;
  hk_instance *integrator = loop->integrator;
  double t[HK_TILE_STEPS];
  for (size_t k = 0; k < *length; k++) t[k] = end_of(p, i + k);
  const hk_instance *outer = hk_enter(integrator);
  const hk_integrator *method = loop->method;
  hk_status status = hk_integrator_tables_of(method)->tile.steps(integrator->self, method->method, s, t, p->h, length);
  status = hk_leave_with(integrator, outer, "tile", status);
  if (status != HK_OK || *length == 0) return status;
  s->exchange(s);
  for (size_t k = 0; k < *length && status == HK_OK; k++) {
    hk_step_set_time(loop, t[k]);
    status = hk_step_accept(loop, p->h, NAN);
  }
  return status;
}

static hk_status advance_one(hk_loop *loop, const hk_piece *p, size_t i) {
  size_t length = 1;
  hk_status status = advance(loop, p, i, &length);
  return status == HK_OK && length == 0 ? hk_step_fixed(loop, end_of(p, i), p->h) : status;
}

/* Steps that fail together are repeated one by one, so that the state is that before the one which fails. */
hk_status hk_tile_take(hk_loop *loop, const hk_piece *p, size_t *length) {
  size_t wanted = *length, steps = loop->record->steps;
  hk_status status = advance(loop, p, p->i, length);
  if (status == HK_OK && *length > 0) return HK_OK;
  *length = status == HK_OK ? 1 : wanted;
  if (loop->record->steps > steps) return status; /* the state after them is not finite */
  if (status != HK_OK) hk_step_reset(loop, HK_STATE_CHANGED);
  hk_error_clear(loop->error);
  status = HK_OK;
  for (size_t k = 0; k < *length && status == HK_OK; k++) status = advance_one(loop, p, p->i + k);
  return status;
}
