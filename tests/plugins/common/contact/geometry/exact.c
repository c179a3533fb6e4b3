/* Whether segments and triangles meet, against exact rationals: points of a small grid, where most are degenerate or
 * touch, exactly or but for rounding; and cases with known answers. With an argument: 100,000 of each. */
#include "plugins/common/contact/geometry/exact.h"
#include "tests/plugins/common/contact/geometry/rational.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static bool all;
static uint64_t seed = 1;

static int below(int n) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (int)((seed >> 11) % (uint64_t)n);
}

/* ---- The same in rationals --------------------------------------------------------------------------------------- */

static num volume(vec a, vec b, vec c, vec d) { return v_dot(v_cross(v_sub(b, a), v_sub(c, a)), v_sub(d, a)); }

static bool exact_segments(vec p, vec q_, vec r, vec s) {
  return mpq_sgn(volume(p, q_, r, s)) == 0 && mpq_sgn(q_edge_edge(p, q_, r, s)) == 0;
}

/* A side or an end that touches, in the plane; otherwise the point where the segment passes through it. */
static bool exact_segment_triangle(vec p, vec q_, vec a, vec b, vec c) {
  num hp = volume(a, b, c, p), hq = volume(a, b, c, q_);
  int sides = mpq_sgn(hp) * mpq_sgn(hq);
  if (sides > 0) return false;
  if (sides < 0) {
    vec x = v_add_scaled(p, q_div(hp, q_sub(hp, hq)), v_sub(q_, p));
    return mpq_sgn(q_point_triangle(x, a, b, c)) == 0;
  }
  if (exact_segments(p, q_, a, b) || exact_segments(p, q_, b, c) || exact_segments(p, q_, c, a)) return true;
  return mpq_sgn(q_point_triangle(p, a, b, c)) == 0 || mpq_sgn(q_point_triangle(q_, a, b, c)) == 0;
}

static bool exact_triangles(const vec a[3], const vec b[3]) {
  for (int k = 0; k < 3; k++)
    if (exact_segment_triangle(a[k], a[(k + 1) % 3], b[0], b[1], b[2]) ||
        exact_segment_triangle(b[k], b[(k + 1) % 3], a[0], a[1], a[2]))
      return true;
  return false;
}

/* ---- Random points ----------------------------------------------------------------------------------------------- */

/* Three kinds: on an exact grid; on a grid that is rounded; that moved by some units in the last place. */
static void scatter(double *x, int points, int kind) {
  double step = kind == 0 ? 0.25 : 0.1;
  bool flat = below(3) == 0;
  for (int i = 0; i < 3 * points; i++) {
    x[i] = below(5) * step;
    if (flat && i % 3 == 2) x[i] = 0.3 * x[i - 1] + 0.2 * x[i - 2];
    if (kind == 2) x[i] = nextafter(x[i], below(2) ? INFINITY : -INFINITY);
  }
}

/* What follows for triangles: two have a point in common where a side of one meets the other. */
static bool triangles_meet(const hk_point a[3], const hk_point b[3]) {
  bool meet = false;
  for (int k = 0; k < 3; k++) {
    meet |= hk_segment_meets_triangle(a[k], a[(k + 1) % 3], b[0], b[1], b[2]);
    meet |= hk_segment_meets_triangle(b[k], b[(k + 1) % 3], a[0], a[1], a[2]);
  }
  return meet;
}

/* Whether the triangles v a0 a1 and v b0 b1, which share the corner v, have another point in common. A ray from v
 * through it leaves one triangle first, at its side opposite to v and within the other. */
static bool neighbours_meet(hk_point v, hk_point a0, hk_point a1, hk_point b0, hk_point b1) {
  return hk_segment_meets_triangle(a0, a1, v, b0, b1) || hk_segment_meets_triangle(b0, b1, v, a0, a1);
}

static void answers_are_those_of_exact_arithmetic(void **state) {
  (void)state;
  int met[3] = {0}, count = all ? 100000 : 1500;
  for (int k = 0; k < count; k++) {
    double x[6][3];
    vec v[6];
    scatter(x[0], 6, k % 3);
    q_reset(0);
    for (int i = 0; i < 6; i++) v[i] = v_of(x[i]);
    bool segments = hk_segments_meet(x[0], x[1], x[2], x[3]),
         pierced = hk_segment_meets_triangle(x[0], x[1], x[2], x[3], x[4]),
         triangles = triangles_meet((hk_point[]){x[0], x[1], x[2]}, (hk_point[]){x[3], x[4], x[5]});
    assert_int_equal(segments, exact_segments(v[0], v[1], v[2], v[3]));
    assert_int_equal(pierced, exact_segment_triangle(v[0], v[1], v[2], v[3], v[4]));
    assert_int_equal(triangles, exact_triangles(v, v + 3));
    assert_int_equal(triangles, triangles_meet((hk_point[]){x[5], x[3], x[4]}, (hk_point[]){x[1], x[0], x[2]}));
    met[0] += segments, met[1] += pierced, met[2] += triangles;
  }
  for (int k = 0; k < 3; k++) assert_true(met[k] > count / 50 && met[k] < count * 9 / 10);
}

/* Another common point than v: of the sides opposite to it, or on the way there (see neighbours_meet). */
static void neighbours_are_those_of_exact_arithmetic(void **state) {
  (void)state;
  int met = 0, count = all ? 100000 : 1500;
  for (int k = 0; k < count; k++) {
    double x[5][3];
    vec v[5];
    scatter(x[0], 5, k % 3);
    q_reset(0);
    for (int i = 0; i < 5; i++) v[i] = v_of(x[i]);
    bool meet = neighbours_meet(x[0], x[1], x[2], x[3], x[4]);
    assert_int_equal(meet, exact_segment_triangle(v[1], v[2], v[0], v[3], v[4]) ||
                               exact_segment_triangle(v[3], v[4], v[0], v[1], v[2]));
    assert_int_equal(meet, neighbours_meet(x[0], x[4], x[3], x[1], x[2]));
    met += meet;
  }
  assert_true(met > count / 20 && met < count * 9 / 10);
}

/* ---- Known answers ----------------------------------------------------------------------------------------------- */

typedef struct known {
  const char *what;
  double a[3][3], b[3][3];
  bool meet;
} known;

static const known cases[] = {
    {"pierced", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {2, 2, 5}}, true},
    {"corner on the face", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {1, 2, 1}, {2, 2, 5}}, true},
    {"corner just above the face", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0x1p-1074}, {1, 2, 1}, {2, 2, 5}}, false},
    {"corner on corner", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{4, 0, 0}, {5, 2, 1}, {7, 2, 5}}, true},
    {"in one plane, within", {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, true},
    {"in one plane, apart", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{3, 3, 0}, {4, 3, 0}, {3, 4, 0}}, false},
    {"in one plane, side on side", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 0, 0}, {3, 0, 0}, {2, -1, 0}}, true},
    {"parallel planes", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}, false},
    {"sides that cross", {{0, 0, 0}, {4, 0, 0}, {0, 0, -4}}, {{2, -1, 0}, {2, 1, 0}, {2, 0, 4}}, true},
    {"planes that cross beside them", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{5, 5, -1}, {5, 5, 1}, {6, 6, 0}}, false},
    {"a point on a face", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}, true},
    {"a segment through a face", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {1, 1, 0}}, true},
    {"segments that cross", {{0, 0, 0}, {2, 2, 2}, {4, 4, 4}}, {{4, 0, 2}, {0, 4, 2}, {2, 2, 2}}, true},
    {"segments of one line, apart", {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{3, 3, 3}, {4, 4, 4}, {5, 5, 5}}, false},
    {"tiny and huge",
     {{0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}},
     {{1e-300, 1e-300, -1e-300}, {1e-300, 1e-300, 1e-300}, {1, 1, 1}},
     true},
};

static void known_cases(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const known *c = &cases[k];
    hk_point a[3] = {c->a[0], c->a[1], c->a[2]}, b[3] = {c->b[0], c->b[1], c->b[2]};
    if (triangles_meet(a, b) != c->meet || triangles_meet(b, a) != c->meet) fail_msg("%s", c->what);
  }
}

static void known_neighbours(void **state) {
  (void)state;
  const double v[3] = {0, 0, 0}, a0[3] = {4, 0, 0}, a1[3] = {0, 4, 0}, up0[3] = {1, 0, 3}, up1[3] = {0, 1, 3},
               back0[3] = {-1, 0, 0}, back1[3] = {0, -1, 0}, down[3] = {1, 1, -1}, in0[3] = {2, 1, 0},
               in1[3] = {1, 2, 0}, along[3] = {2, 0, 0};
  assert_false(neighbours_meet(v, a0, a1, up0, up1));
  assert_false(neighbours_meet(v, a0, a1, back0, back1));
  assert_true(neighbours_meet(v, a0, a1, (double[]){1, 1, 1}, down)); /* through the face */
  assert_true(neighbours_meet(v, a0, a1, in0, in1));                  /* within it */
  assert_true(neighbours_meet(v, a0, a1, along, up0));                /* one side on another */
  assert_true(neighbours_meet(v, a0, a1, v, up0));                    /* v twice */
}

int main(int argc, char **argv) {
  (void)argv;
  all = argc > 1;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(answers_are_those_of_exact_arithmetic),
      cmocka_unit_test(neighbours_are_those_of_exact_arithmetic),
      cmocka_unit_test(known_cases),
      cmocka_unit_test(known_neighbours),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
