/* The tree's sums in single precision are as good as those in double precision, with every width of vectors, and where
 * they cannot be, sums are in double precision: bodies far closer than single precision tells apart, masses and places
 * of any range. */
#include "plugins/common/gravity/tree/tree_sum.h"
#include "core/engine/base/base.h"
#include "plugins/common/space/octree_builder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 1000 };

typedef struct cluster {
  double x[3 * N], mass[N], found[3 * N];
  long double exact[3 * N];
} cluster;

static void *take(const hk_host *host, size_t bytes) {
  (void)host;
  return calloc(bytes + 64, 1);
}

static void give(const hk_host *host, void *p) {
  (void)host;
  free(p);
}

static void in_turn(const hk_host *host, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                    void *context) {
  (void)host, (void)grain;
  if (count) body(context, 0, count, 0);
}

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53;
}

static void scatter(cluster *c, double size, double mass) {
  uint64_t seed = 7;
  for (size_t i = 0; i < N; i++) c->mass[i] = mass * (0.5 + noise(&seed));
  for (size_t k = 0; k < 3 * N; k++) c->x[k] = size * pow(noise(&seed) - 0.5, 3);
}

static void sum_exactly(cluster *c, double softening) {
  memset(c->exact, 0, sizeof c->exact);
  for (size_t i = 0; i < N; i++)
    for (size_t j = 0; j < N; j++) {
      long double d[3], s2 = (long double)softening * softening;
      for (size_t k = 0; k < 3; k++) d[k] = (long double)c->x[3 * j + k] - c->x[3 * i + k], s2 += d[k] * d[k];
      for (size_t k = 0; k < 3 && i != j; k++) c->exact[3 * i + k] += c->mass[j] * d[k] / (s2 * sqrtl(s2));
    }
}

/* Forces over masses in `found`; returns whether the tree has sums in single precision. */
static bool sum_by_tree(cluster *c, int lanes, double softening, double alpha) {
  const hk_host host = {.lanes = lanes, .allocate = take, .release = give, .parallel_for = in_turn};
  const hk_tree_accuracy accuracy = {alpha, NAN};
  hk_octree_builder builder = {0};
  hk_octree octree;
  hk_gravity_bodies g = {0};
  hk_gravity_tree tree = {0};
  uint32_t flawed;
  assert_int_equal(hk_octree_reserve(&builder, &host, N), HK_OK);
  assert_int_equal(hk_gravity_reserve(&g, &host, N), HK_OK);
  assert_int_equal(hk_tree_reserve(&tree, &host, N), HK_OK);
  assert_true(hk_octree_build(&builder, c->x, NULL, N, &octree, &flawed));
  g.count = g.sources = N, g.mutual = true;
  memcpy(g.order, octree.order, N * sizeof *g.order);
  hk_gravity_gather(&g, c->x, c->mass, softening);
  hk_tree_moments(&tree, &g, &octree, &accuracy);
  memset(c->found, 0, sizeof c->found);
  assert_true(hk_tree_forces(&tree, &g, &accuracy, 1, c->found));
  for (size_t k = 0; k < 3 * N; k++) c->found[k] /= c->mass[k / 3];
  bool single = tree.single != NULL;
  hk_tree_release(&tree, &host);
  hk_gravity_release(&g);
  hk_octree_release(&builder);
  return single;
}

static double error_of(const cluster *c, size_t i) {
  long double off = 0, all = 0;
  for (size_t k = 3 * i; k < 3 * i + 3; k++) {
    off += (c->found[k] - c->exact[k]) * (c->found[k] - c->exact[k]);
    all += c->exact[k] * c->exact[k];
  }
  return (double)sqrtl(off / all);
}

static double rms(const cluster *c) {
  double sum = 0;
  for (size_t i = 0; i < N; i++) sum += pow(error_of(c, i), 2);
  return sqrt(sum / N);
}

/* At alpha = 1e-4, and just below, where sums are in double precision: the errors are those of the tree, and the part
 * of single precision is lost in them. Sizes and masses of any range are scaled. */
static void errors_are_those_of_double_precision(void **state) {
  (void)state;
  static const double ranges[][2] = {{1, 1}, {1e17, 1e30}, {1e-12, 1e-27}};
  static cluster c;
  for (size_t r = 0; r < 3; r++) {
    scatter(&c, ranges[r][0], ranges[r][1]);
    sum_exactly(&c, 1e-2 * ranges[r][0]);
    for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
      assert_true(sum_by_tree(&c, lanes, 1e-2 * ranges[r][0], 1e-4) == (lanes > 2));
      double single = rms(&c);
      assert_false(sum_by_tree(&c, lanes, 1e-2 * ranges[r][0], 0.999e-4));
      double twice = rms(&c);
      print_message("%d lanes: %.3e, %.3e in double precision\n", lanes, single, twice);
      assert_true(single > 1e-7 && fabs(single - twice) < 0.05 * twice);
    }
  }
}

/* Pairs at 1e-3 to 1e-14 of the extent from each other, without softening: their forces are their partners', which the
 * tree sums exactly, so that what is left is the rounding of two floats for a place, 2e-6 at 1e-9, and below that
 * of double precision alone; 1e-16/1e-14 of the places themselves is in the exact sum as well. */
static void near_pairs_are_exact(void **state) {
  (void)state;
  static cluster c;
  scatter(&c, 1, 1);
  for (int k = 0; k < 12; k++) {
    memcpy(c.x + 6 * k, c.x + 600 + 3 * k, 3 * sizeof(double));
    memcpy(c.x + 6 * k + 3, c.x + 6 * k, 3 * sizeof(double));
    c.x[6 * k + 3] += 0.6 * pow(10, -3 - k), c.x[6 * k + 4] -= 0.8 * pow(10, -3 - k);
    for (int q = 0; q < 3; q++) c.x[600 + 3 * k + q] += 0.1;
  }
  sum_exactly(&c, 0);
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    sum_by_tree(&c, lanes, 0, 0.005);
    for (size_t i = 2; i < 24; i++) {
      if (error_of(&c, i) >= 4e-6) print_message("%d lanes, body %zu: %.1e\n", lanes, i, error_of(&c, i));
      assert_true(error_of(&c, i) < 4e-6);
    }
  }
}

/* Bodies at one place, in another cube of the tree than one at 1e-12 from them and too many for a group with it, act on
 * it as they are, not as a cell whose place is rounded. */
static void cells_without_extent_are_exact(void **state) {
  (void)state;
  static const double place[] = {0.5, 0.3, 0.2};
  static cluster c;
  scatter(&c, 1, 1);
  for (int q = 0; q < 3; q++) {
    c.x[3 * (N - 2) + q] = -1, c.x[3 * (N - 1) + q] = 1; /* 0.5 is the border of two cubes */
    for (int k = 0; k < 301; k++) c.x[3 * k + q] = place[q];
  }
  c.x[0] -= 0.6e-12, c.x[1] += 0.8e-12;
  sum_exactly(&c, 1e-13);
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    sum_by_tree(&c, lanes, 1e-13, 0.005);
    assert_true(error_of(&c, 0) < 1e-6);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(errors_are_those_of_double_precision),
      cmocka_unit_test(near_pairs_are_exact),
      cmocka_unit_test(cells_without_extent_are_exact),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
