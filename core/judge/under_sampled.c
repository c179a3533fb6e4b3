/* Whether what the script drives by functions of time, parameters and pins, changes between the steps unseen: a push of
 * a millisecond amid steps of sixteen, or a swing in step with them. A function is sampled up to 64 times as often as
 * the run stepped; it hides something when its total variation is then half as large again as at the steps. */
#include "core/judge/judge.h"

#include <string.h>

enum { PER_STEP = 64, MOST = 3 };
static const size_t most_samples = 100000;
static const double hidden = 1.5;

static bool hides(hk_loop *loop, const hk_function *f) {
  size_t steps = loop->record->steps ? loop->record->steps : 1,
         fine = most_samples / steps < PER_STEP ? most_samples / steps : PER_STEP;
  double last[MOST] = {0}, last_seen[MOST] = {0}, variation = 0, seen = 0, size = 0;
  hk_error error = {0};
  if (!f->call || fine < 2) return false;
  for (size_t k = 0; k <= steps * fine; k++) {
    double t = loop->state->t * (double)k / (double)(steps * fine), value[2 * MOST] = {0};
    size_t got = 0;
    if (f->call(f, NULL, &t, 1, value, 2 * MOST, &got, &error) != HK_OK)
      return false; /* the run did not ask for this t */
    for (int c = 0; c < MOST; c++) {
      if (k > 0) variation += fabs(value[c] - last[c]);
      if (k > 0 && k % fine == 0) seen += fabs(value[c] - last_seen[c]);
      size = fmax(size, fabs(value[c]));
    }
    memcpy(last, value, sizeof last);
    if (k % fine == 0) memcpy(last_seen, value, sizeof last_seen);
  }
  return variation > hidden * seen + 1e-9 * size;
}

bool hk_varies_between_steps(hk_loop *loop) {
  for (size_t k = 0; k < loop->plugins->kind[HK_FORCE].count; k++)
    for (size_t j = 0; j < loop->plugins->kind[HK_FORCE].item[k]->spec->timed_count; j++)
      if (hides(loop, &loop->plugins->kind[HK_FORCE].item[k]->spec->timed[j].function)) return true;
  for (size_t k = 0; k < loop->pins->count; k++)
    if (hides(loop, &loop->pins->item[k].spec->path)) return true;
  return false;
}
