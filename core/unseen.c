/* Whether what the script drives by functions of time, parameters and pins, changes between the steps unseen: a push of
 * a millisecond amid steps of sixteen, or a swing in step with them. A function is sampled up to 64 times as often as
 * the run stepped; it hides something when its total variation is then half as large again as at the steps. */
#include "core/engine.h"

#include <string.h>

enum { PER_STEP = 64, MOST = 3 };
static const double most_samples = 1e5, hidden = 1.5;

static bool hides(hk_run *run, const hk_function *f) {
  double steps = fmax(1, (double)run->steps), fine = fmin(PER_STEP, floor(most_samples / steps));
  double last[MOST] = {0}, last_seen[MOST] = {0}, variation = 0, seen = 0, size = 0;
  hk_error error = {0};
  if (!f->call || fine < 2) return false;
  for (double k = 0; k <= steps * fine; k++) {
    double t = run->system.t * k / (steps * fine), value[2 * MOST] = {0};
    size_t got = 0;
    if (f->call(f, &t, 1, value, 2 * MOST, &got, &error) != HK_OK) return false; /* the run did not ask for this t */
    for (int c = 0; c < MOST; c++) {
      if (k > 0) variation += fabs(value[c] - last[c]);
      if (k > 0 && fmod(k, fine) == 0) seen += fabs(value[c] - last_seen[c]);
      size = fmax(size, fabs(value[c]));
    }
    memcpy(last, value, sizeof last);
    if (fmod(k, fine) == 0) memcpy(last_seen, value, sizeof last_seen);
  }
  return variation > hidden * seen + 1e-9 * size;
}

bool hk_varies_unseen(hk_run *run) {
  for (size_t k = 0; k < run->scene->force.count; k++)
    for (size_t j = 0; j < run->scene->force.item[k]->timed_count; j++)
      if (hides(run, &run->scene->force.item[k]->timed[j].function)) return true;
  for (size_t k = 0; k < run->pins; k++)
    if (hides(run, &run->pin_state[k].spec->path)) return true;
  return false;
}
