/* The inner loops of the springs kernel, width by width, on particles that stay in the first-level cache: what they
 * cost beside memory. The widths take turns, and each figure is the least of its repeats by the wall clock: the clock
 * of a thread is corrected for stolen time on shared machines, and may be short.
 */
#include "core/engine/base/base.h"
#include "plugins/kit/springs/spring_kernel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 640, SPRINGS = HK_SPRING_BLOCK, CALLS = 16, REPEATS = 400, PATHS = 3, CASES = 8 };

typedef struct data {
  double x[3 * N + 8], v[3 * N + 8], F[3 * N + 8];
  double k[SPRINGS + HK_SPRING_WIDEST], c[SPRINGS + HK_SPRING_WIDEST], L[SPRINGS + HK_SPRING_WIDEST];
  uint32_t pair[SPRINGS][2];
} data;

typedef struct kind {
  const char *name;
  size_t apart; /* 0: a list */
  size_t each;  /* coefficients per spring */
  size_t gap;   /* one place of so many has no spring; 0: none */
} kind;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* As in a mesh, every particle of the second half has three springs to others, anywhere in the first half. */
static void fill_list(data *d) {
  uint32_t state = 12345;
  for (uint32_t e = 0; e < SPRINGS; e++) {
    state = state * 1664525 + 1013904223;
    d->pair[e][0] = N / 2 + e / 3, d->pair[e][1] = (uint32_t)(((uint64_t)state * (N / 2)) >> 32);
  }
}

static void fill(data *d) {
  for (size_t q = 0; q < 3 * N; q++) d->x[q] = sin(1.3 * (double)q), d->v[q] = cos(2.1 * (double)q);
  for (size_t e = 0; e < SPRINGS + HK_SPRING_WIDEST; e++)
    d->k[e] = 100 + (double)(e % 17), d->c[e] = 0.1 + 0.1 * (double)(e % 5), d->L[e] = 0.3 * (double)(e % 3);
  fill_list(d);
}

static double call(int lanes, data *d, const kind *a, bool damped) {
  size_t each = a->each ? ~(size_t)0 : 0, j = 3 * a->apart;
  uint8_t present[SPRINGS / 8];
  const hk_spring_ways at = {
      {d->k, d->c, d->L, each, each, each}, present, d->x, d->x + j, d->v, d->v + j, d->F, d->F + j};
  memset(present, 0xff, sizeof present);
  for (size_t e = 0; a->gap && e < SPRINGS; e += a->gap) present[e / 8] &= (uint8_t) ~(1u << e % 8);
  double start = now();
  for (int r = 0; r < CALLS; r++)
    if (a->apart >= HK_SPRING_FAR)
      HK_WIDEST(lanes, hk_spring_far_run)(&at, SPRINGS, damped);
    else if (a->apart)
      HK_WIDEST(lanes, hk_spring_near_run)(&at, SPRINGS, damped);
    else
      HK_WIDEST(lanes, hk_spring_list_run)(&at, (const uint32_t(*)[2])d->pair, SPRINGS, damped);
  return (now() - start) / (CALLS * SPRINGS) * 1e9;
}

int main(void) {
  const int widest = hk_processor_lanes();
  static const kind kinds[CASES] = {{"run, ends 1 apart", 1, 0, 0},        {"run, ends 2 apart", 2, 0, 0},
                                    {"run, 1 apart, with gaps", 1, 0, 64}, {"run, ends 129 apart", 129, 0, 0},
                                    {"run, ends 300 apart", 300, 0, 0},    {"run, 300, with gaps", 300, 0, 64},
                                    {"run, 300, each its own", 300, 1, 0}, {"list, each its own", 0, 1, 0}};
  data *d = aligned_alloc(64, (sizeof *d + 63) / 64 * 64);
  fill(d);
  printf("ns a spring in the cache:        2 lanes: damped, undamped   4: damped, undamped   8: damped, undamped\n");
  for (int k = 0; k < CASES; k++) {
    double least[PATHS][2] = {{1e9, 1e9}, {1e9, 1e9}, {1e9, 1e9}};
    for (int r = 0; r < REPEATS; r++)
      for (int p = 0; p < PATHS; p++)
        for (int damped = 0; damped < 2 && 2 << p <= widest; damped++)
          least[p][damped] = fmin(least[p][damped], call(2 << p, d, &kinds[k], damped));
    printf("%-30s", kinds[k].name);
    for (int p = 0; p < PATHS; p++)
      printf(" %14.2f %8.2f", 2 << p <= widest ? least[p][1] : NAN, 2 << p <= widest ? least[p][0] : NAN);
    printf("\n");
  }
  free(d);
  return 0;
}
