/* Rigid zones keep momentum and angular momentum, move as one body, and follow their pins; the repulsion of Bridson and
 * others never separates faster than a tenth of the overlap a step. Sums of some ten numbers of order 1 are right to
 * 1e-15 each; a body on a line has a spin that is known to 1e-13 of it (zones.c). */
#include "core/engine/base/base.h"
#include "plugins/common/contact/impulses/proximity.h"
#include "plugins/common/contact/impulses/zones.h"
#include "tests/support/plain_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 12 };
static const double rounding = 1e-12;

static const hk_host host = {.allocate = test_allocate, .release = test_release};

typedef struct world {
  double mass[N], inverse_mass[N], x_from[3 * N], x[3 * N], v[3 * N];
  hk_zones zones;
} world;

static double uniform(uint64_t seed[4]) { return 2 * hk_random_uniform(seed) - 1; }

static void open_world(world *w, uint64_t seed[4], double flat) {
  memset(w, 0, sizeof *w);
  for (int i = 0; i < N; i++) {
    w->mass[i] = 1.5 + uniform(seed);
    w->inverse_mass[i] = 1 / w->mass[i];
  }
  for (int k = 0; k < 3 * N; k++) {
    w->x_from[k] = uniform(seed) * (k % 3 == 0 ? 1 : flat);
    w->v[k] = uniform(seed);
    w->x[k] = w->x_from[k] + 0.1 * w->v[k] + 0.01 * uniform(seed);
  }
  assert_int_equal(hk_zones_open(&w->zones, &host, N), HK_OK);
}

static void close_world(world *w) {
  free(w->zones.zone);
  free(w->zones.next);
  free(w->zones.member);
}

/* Two zones, {0 1 2 3 4 5} and {6 7 8 9}, of pairs that chain. */
static void merge(world *w) {
  hk_impact pairs[] = {{.pair.vertex = {4, 5, 3, 0}}, {.pair.vertex = {9, 8, 7, 6}}, {.pair.vertex = {0, 1, 2, 3}}};
  hk_zones_merge(&w->zones, &(hk_contact_solver){.count = 3, .impact = pairs});
}

static bool apply(world *w) {
  return hk_zones_apply(&w->zones, &(hk_zones_move){0.1, w->mass, w->x_from, w->x, w->v, w->inverse_mass});
}

static void sums(const world *w, double out[9]) {
  memset(out, 0, 9 * sizeof *out);
  for (int i = 0; i < N; i++)
    for (int c = 0; c < 3; c++) {
      const double *x = w->x + 3 * i, *v = w->v + 3 * i;
      int a = (c + 1) % 3, b = (c + 2) % 3;
      out[c] += w->mass[i] * v[c];
      out[3 + c] += w->mass[i] * (x[a] * v[b] - x[b] * v[a]);
      out[6 + c] += w->mass[i] * x[c];
    }
}

static double distance(const double *x, int i, int j) {
  return sqrt(pow(x[3 * i] - x[3 * j], 2) + pow(x[3 * i + 1] - x[3 * j + 1], 2) + pow(x[3 * i + 2] - x[3 * j + 2], 2));
}

static void assert_rigid(const world *w, int begin, int end) {
  for (int i = begin; i < end; i++)
    for (int j = begin; j < i; j++) {
      double closing = 0;
      for (int c = 0; c < 3; c++) closing += (w->x[3 * i + c] - w->x[3 * j + c]) * (w->v[3 * i + c] - w->v[3 * j + c]);
      assert_true(fabs(distance(w->x, i, j) - distance(w->x_from, i, j)) < rounding);
      assert_true(fabs(closing) < rounding);
    }
}

static void zones_keep_momentum_and_are_rigid(void **state) {
  (void)state;
  uint64_t seed[4];
  hk_random_seed(seed, 3);
  for (int k = 0; k < 50; k++) {
    world w;
    double before[9], after[9], last[6];
    open_world(&w, seed, 1);
    sums(&w, before);
    memcpy(last, w.x + 30, sizeof last);
    merge(&w);
    assert_true(apply(&w));
    sums(&w, after);
    for (int c = 0; c < 9; c++)
      if (!(fabs(after[c] - before[c]) < rounding * N)) fail_msg("%d: %g, was %g", c, after[c], before[c]);
    assert_rigid(&w, 0, 6);
    assert_rigid(&w, 6, 10);
    assert_memory_equal(last, w.x + 30, sizeof last);
    close_world(&w);
  }
}

/* A zone whose particles lie on a line is one as well. */
static void zones_on_a_line_stay_finite(void **state) {
  (void)state;
  uint64_t seed[4];
  hk_random_seed(seed, 4);
  world w;
  open_world(&w, seed, 0);
  merge(&w);
  assert_true(apply(&w));
  for (int k = 0; k < 3 * N; k++) assert_true(isfinite(w.x[k]) && isfinite(w.v[k]));
  assert_true(fabs(distance(w.x, 0, 5) - distance(w.x_from, 0, 5)) < rounding);
  close_world(&w);
}

/* Pins that turn by 0.3 rad take the zone along; pins that go apart are refused. */
static void zones_follow_their_pins(void **state) {
  (void)state;
  uint64_t seed[4];
  hk_random_seed(seed, 5);
  world w;
  open_world(&w, seed, 1);
  for (int i = 0; i < 4; i++) {
    w.inverse_mass[i] = 0;
    const double *x = w.x_from + 3 * i;
    memcpy(w.x + 3 * i, (double[]){cos(0.3) * x[0] - sin(0.3) * x[1], sin(0.3) * x[0] + cos(0.3) * x[1], x[2]},
           3 * sizeof *x);
  }
  merge(&w);
  assert_true(apply(&w));
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < i; j++) assert_true(fabs(distance(w.x, i, j) - distance(w.x_from, i, j)) < 1e-9);
  w.x[0] += 0.1;
  assert_false(apply(&w));
  close_world(&w);
}

static void repulsion_is_bounded(void **state) {
  (void)state;
  uint64_t seed[4];
  hk_random_seed(seed, 6);
  for (int k = 0; k < 1000; k++) {
    double h = 0.01, d = 0.001 * hk_random_uniform(seed), u[12], inverse_mass[4], r = 0;
    hk_impact pair = {.pair = {.vertex = {0, 1, 2, 3}, .gap = -d},
                      .frame = {.w = {1, -0.2, -0.3, -0.5}, .n = {0, 0, 1}}};
    for (int i = 0; i < 4; i++) {
      inverse_mass[i] = 1 / (1.2 + uniform(seed));
      pair.mobility += pair.frame.w[i] * pair.frame.w[i] * inverse_mass[i];
    }
    for (int i = 0; i < 12; i++) u[i] = 0.01 * uniform(seed);
    double before = 0;
    for (int i = 0; i < 4; i++) before += pair.frame.w[i] * u[3 * i + 2];
    hk_proximity law = {h, pow(10, 6 * hk_random_uniform(seed)), 0.3, 0, inverse_mass};
    double impulse = hk_proximity_repel(&law, &(hk_contact_solver){.count = 1, .impact = &pair}, u);
    for (int i = 0; i < 4; i++) r += pair.frame.w[i] * u[3 * i + 2];
    assert_true(r <= fmax(before, 0.1 * d / h) + 1e-15 && r >= fmin(0, before) - 1e-15 && impulse >= 0);
    if (before < 0) assert_true(r >= 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(zones_keep_momentum_and_are_rigid),
      cmocka_unit_test(zones_on_a_line_stay_finite),
      cmocka_unit_test(zones_follow_their_pins),
      cmocka_unit_test(repulsion_is_bounded),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
