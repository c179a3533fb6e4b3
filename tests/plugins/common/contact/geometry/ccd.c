/* Continuous collision with known answers: times of contact, gaps, degenerate and extreme input. Against exact
 * arithmetic: ccd_exact.c. */
#include "plugins/common/contact/geometry/ccd.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define PT HK_POINT_TRIANGLE
#define EE HK_EDGE_EDGE

typedef struct known {
  const char *what;
  hk_pair_kind kind;
  double x0[12], x1[12], gap;
  double t; /* of the first contact; -1: none */
} known;

#define TRIANGLE 0, 0, 0, 1, 0, 0, 0, 1, 0
#define ALONG_X -1, 0, 0, 1, 0, 0

static const known cases[] = {
    {"falls on the face", PT, {0.2, 0.2, 1, TRIANGLE}, {0.2, 0.2, -1, TRIANGLE}, 0, 0.5},
    {"falls on a corner", PT, {0, 0, 1, TRIANGLE}, {0, 0, -1, TRIANGLE}, 0, 0.5},
    {"falls on a side", PT, {0.5, 0.5, 1, TRIANGLE}, {0.5, 0.5, -3, TRIANGLE}, 0, 0.25},
    {"falls beside it", PT, {0.5, 0.75, 1, TRIANGLE}, {0.5, 0.75, -1, TRIANGLE}, 0, -1},
    {"a sphere falls beside it", PT, {0.5, -0.2, 1, TRIANGLE}, {0.5, -0.2, -1, TRIANGLE}, 0.25, 0.425},
    {"a sphere passes it by", PT, {0.5, -0.2, 1, TRIANGLE}, {0.5, -0.2, -1, TRIANGLE}, 0.1999, -1},
    {"a sphere falls on the face", PT, {0.2, 0.2, 1, TRIANGLE}, {0.2, 0.2, -1, TRIANGLE}, 0.25, 0.375},
    {"stops above", PT, {0.2, 0.2, 1, TRIANGLE}, {0.2, 0.2, 0.5, TRIANGLE}, 0.4999, -1},
    {"ends on the face", PT, {0.2, 0.2, 1, TRIANGLE}, {0.2, 0.2, 0, TRIANGLE}, 0, 1},
    {"begins on the face", PT, {0.2, 0.2, 0, TRIANGLE}, {0.2, 0.2, 1, TRIANGLE}, 0, 0},
    {"rests above", PT, {0.2, 0.2, 1, TRIANGLE}, {0.2, 0.2, 1, TRIANGLE}, 0.5, -1},
    {"rests on it", PT, {0.2, 0.2, 0, TRIANGLE}, {0.2, 0.2, 0, TRIANGLE}, 0, 0},
    {"slides in the plane to a side", PT, {2, 2, 0, TRIANGLE}, {0, 0, 0, TRIANGLE}, 0, 0.75},
    {"goes through the plane beside it", PT, {2, 2, 1, TRIANGLE}, {2, 2, -1, TRIANGLE}, 0.1, -1},
    {"all in common, fast", PT, {0, 0, 1, TRIANGLE}, {9, 9, 10, 9, 9, 9, 10, 9, 9, 9, 10, 9}, 0.5, -1},
    {"edges cross", EE, {ALONG_X, 0, -1, 1, 0, 1, 1}, {ALONG_X, 0, -1, -1, 0, 1, -1}, 0, 0.5},
    {"edges cross with radii", EE, {ALONG_X, 0, -1, 1, 0, 1, 1}, {ALONG_X, 0, -1, -1, 0, 1, -1}, 0.25, 0.375},
    {"edges side by side", EE, {ALONG_X, 0, 0, 1, 3, 0, 1}, {ALONG_X, 0, 0, -1, 3, 0, -1}, 0, 0.5},
    {"edges end to end", EE, {ALONG_X, 3, 0, 0, 5, 0, 0}, {ALONG_X, -1, 0, 0, 1, 0, 0}, 0, 0.5},
    {"edges pass each other end to end", EE, {ALONG_X, 3, 1, 0, 5, 1, 0}, {ALONG_X, -5, 1, 0, -3, 1, 0}, 0.9999, -1},
    {"an edge turns into another", /* its end comes down from (1, 0, 1) to (1, 0, -1) */
     EE,
     {0, 0, 0.5, 1, 0, 1.5, 0.5, -1, 0, 0.5, 1, 0},
     {0, 0, 0.5, 1, 0, -2.5, 0.5, -1, 0, 0.5, 1, 0},
     0,
     0.5},
    {"a seesaw over an edge",
     EE,
     {-1, 0, 0.6, 1, 0, -0.4, 0, -1, 0, 0, 1, 0},
     {-1, 0, -0.4, 1, 0, 0.6, 0, -1, 0, 0, 1, 0},
     0.08,
     -1},
    {"points", EE, {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0}, {4, 0, 0, 4, 0, 0, 1, 0, 0, 1, 0, 0}, 0, 0.25},
    {"spheres", PT, {0, 0, 0, 3, 0, 0, 3, 0, 0, 3, 0, 0}, {4, 0, 0, 3, 0, 0, 3, 0, 0, 3, 0, 0}, 1, 0.5},
};

static void check(const known *c, double size, double far) {
  double x0[12], x1[12], t, tolerance = 1e-9;
  for (int k = 0; k < 12; k++) x0[k] = size * (c->x0[k] + far), x1[k] = size * (c->x1[k] + far);
  bool hit = hk_ccd(c->kind, x0, x1, c->gap * size, tolerance * size, &t);
  if (hit != (c->t >= 0)) fail_msg("%s, times %g: %s", c->what, size, hit ? "a hit" : "none");
  /* Speeds are 1 or more a unit of time, or 1/4 in the slowest case; sizes are rounded. */
  if (hit && !(t <= c->t + 1e-12 && t >= c->t - 4 * tolerance))
    fail_msg("%s, times %g: at %.17g, expected %.17g", c->what, size, t, c->t);
}

static void known_times(void **state) {
  (void)state;
  static const double sizes[] = {1, 1e-12, 1e12, 0x1p-300, 0x1p300};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) check(&cases[k], sizes[s], 0);
    check(&cases[k], 1, 1024); /* exact for these coordinates but 0.1s and 0.2s, to 1e-13 */
  }
}

/* The corners of the features may be in any order. */
static void order_of_the_corners_changes_little(void **state) {
  (void)state;
  static const int orders[2][3][4] = {{{0, 2, 3, 1}, {0, 3, 1, 2}, {0, 2, 1, 3}},
                                      {{1, 0, 2, 3}, {0, 1, 3, 2}, {2, 3, 0, 1}}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    for (int o = 0; o < 3; o++) {
      known c = cases[k];
      for (int i = 0; i < 12; i++) {
        c.x0[i] = cases[k].x0[3 * orders[c.kind][o][i / 3] + i % 3];
        c.x1[i] = cases[k].x1[3 * orders[c.kind][o][i / 3] + i % 3];
      }
      check(&c, 1, 0);
    }
}

/* Powers of two change nothing but the exponents. */
static void scaling_changes_no_bit(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int k = 0; k < 500; k++) {
    double x[2][12], y[2][12], t[2];
    for (int i = 0; i < 24; i++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      x[i / 12][i % 12] = (double)(seed >> 11) * 0x1.0p-53;
      y[i / 12][i % 12] = ldexp(x[i / 12][i % 12], k - 250);
    }
    hk_pair_kind kind = k % 2 ? EE : PT;
    bool a = hk_ccd(kind, x[0], x[1], 0.125, 0x1p-20, &t[0]);
    bool b = hk_ccd(kind, y[0], y[1], ldexp(0.125, k - 250), ldexp(1, k - 270), &t[1]);
    assert_true(a == b && t[0] == t[1]);
  }
}

static void what_is_not_finite_is_a_hit_at_the_start(void **state) {
  (void)state;
  static const double wrong[] = {NAN, INFINITY, -INFINITY, 1.7e308};
  for (int k = 0; k < 24; k++)
    for (int w = 0; w < 4; w++) {
      double x[2][12] = {{0.2, 0.2, -1.7e308, TRIANGLE}, {0.2, 0.2, -1.7e308, TRIANGLE}}, t = 7;
      x[0][2] = x[1][2] = w < 3 ? 1 : -1.7e308;
      x[k / 12][k % 12] = wrong[w];
      if (w == 3 && k % 3 != 2) continue; /* the difference has to overflow */
      if (w == 3 && k % 12 == 2) continue;
      assert_true(hk_ccd(PT, x[0], x[1], 0, 1e-6, &t) && t == 0);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(known_times),
      cmocka_unit_test(order_of_the_corners_changes_little),
      cmocka_unit_test(scaling_changes_no_bit),
      cmocka_unit_test(what_is_not_finite_is_a_hit_at_the_start),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
