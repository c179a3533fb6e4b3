/* Rigid bars: steps a second of chains of 100 to 100,000 bars that swing under gravity, by leapfrog on one thread, and
 * the time per bar and step; a truss of 10,000 bars: the time of the start with its only symbolic analysis, of a
 * factorization, and of a step. A chain is 1 m long and starts straight, 30 degrees from the vertical; h w = 0.5 for
 * its fastest wave, of w = 2 sqrt(g N/a). Least times of some repeats. */
#include "core/numerics/constraints/constraints.h"
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { REPEATS = 7, TRUSS_STEPS = 20 };

static const double g = 9.81;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *memory(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p) return p;
  fprintf(stderr, "no memory for %zu bars: close other programs\n", count);
  exit(1);
}

static void must(const test_engine *e, hk_status status) {
  if (status == HK_OK) return;
  fprintf(stderr, "%s\n", e->error.text);
  exit(1);
}

/* With one frame, at the end of all pieces. */
static void open_engine(test_engine *e, double h, size_t steps) {
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -g);
  e->options.dt = h;
  e->scene->fps = 1 / (h * (double)((REPEATS + 1) * steps));
  e->scene->duration = 1e9 * h;
}

/* Least time of a step, s of the wall, over pieces of `steps`. */
static double step_time(test_engine *e, double h, size_t steps) {
  double best = INFINITY;
  test_advance(e, (double)steps * h);
  for (int r = 0; r < REPEATS; r++) {
    double begin = now();
    test_advance(e, (double)(r + 2) * (double)steps * h);
    best = fmin(best, (now() - begin) / (double)steps);
  }
  return best;
}

/* Least time of an assembly and factorization, s of the wall. */
static double factorization_time(test_engine *e) {
  double best = INFINITY;
  for (int r = 0; r < REPEATS; r++) {
    double begin = now();
    must(e, hk_constraint_matrix_factorize(&e->run->dynamics));
    best = fmin(best, now() - begin);
  }
  return best;
}

static void chain(size_t bars) {
  double a = 1 / (double)bars, h = 0.25 / sqrt(g * (double)bars / a), *x = memory(3 * (bars + 1), sizeof *x);
  uint32_t(*edge)[2] = memory(bars, sizeof *edge), first;
  test_engine e;
  for (size_t i = 0; i <= bars; i++) x[3 * i] = 0.5 * a * (double)i, x[3 * i + 2] = -sqrt(0.75) * a * (double)i;
  for (size_t k = 0; k < bars; k++) edge[k][0] = (uint32_t)k + 1, edge[k][1] = (uint32_t)k + 2;
  size_t steps = 400000 / bars + 20;
  open_engine(&e, h, steps);
  must(&e, hk_scene_add_particles(e.scene, bars + 1, x, NULL, NULL, a, 0, &first, &e.error));
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])edge, bars);
  test_run(&e);
  double each = step_time(&e, h, steps);
  hk_summary s;
  hk_run_summary(e.run, &s);
  printf("chain of %6zu bars: %9.0f steps/s, %5.1f ns per bar and step, violation %.1e m, %zu factorizations in %zu "
         "steps\n",
         bars, 1 / each, 1e9 * each / (double)bars, s.constraint_violation, s.factorizations, s.steps);
  test_engine_close(&e);
  free(x);
  free(edge);
}

/* A girder of `cells` squares with both diagonals: 5 bars a cell, of which one follows from the others. */
static void truss(size_t cells) {
  size_t n = 2 * (cells + 1), bars = 5 * cells + 1;
  double a = 0.1, h = 1e-5, *x = memory(3 * n, sizeof *x);
  uint32_t(*edge)[2] = memory(bars, sizeof *edge), first;
  size_t k = 0;
  test_engine e;
  for (size_t i = 0; i < n; i++) x[3 * i] = a * (double)(i / 2), x[3 * i + 2] = a * (double)(i % 2);
  for (uint32_t c = 0; c <= cells; c++) {
    uint32_t low = 2 * c + 1;
    const uint32_t pair[5][2] = {
        {low, low + 1}, {low, low + 2}, {low + 1, low + 3}, {low, low + 3}, {low + 1, low + 2}};
    for (size_t j = 0; j < (c < cells ? 5 : 1); j++, k++) edge[k][0] = pair[j][0], edge[k][1] = pair[j][1];
  }
  open_engine(&e, h, TRUSS_STEPS);
  must(&e, hk_scene_add_particles(e.scene, n, x, NULL, NULL, 0.1, 0, &first, &e.error));
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_pin(&e, HK_PIN_FIXED, 2, NULL);
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])edge, bars);
  double begin = now();
  test_run(&e);
  double start = now() - begin, each = step_time(&e, h, TRUSS_STEPS), factorization = factorization_time(&e);
  hk_summary s;
  hk_run_summary(e.run, &s);
  printf("truss of %6zu bars: start %.1f ms (analysis, first factorizations, bars that follow from others), "
         "factorization %.2f ms, step %.2f ms, %.0f ns per bar, violation %.1e m\n",
         bars, 1e3 * start, 1e3 * factorization, 1e3 * each, 1e9 * each / (double)bars, s.constraint_violation);
  test_engine_close(&e);
  free(x);
  free(edge);
}

int main(void) {
  for (size_t bars = 100; bars <= 100000; bars *= 10) chain(bars);
  truss(2000);
  return 0;
}
