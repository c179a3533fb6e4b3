/* Whether a function of time of the script, a parameter or a pin's path, varies between the time steps: a pulse of one
 * millisecond between steps of sixteen, or an oscillation with the period of the steps. A function is sampled with up
 * to 64 times as many points as the run took steps; it varies between steps when the total variation at these points is
 * more than 1.5 times that at the steps. */
#include "core/judge/judge.h"

#include <string.h>

enum { PER_STEP = 64, MOST = 3 };
static const size_t most_samples = 100000;
static const double variation_ratio = 1.5;

static bool varies_between_steps(hk_loop *loop, const hk_function *f) {
  size_t steps = loop->record->steps ? loop->record->steps : 1,
         per_step = most_samples / steps < PER_STEP ? most_samples / steps : PER_STEP;
  double last[MOST] = {0}, last_at_step[MOST] = {0}, variation = 0, variation_at_steps = 0, size = 0;
  hk_error error = {0};
  if (!f->call || per_step < 2) return false;
  for (size_t k = 0; k <= steps * per_step; k++) {
    double t = loop->state->t * (double)k / (double)(steps * per_step), value[2 * MOST] = {0};
    size_t got = 0;
    if (f->call(f, NULL, &t, 1, value, 2 * MOST, &got, &error) != HK_OK)
      return false; /* the run never evaluated f at this t */
    for (int c = 0; c < MOST; c++) {
      if (k > 0) variation += fabs(value[c] - last[c]);
      if (k > 0 && k % per_step == 0) variation_at_steps += fabs(value[c] - last_at_step[c]);
      size = fmax(size, fabs(value[c]));
    }
    memcpy(last, value, sizeof last);
    if (k % per_step == 0) memcpy(last_at_step, value, sizeof last_at_step);
  }
  return variation > variation_ratio * variation_at_steps + 1e-9 * size;
}

static bool any_varies(hk_loop *loop, const hk_plugin_spec *spec) {
  for (size_t j = 0; j < spec->timed_count; j++)
    if (varies_between_steps(loop, &spec->timed[j].function)) return true;
  return false;
}

bool hk_varies_between_steps(hk_loop *loop) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR};
  for (size_t q = 0; q < sizeof kinds / sizeof *kinds; q++)
    for (size_t k = 0; k < loop->plugins->kind[kinds[q]].count; k++)
      if (any_varies(loop, loop->plugins->kind[kinds[q]].item[k]->spec)) return true;
  for (size_t k = 0; k < loop->pins->count; k++)
    if (varies_between_steps(loop, &loop->pins->item[k].spec->path)) return true;
  return false;
}
