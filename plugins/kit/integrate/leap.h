/* A leapfrog step's operations on a block of particles, before and after the evaluation at its end:
 *     x' = x + h (v + h/2 a),   v + h a;   then v' = v + h/2 (a + a'). */
#ifndef HK_LEAP_H
#define HK_LEAP_H

#include <stddef.h>
#include "core/plugin.h"

/* The state and its slope at the start of a step, and at its end. */
typedef struct hk_leap {
  const double *x, *v, *a;
  double *x_next, *v_next;
  const double *a_next;
  double h;
  int lanes; /* hk_host.lanes */
} hk_leap;

/* hk_fused.before and after, of an hk_leap: of the particles begin to end - 1. */
static inline void hk_leap_predict(void *leap, size_t begin, size_t end);
static inline void hk_leap_predict_here(void *leap, size_t begin, size_t end); /* in place, from x_next and v_next */
static inline void hk_leap_kick(void *leap, size_t begin,
                                size_t end); /* of v and v + h a: `a` may have become a_next */
static inline void hk_leap_correct(void *leap, size_t begin,
                                   size_t end); /* the same of v + h a and both slopes: v is not read */

/* ---- how ---- */

HK_INLINE void hk_leap_predict_each(const hk_leap *l, size_t begin, size_t end, bool here) {
  double *restrict x_next = l->x_next, *restrict v_next = l->v_next;
  const double *x = here ? x_next : l->x, *v = here ? v_next : l->v, *restrict a = l->a, h = l->h, half = l->h / 2;
  for (size_t e = begin; e < end; e++) {
    double hk_leap_kicks = half * a[e], middle = v[e] + hk_leap_kicks;
    x_next[e] = x[e] + h * middle;
    v_next[e] = middle + hk_leap_kicks;
  }
}

HK_INLINE void hk_leap_kick_each(const hk_leap *l, size_t begin, size_t end) {
  const double *restrict v = l->v, *restrict a_next = l->a_next, half = l->h / 2;
  double *restrict v_next = l->v_next;
  for (size_t e = begin; e < end; e++) v_next[e] = 0.5 * (v[e] + v_next[e]) + half * a_next[e];
}

HK_INLINE void hk_leap_correct_each(const hk_leap *l, size_t begin, size_t end) {
  const double *restrict a = l->a, *restrict a_next = l->a_next, half = l->h / 2;
  double *restrict v_next = l->v_next;
  for (size_t e = begin; e < end; e++) v_next[e] += half * (a_next[e] - a[e]);
}

#define HK_LEAP_PARAMETERS (void *leap, size_t begin, size_t end)
HK_VERSIONS(static inline void, hk_leap_predicts, HK_LEAP_PARAMETERS,
            hk_leap_predict_each(leap, 3 * begin, 3 * end, false))
HK_VERSIONS(static inline void, hk_leap_predicts_here, HK_LEAP_PARAMETERS,
            hk_leap_predict_each(leap, 3 * begin, 3 * end, true))
HK_VERSIONS(static inline void, hk_leap_kicks, HK_LEAP_PARAMETERS, hk_leap_kick_each(leap, 3 * begin, 3 * end))
HK_VERSIONS(static inline void, hk_leap_corrects, HK_LEAP_PARAMETERS, hk_leap_correct_each(leap, 3 * begin, 3 * end))

static inline int hk_leap_lanes(const hk_leap *l) { return l->lanes; }

static inline void hk_leap_predict(void *leap, size_t begin, size_t end) {
  HK_WIDEST(hk_leap_lanes(leap), hk_leap_predicts)(leap, begin, end);
}
static inline void hk_leap_predict_here(void *leap, size_t begin, size_t end) {
  HK_WIDEST(hk_leap_lanes(leap), hk_leap_predicts_here)(leap, begin, end);
}
static inline void hk_leap_kick(void *leap, size_t begin, size_t end) {
  HK_WIDEST(hk_leap_lanes(leap), hk_leap_kicks)(leap, begin, end);
}
static inline void hk_leap_correct(void *leap, size_t begin, size_t end) {
  HK_WIDEST(hk_leap_lanes(leap), hk_leap_corrects)(leap, begin, end);
}

#endif
