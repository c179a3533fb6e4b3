#include "plugins/common/integrate/leap.h"

#include "core/plugin.h"

HK_INLINE void predict_each(const hk_leap *l, size_t begin, size_t end, bool here) {
  double *restrict x_next = l->x_next, *restrict v_next = l->v_next;
  const double *x = here ? x_next : l->x, *v = here ? v_next : l->v, *restrict a = l->a, h = l->h, half = l->h / 2;
  for (size_t e = begin; e < end; e++) {
    double kick = half * a[e], middle = v[e] + kick;
    x_next[e] = x[e] + h * middle;
    v_next[e] = middle + kick;
  }
}

HK_INLINE void kick_each(const hk_leap *l, size_t begin, size_t end) {
  const double *restrict v = l->v, *restrict a_next = l->a_next, half = l->h / 2;
  double *restrict v_next = l->v_next;
  for (size_t e = begin; e < end; e++) v_next[e] = 0.5 * (v[e] + v_next[e]) + half * a_next[e];
}

HK_INLINE void correct_each(const hk_leap *l, size_t begin, size_t end) {
  const double *restrict a = l->a, *restrict a_next = l->a_next, half = l->h / 2;
  double *restrict v_next = l->v_next;
  for (size_t e = begin; e < end; e++) v_next[e] += half * (a_next[e] - a[e]);
}

#define PARAMETERS (void *leap, size_t begin, size_t end)
HK_VERSIONS(static void, predict, PARAMETERS, predict_each(leap, 3 * begin, 3 * end, false))
HK_VERSIONS(static void, predict_here, PARAMETERS, predict_each(leap, 3 * begin, 3 * end, true))
HK_VERSIONS(static void, kick, PARAMETERS, kick_each(leap, 3 * begin, 3 * end))
HK_VERSIONS(static void, correct, PARAMETERS, correct_each(leap, 3 * begin, 3 * end))

void hk_leap_predict(void *leap, size_t begin, size_t end) { HK_WIDEST(predict)(leap, begin, end); }
void hk_leap_predict_here(void *leap, size_t begin, size_t end) { HK_WIDEST(predict_here)(leap, begin, end); }
void hk_leap_kick(void *leap, size_t begin, size_t end) { HK_WIDEST(kick)(leap, begin, end); }
void hk_leap_correct(void *leap, size_t begin, size_t end) { HK_WIDEST(correct)(leap, begin, end); }
