/* The cloth of scripts/scenes/cloth.lua with its stiffness as a parameter, for benchmarks of implicit methods: N x N
 * particles on the unit square, 0.15 kg, hung by the two upper corners; structural, shear and flexion springs of k,
 * 0.3 k and 0.05 k with damping that grows as the root of k. */
#ifndef HK_BENCH_CLOTH_H
#define HK_BENCH_CLOTH_H

#include "tests/support/engine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static inline double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static inline int rising(const void *a, const void *b) {
  double p = *(const double *)a, q = *(const double *)b;
  return (p > q) - (p < q);
}

static inline double median(double *list, size_t count) {
  qsort(list, count, sizeof *list, rising);
  return list[count / 2];
}

static inline void add_springs(test_engine *e, uint32_t N, const int offset[2][2], double k, double damping) {
  uint32_t(*edge)[2] = malloc(2 * (size_t)N * N * sizeof *edge);
  size_t count = 0;
  for (int o = 0; o < 2; o++)
    for (uint32_t j = 0; j + (uint32_t)offset[o][1] < N; j++)
      for (uint32_t i = 0; i < N; i++) {
        int64_t other = (int64_t)i + offset[o][0];
        if (other < 0 || other >= N) continue;
        edge[count][0] = j * N + i + 1;
        edge[count++][1] = (j + (uint32_t)offset[o][1]) * N + (uint32_t)other + 1;
      }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, count);
  test_number(e, springs, "k", k);
  test_number(e, springs, "damping", damping);
  free(edge);
}

/* On one thread, not yet running: the integrator and the options are the caller's. */
static inline void open_cloth(test_engine *e, uint32_t N, double k) {
  static const int structural[2][2] = {{1, 0}, {0, 1}}, shear[2][2] = {{1, 1}, {-1, 1}},
                   flexion[2][2] = {{2, 0}, {0, 2}};
  double c = sqrt(k / 1000);
  test_engine_open(e);
  e->scene->threads = 1;
  for (uint32_t i = 0; i < N * N; i++)
    test_particle(e, i % N / (N - 1.0), i / N / (N - 1.0), 0, 0.15 / ((double)N * N));
  test_pin(e, HK_PIN_FIXED, N * (N - 1) + 1, NULL);
  test_pin(e, HK_PIN_FIXED, N * N, NULL);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.02);
  add_springs(e, N, structural, k, 0.02 * c);
  add_springs(e, N, shear, 0.3 * k, 0.01 * c);
  add_springs(e, N, flexion, 0.05 * k, 0.005 * c);
}

#endif
