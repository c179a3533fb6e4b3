/* Sums in which every pair is met once are those of the plain sum, with every width of vectors and whatever the number
 * of bodies leaves over in blocks, tiles and teams; they have the same bits in whichever order threads take the
 * meetings of a round; and where they cannot be, it is said. */
#include "plugins/common/gravity/direct_sum.h"
#include "plugins/common/gravity/mutual_sum.h"
#include "core/engine/base/base.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 4500 };

/* A sum of n terms, in parts of some 64, is off by some roundings of the sum of their sizes; each term has about 6. */
static const double rounding = 4e-15;

typedef struct cluster {
  size_t n;
  double x[3 * MOST], mass[MOST], F[3 * MOST];
} cluster;

static void *take(const hk_host *host, size_t bytes) {
  (void)host;
  void *p = malloc(bytes + 64);
  return p ? memset(p, 0xff, bytes + 64) : NULL; /* NaN: what is not set is seen */
}

static void give(const hk_host *host, void *p) {
  (void)host;
  free(p);
}

static void forwards(const hk_host *host, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                     void *context) {
  (void)host;
  for (size_t k = 0; k * grain < count; k++)
    body(context, k * grain, (k + 1) * grain < count ? (k + 1) * grain : count, k);
}

static void backwards(const hk_host *host, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                      void *context) {
  (void)host;
  for (size_t k = (count + grain - 1) / grain; k-- > 0;)
    body(context, k * grain, (k + 1) * grain < count ? (k + 1) * grain : count, k);
}

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53;
}

static cluster *scatter(size_t n) {
  cluster *c = calloc(1, sizeof *c);
  uint64_t seed = 7;
  c->n = n;
  for (size_t i = 0; i < n; i++) c->mass[i] = 0.5 + noise(&seed);
  for (size_t k = 0; k < 3 * n; k++) c->x[k] = 100 * noise(&seed);
  return c;
}

/* Forces of direct_sum.c; whether each pair was met once for them, and whether no bodies are at one place. */
static bool sum(cluster *c, int lanes, double softening, bool reversed, bool *apart) {
  const hk_host host = {
      .lanes = lanes, .allocate = take, .release = give, .parallel_for = reversed ? backwards : forwards};
  hk_gravity_bodies g = {0};
  assert_int_equal(hk_gravity_reserve(&g, &host, c->n), HK_OK);
  g.count = g.sources = c->n, g.mutual = true;
  for (size_t k = 0; k < c->n; k++) g.order[k] = (uint32_t)k;
  hk_gravity_gather(&g, c->x, c->mass, softening);
  memset(c->F, 0, sizeof c->F);
  bool mutual = hk_mutual_pull(&g);
  *apart = hk_direct_forces(&g, 2, c->F);
  hk_gravity_release(&g);
  return mutual;
}

static void check_body(const cluster *c, size_t i, double softening) {
  long double a[3] = {0}, size = 0;
  for (size_t j = 0; j < c->n; j++) {
    long double d[3], s2 = (long double)softening * softening;
    for (size_t k = 0; k < 3; k++) d[k] = (long double)c->x[3 * j + k] - c->x[3 * i + k], s2 += d[k] * d[k];
    if (i == j) continue;
    for (size_t k = 0; k < 3; k++) a[k] += c->mass[j] * d[k] / (s2 * sqrtl(s2));
    size += c->mass[j] / s2;
  }
  for (size_t k = 0; k < 3; k++) {
    long double off = fabsl(c->F[3 * i + k] - 2 * c->mass[i] * a[k]) / (2 * c->mass[i] * size);
    if (!(off <= rounding)) fail_msg("body %zu of %zu: off by %.2Lg of the terms", i, c->n, off);
  }
}

static void sums_are_those_of_all_pairs(void **state) {
  (void)state;
  static const size_t counts[] = {48, 50, 63, 64, 128, 129, 191, 200, 449, 1003, MOST};
  for (size_t k = 0; k < sizeof counts / sizeof *counts; k++)
    for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2)
      for (int soft = 0; soft < 2; soft++) {
        cluster *c = scatter(counts[k]);
        bool apart;
        assert_true(sum(c, lanes, 3.0 * soft, false, &apart) && apart);
        for (size_t i = 0; i < c->n; i += c->n / 100 + 1) check_body(c, i, 3.0 * soft);
        check_body(c, c->n - 1, 3.0 * soft);
        free(c);
      }
}

static void bits_do_not_depend_on_the_order_of_meetings(void **state) {
  (void)state;
  bool apart;
  cluster *c = scatter(1003), *d = scatter(1003);
  assert_true(sum(c, hk_processor_lanes(), 0, false, &apart));
  assert_true(sum(d, hk_processor_lanes(), 0, true, &apart));
  assert_memory_equal(c->F, d->F, sizeof c->F);
  free(c);
  free(d);
}

/* Pairs of one vector, of one tile, and of two; of softening 0 and with it. */
static void bodies_at_one_place_are_noticed(void **state) {
  (void)state;
  static const size_t pairs[][2] = {{0, 1}, {17, 40}, {3, 150}, {198, 199}};
  for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++)
    for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
      cluster *c = scatter(200);
      bool apart;
      memcpy(c->x + 3 * pairs[k][0], c->x + 3 * pairs[k][1], 3 * sizeof *c->x);
      assert_false(sum(c, lanes, 0, false, &apart));
      assert_false(apart);
      assert_true(sum(c, lanes, 1, false, &apart) && apart);
      check_body(c, pairs[k][0], 1);
      free(c);
    }
}

/* Of distances whose squares floats do not have, estimates make no number: every pair is then taken twice, by roots. */
static void bodies_beyond_the_range_of_estimates_are_summed_by_roots(void **state) {
  (void)state;
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    cluster *c = scatter(200);
    bool apart;
    for (size_t k = 0; k < 3; k++) c->x[k] = c->x[3 * 150 + k] = 0;
    c->x[0] = 1e-22;
    assert_int_equal(sum(c, lanes, 0, false, &apart), lanes != 4);
    assert_true(apart);
    check_body(c, 0, 0);
    check_body(c, 150, 0);
    free(c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_are_those_of_all_pairs),
      cmocka_unit_test(bits_do_not_depend_on_the_order_of_meetings),
      cmocka_unit_test(bodies_at_one_place_are_noticed),
      cmocka_unit_test(bodies_beyond_the_range_of_estimates_are_summed_by_roots),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
