/* Most particles by vectors, those beyond them, or those of a list, one at a time. */
#include "plugins/common/parts/scaled_sums.h"

#include <string.h>

enum { EIGHT = 8 };

#define HK_LOOPS "plugins/common/parts/scaled_loop.h"
#include "core/plugin/each_width.h"

static double add_one(const hk_scaled *s, size_t i, double *F) {
  const double *u = s->u ? s->u + 3 * i : s->common, scale = s->each + s->times * s->by[i];
  for (size_t c = 0; c < 3; c++) F[3 * i + c] += scale * u[c];
  return s->u ? scale * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) : 0;
}

double hk_scaled_sums_add(const hk_scaled *s, const hk_view *view, size_t begin, size_t end, double *F) {
  size_t single = view->active ? begin : end - (end - begin) % EIGHT;
  double pattern[3 * EIGHT];
  for (size_t l = 0; l < 3 * EIGHT; l++) pattern[l] = s->common[l % 3];
  double power = HK_WIDEST(add_eights)(s, pattern, begin, single, F);
  for (size_t k = single; k < end; k++) power += add_one(s, hk_acting_particle(view, k), F);
  return power;
}
