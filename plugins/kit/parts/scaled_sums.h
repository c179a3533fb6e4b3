/* Forces on each particle alone that are a number times a vector: F_i += s_i u_i, s_i = each + times by_i. */
#ifndef HK_SCALED_SUMS_H
#define HK_SCALED_SUMS_H

#include "plugins/kit/parts/particle_sums.h"
#include <string.h>

typedef struct hk_scaled {
  double each, times;
  const double *by; /* n: masses, say, or radii */
  const double *u;  /* n x 3; NULL: `common` for all */
  double common[3];
} hk_scaled;

/* An hk_range_body without its first argument. Returns the sum of s_i u_i.u_i, W where u is the velocity, and 0 where
 * it is common; the same bits for any width of vectors. */
static inline double hk_scaled_sums_add(const hk_scaled *, const hk_view *view, size_t begin, size_t end, double *F);

/* ---- how ---- */

/* Most particles by vectors, those beyond them, or those of a list, one at a time. */

enum { HK_SCALED_EIGHT = 8 };

#define HK_LOOPS "plugins/kit/parts/scaled_loop.h"
#include "core/plugin/each_width.h"

static inline double hk_scaled_one(const hk_scaled *s, size_t i, double *F) {
  const double *u = s->u ? s->u + 3 * i : s->common, scale = s->each + s->times * s->by[i];
  for (size_t c = 0; c < 3; c++) F[3 * i + c] += scale * u[c];
  return s->u ? scale * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) : 0;
}

static inline double hk_scaled_many(const hk_scaled *s, int lanes, size_t begin, size_t end, double *F) {
  double pattern[3 * HK_SCALED_EIGHT];
  for (size_t l = 0; l < 3 * HK_SCALED_EIGHT; l++) pattern[l] = s->common[l % 3];
  return HK_WIDEST(lanes, hk_scaled_eights)(s, pattern, begin, end, F);
}

static inline double hk_scaled_sums_add(const hk_scaled *s, const hk_view *view, size_t begin, size_t end, double *F) {
  size_t single = view->active ? begin : end - (end - begin) % HK_SCALED_EIGHT;
  double power = single > begin ? hk_scaled_many(s, view->host->lanes, begin, single, F) : 0;
  for (size_t k = single; k < end; k++) power += hk_scaled_one(s, hk_acting_particle(view, k), F);
  return power;
}

#endif
