/* The same loop with vectors of two doubles and of four: any squared distance outside of the limits? */
#include "plugins/common/strain/run_screen.h"

#include <stdint.h>

#define LOAD(type, p) (*(const type *)(p))

#define SCREEN(vector, mask, lanes)                                                                                    \
  mask any = {0};                                                                                                      \
  const vector zero = {0}, lowest = zero + low, highest = zero + high;                                                 \
  size_t k = 0;                                                                                                        \
  for (; k + (lanes) <= count; k += (lanes)) {                                                                         \
    vector dx = LOAD(vector, c->x[1] + k) - LOAD(vector, c->x[0] + k);                                                 \
    vector dy = LOAD(vector, c->y[1] + k) - LOAD(vector, c->y[0] + k);                                                 \
    vector dz = LOAD(vector, c->z[1] + k) - LOAD(vector, c->z[0] + k), l2 = dx * dx + dy * dy + dz * dz;               \
    any |= (mask)(l2 > highest) | (mask)(l2 < lowest);                                                                 \
  }                                                                                                                    \
  int64_t found = 0;                                                                                                   \
  for (int lane = 0; lane < (lanes); lane++) found |= any[lane];                                                       \
  for (; k < count; k++) {                                                                                             \
    double dx = c->x[1][k] - c->x[0][k], dy = c->y[1][k] - c->y[0][k], dz = c->z[1][k] - c->z[0][k];                   \
    double l2 = dx * dx + dy * dy + dz * dz;                                                                           \
    found |= l2 > high || l2 < low;                                                                                    \
  }                                                                                                                    \
  return found

typedef double half __attribute__((vector_size(16), aligned(8), may_alias));
typedef int64_t half_mask __attribute__((vector_size(16), aligned(8), may_alias));

bool hk_run_screen_narrow(const hk_run_ends *c, size_t count, double low, double high) { SCREEN(half, half_mask, 2); }

#if defined(__x86_64__)

typedef double wide __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t wide_mask __attribute__((vector_size(32), aligned(8), may_alias));

__attribute__((target("avx2"))) static bool screen_wide(const hk_run_ends *c, size_t count, double low, double high) {
  SCREEN(wide, wide_mask, 4);
}

hk_run_screen *hk_run_screen_wide(void) { return __builtin_cpu_supports("avx2") ? screen_wide : NULL; }

#else

hk_run_screen *hk_run_screen_wide(void) { return NULL; }

#endif

hk_run_screen *hk_run_screen_fastest(void) {
  hk_run_screen *wide_one = hk_run_screen_wide();
  return wide_one ? wide_one : hk_run_screen_narrow;
}
