/* Continuous collision detection against exact rational arithmetic: no collision is missed, no contact is earlier than
 * the time that is given, and there the features are as near as asked. Random motions, and ones that are made to be
 * hard: touching at a dyadic time or at the ends, at corners and on edges, nearly, in a plane, along a line, at rest,
 * degenerate, tiny, huge, far from the origin. With an argument: a million random motions and 100,000 hard ones. */
#include "plugins/common/contact/geometry/ccd.h"
#include "tests/plugins/common/contact/geometry/exact_motion.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static bool all;
static uint64_t seed = 1;

static uint64_t bits(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return seed >> 11;
}
static double noise(void) { return (double)bits() * 0x1.0p-52 - 1; } /* in [-1, 1) */
static int below(int n) { return (int)(bits() % (uint64_t)n); }
/* A multiple of 1/16 in [-4, 4]: sums and products of some of them are exact. */
static double grid(void) { return (below(129) - 64) / 16.0; }

typedef struct pair {
  hk_pair_kind kind;
  double x0[12], x1[12];
} pair;

/* ---- Hard motions ------------------------------------------------------------------------------------------------ */

static void scatter(double *x, double (*number)(void)) {
  for (int k = 0; k < 12; k++) x[k] = number();
}

/* Puts the features into contact, points of the grid exactly: weights are eighths, and at times the contact is at an
 * edge or a corner. */
static void touch(hk_pair_kind kind, double *x) {
  double a = below(9) / 8.0, b = below(9 - (int)(8 * a)) / 8.0, s = below(9) / 8.0;
  for (int c = 0; c < 3; c++)
    if (kind == HK_POINT_TRIANGLE)
      x[c] = (1 - a - b) * x[3 + c] + a * x[6 + c] + b * x[9 + c];
    else { /* x0 and x2 are shifted so that the points at s and at a coincide */
      double off = x[c] + s * (x[3 + c] - x[c]) - (x[6 + c] + a * (x[9 + c] - x[6 + c]));
      x[6 + c] += off, x[9 + c] += off;
    }
}

/* All in the plane z = x + y, and moving in it; or along a line in it. */
static void flatten(double *x, bool line) {
  for (int i = 0; i < 4; i++) {
    if (line) x[3 * i + 1] = -2 * x[3 * i];
    x[3 * i + 2] = x[3 * i] + x[3 * i + 1];
  }
}

static void make_degenerate(double *x, int which) {
  static const int to[6] = {2, 3, 1, 3, 3, 2}, from[6] = {1, 2, 0, 2, 1, 0};
  memcpy(x + 3 * to[which], x + 3 * from[which], 3 * sizeof *x);
  if (which == 4) memcpy(x + 6, x + 3, 3 * sizeof *x);
}

/* Motion with velocity v that is at x at time t. */
static void pass_through(pair *p, const double *x, const double *v, double t) {
  for (int k = 0; k < 12; k++) p->x0[k] = x[k] - t * v[k], p->x1[k] = x[k] + (1 - t) * v[k];
}

static void edges_along_each_other(double *x, double *v) {
  for (int c = 0; c < 3; c++) {
    x[9 + c] = x[6 + c] + 0.5 * (x[3 + c] - x[c]);
    v[3 + c] = v[c], v[9 + c] = v[6 + c];
  }
}

static void resize(pair *p) {
  static const double sizes[] = {0x1p-40, 0x1p40, 1e-12, 1e12, 1e-6, 1e-150, 1e150, 1e-310, 3};
  if (below(2)) return;
  double s = sizes[below(9)];
  for (int k = 0; k < 12; k++) p->x0[k] *= s, p->x1[k] *= s;
}

static void shift(pair *p) {
  if (below(4)) return;
  double far[3] = {1e3 * grid(), 1e6 * noise(), 1e-3 * grid()};
  for (int k = 0; k < 12; k++) p->x0[k] += far[k % 3], p->x1[k] += far[k % 3];
}

/* Off by some units in the last place, or by a little, or not at all. */
static void disturb(double *x) {
  static const double by[] = {0, 0, DBL_EPSILON, 1e-13, 1e-10, 1e-6};
  double e = by[below(6)];
  for (int k = 0; k < 12 && e > 0; k++) x[k] += e * noise();
}

enum { FAMILIES = 9 };
static const char *const family_name[FAMILIES] = {"passing through", "touching at an end", "in a plane",
                                                  "along a line",    "parallel edges",     "at rest",
                                                  "degenerate",      "coming to a stop",   "in common motion"};
static pair hard(int family) {
  static const double times[] = {0, 0.5, 0.25, 0.875, 1, 0x1p-10, 1 - 0x1p-10};
  pair p = {.kind = below(2) ? HK_EDGE_EDGE : HK_POINT_TRIANGLE};
  double x[12], v[12], t = times[below(7)];
  bool rounded = family == 1 && below(2); /* then it touches but for rounding: half of the time a little too late */
  scatter(x, rounded ? noise : grid);
  scatter(v, rounded ? noise : grid);
  if (family == 2 || family == 3) flatten(x, family == 3), flatten(v, family == 3);
  if (family == 4) p.kind = HK_EDGE_EDGE, edges_along_each_other(x, v);
  if (family == 6) {
    int which = below(6);
    make_degenerate(x, which), make_degenerate(v, which);
  }
  if (below(4)) touch(p.kind, x);
  if (!rounded) disturb(x);
  if (family == 1) t = below(2);
  if (rounded && below(4)) /* one feature comes as it is: one direction proves all of the way but the end */
    for (int k = 0; k < 12; k++) v[k] = k < (p.kind == HK_POINT_TRIANGLE ? 3 : 6) ? v[k % 3] : 0;
  if (family == 5) memset(v, 0, sizeof v);
  if (family == 7)
    for (int k = 0; k < 12; k++) v[k] *= k < 3 ? 1 : 0;
  if (family == 8)
    for (int k = 0; k < 12; k++) v[k] = v[k % 3] + (below(3) ? 0 : 0x1p-30 * v[k]);
  pass_through(&p, x, v, t);
  resize(&p);
  shift(&p);
  return p;
}

/* ---- The comparison ---------------------------------------------------------------------------------------------- */

typedef struct tally {
  long asked, hits, false_hits, gave_up, missed, late, far;
  unsigned long steps;
  unsigned most_steps;
} tally;

static double largest_difference(const pair *p) {
  double most = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      for (int c = 0; c < 3; c++)
        most = fmax(most, fmax(fabs(p->x0[3 * i + c] - p->x0[3 * j + c]), fabs(p->x1[3 * i + c] - p->x1[3 * j + c])));
  return most;
}

static void show(const char *what, const pair *p, double t) {
  print_error("%s, kind %d, t = %.17g, x0 and x1:\n", what, p->kind, t);
  for (int k = 0; k < 24; k++) print_error("%.17g%s", k < 12 ? p->x0[k] : p->x1[k - 12], k % 12 == 11 ? "\n" : ", ");
}

/* Beyond the tolerance the distance at the hit may be off by what ccd.h says, and by this test's own rounding. */
static bool is_near(const motion *m, double t, double tolerance, double size) {
  num limit = q(fmax(tolerance * (1 + 1e-9), 3e-14 * size));
  return mpq_cmp(q_squared_at(m, q(t)), q_mul(limit, limit)) <= 0;
}

static void compare(tally *y, const pair *p, double tolerance) {
  double t, size = largest_difference(p);
  hk_ccd_cost cost;
  bool hit = hk_ccd_counted(p->kind, p->x0, p->x1, 0, tolerance * size, &t, &cost);
  q_reset(0);
  motion m = q_motion(p->kind, p->x0, p->x1);
  num first;
  bool touches = q_first_contact(&m, &first);
  y->asked++, y->hits += hit, y->false_hits += hit && !touches, y->gave_up += cost.gave_up, y->steps += cost.steps;
  if (cost.steps > y->most_steps) y->most_steps = cost.steps;
  if (touches && !hit) y->missed++, show("missed", p, mpq_get_d(first));
  if (touches && hit && mpq_cmp(q(t), first) > 0) y->late++, show("late", p, t);
  if (hit && !cost.gave_up && !is_near(&m, t, tolerance * size, size)) y->far++, show("far", p, t);
}

static void report(const char *what, const tally *y) {
  printf("%-20s %8ld asked, %7ld hits, %6ld of them none, %3ld gave up, %ld missed, %ld late, %ld far; %.1f steps, at "
         "most %u\n",
         what, y->asked, y->hits, y->false_hits, y->gave_up, y->missed, y->late, y->far,
         (double)y->steps / (double)y->asked, y->most_steps);
  fflush(stdout);
  assert_int_equal(y->missed + y->late + y->far, 0);
}

static void no_random_collision_is_missed(void **state) {
  (void)state;
  tally y = {0};
  for (int k = 0; k < (all ? 1000000 : 3000); k++) {
    pair p = {.kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE};
    scatter(p.x0, noise);
    scatter(p.x1, noise);
    compare(&y, &p, 1e-6);
  }
  report("random", &y);
}

static void no_hard_collision_is_missed(void **state) {
  (void)state;
  static const double tolerance[] = {1e-3, 1e-6, 1e-9, 0};
  for (int family = 0; family < FAMILIES; family++) {
    tally y = {0};
    for (int k = 0; k < (all ? 12000 : 300); k++) {
      pair p = hard(family);
      compare(&y, &p, tolerance[k % 4]);
    }
    report(family_name[family], &y);
    assert_true(20 * y.gave_up <= y.asked); /* only where rounding leaves little to prove */
  }
}

/* Without the time of which little more is left to prove than the bisection can. */
static void a_gap_is_kept_until_the_hit(void **state) {
  (void)state;
  int hits = 0, free = 0;
  for (int k = 0; k < (all ? 20000 : 300); k++) {
    pair p = {.kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE};
    double t, gap = 0.2 * (1 + noise());
    scatter(p.x0, noise);
    scatter(p.x1, noise);
    bool hit = hk_ccd(p.kind, p.x0, p.x1, gap, 1e-2, &t);
    hits += hit && t > 0, free += !hit;
    q_reset(0);
    motion m = q_motion(p.kind, p.x0, p.x1);
    if (hit) assert_true(is_near(&m, t, gap + 1e-2, 2));
    if (hit && t == 0) continue;
    if (!q_stays_apart(&m, q(0), q(t), q(gap * (1 - 1e-3)), 16)) show("not kept", &p, t), fail();
  }
  printf("gap: %d hits, %d without\n", hits, free);
  assert_true(hits > 50 && free > 50);
}

/* A cubic with a known root, to the width of its bracket. */
static void the_reference_knows_the_times_of_constructed_contacts(void **state) {
  (void)state;
  for (int k = 0; k < 200; k++) {
    pair p = {.kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE};
    double x[12], v[12], time = (1 + below(15)) / 16.0;
    scatter(x, grid);
    scatter(v, grid);
    touch(p.kind, x);
    pass_through(&p, x, v, time);
    q_reset(0);
    motion m = q_motion(p.kind, p.x0, p.x1);
    num first, w = q(0x1p-80);
    assert_true(q_first_contact(&m, &first));
    assert_true(mpq_cmp(first, q_add(q(time), w)) <= 0); /* there may be an earlier one */
    if (mpq_cmp(first, q_sub(q(time), w)) < 0) continue;
    tally y = {0};
    compare(&y, &p, 1e-9);
    assert_int_equal(y.hits, 1);
    assert_int_equal(y.missed + y.late + y.far, 0);
  }
}

int main(int argc, char **argv) {
  (void)argv;
  all = argc > 1;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_random_collision_is_missed),
      cmocka_unit_test(no_hard_collision_is_missed),
      cmocka_unit_test(a_gap_is_kept_until_the_hit),
      cmocka_unit_test(the_reference_knows_the_times_of_constructed_contacts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
