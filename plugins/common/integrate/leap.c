#include "plugins/common/integrate/leap.h"

#include <stdbool.h>

static inline __attribute__((always_inline)) void predict(const hk_leap *l, size_t begin, size_t end) {
  const double *restrict x = l->x, *restrict v = l->v, *restrict a = l->a, h = l->h, half = l->h / 2;
  double *restrict x_next = l->x_next, *restrict v_next = l->v_next;
  for (size_t e = begin; e < end; e++) {
    double kick = half * a[e], middle = v[e] + kick;
    x_next[e] = x[e] + h * middle;
    v_next[e] = middle + kick;
  }
}

static inline __attribute__((always_inline)) void kick(const hk_leap *l, size_t begin, size_t end) {
  const double *restrict v = l->v, *restrict a = l->a, half = l->h / 2;
  double *restrict v_next = l->v_next;
  for (size_t e = begin; e < end; e++) v_next[e] = 0.5 * (v[e] + v_next[e]) + half * a[e];
}

#if defined(__x86_64__)
#define WIDE __attribute__((target("avx2")))
static bool has_wide(void) { return __builtin_cpu_supports("avx2"); }
#else
#define WIDE
static bool has_wide(void) { return false; }
#endif

WIDE static void predict_wide(const hk_leap *l, size_t begin, size_t end) { predict(l, begin, end); }
WIDE static void kick_wide(const hk_leap *l, size_t begin, size_t end) { kick(l, begin, end); }

void hk_leap_predict(void *leap, size_t begin, size_t end) {
  if (has_wide())
    predict_wide(leap, 3 * begin, 3 * end);
  else
    predict(leap, 3 * begin, 3 * end);
}

void hk_leap_kick(void *leap, size_t begin, size_t end) {
  if (has_wide())
    kick_wide(leap, 3 * begin, 3 * end);
  else
    kick(leap, 3 * begin, 3 * end);
}
