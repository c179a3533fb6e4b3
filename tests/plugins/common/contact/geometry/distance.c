/* Distances of pairs against exact rationals, and their derivatives by differences: at random, in every set of active
 * points, and where edges and triangles are degenerate. */
#include "tests/plugins/common/contact/geometry/rational.h"
#include "plugins/kit/vector3.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static uint64_t seed = 1;

/* In [-1, 1). */
static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

static void scatter(double *x) {
  for (int k = 0; k < 12; k++) x[k] = noise();
}

/* ---- Degenerate pairs -------------------------------------------------------------------------------------------- */

static void as_point(double *x, int i, int j) { memcpy(x + 3 * i, x + 3 * j, 3 * sizeof *x); }

/* x_i on the line from x_j to x_k, off it by `by`. */
static void onto_line(double *x, int i, int j, int k, double s, double by) {
  for (int c = 0; c < 3; c++) x[3 * i + c] = x[3 * j + c] + s * (x[3 * k + c] - x[3 * j + c]) + by * noise();
}

/* The second edge along the first. */
static void parallel(double *x, double s, double by) {
  for (int c = 0; c < 3; c++) x[9 + c] = x[6 + c] + s * (x[3 + c] - x[c]) + by * noise();
}

enum { CASES = 14 };
static void degenerate(double *x, int which, double by) {
  switch (which) {
  case 0:
    as_point(x, 2, 1);
    break;
  case 1:
    as_point(x, 3, 2);
    break;
  case 2:
    as_point(x, 2, 1), as_point(x, 3, 1);
    break;
  case 3:
    as_point(x, 1, 0), as_point(x, 3, 2);
    break;
  case 4:
    as_point(x, 0, 2);
    break;
  case 5:
    onto_line(x, 3, 1, 2, 0.3, by);
    break;
  case 6:
    onto_line(x, 3, 1, 2, 1.7, by);
    break;
  case 7:
    onto_line(x, 0, 1, 2, 0.4, by);
    break;
  case 8:
    parallel(x, 0.5, by);
    break;
  case 9:
    parallel(x, -2, by);
    break;
  case 10:
    onto_line(x, 2, 0, 1, 0.3, by), parallel(x, 1, by);
    break;
  case 11:
    onto_line(x, 2, 0, 1, 1.5, by), parallel(x, 1, by);
    break;
  case 12:
    for (int k = 0; k < 4; k++) x[3 * k + 2] = by * noise();
    break;
  default:
    for (int k = 1; k < 4; k++) as_point(x, k, 0);
  }
}

/* ---- Nearest points ---------------------------------------------------------------------------------------------- */

static double exact(hk_pair_kind kind, const double *x, double size) {
  q_reset(0);
  vec at[4];
  for (int i = 0; i < 4; i++) at[i] = v_of(x + 3 * i);
  num d2 = q_squared_distance(kind, at);
  /* The square root of a number that doubles may not hold. */
  return size * sqrt(mpq_get_d(q_div(d2, q_mul(q(size), q(size)))));
}

static void check_weights(const hk_nearest *n, const double *x, double size) {
  double first = 0, second = 0, d[3] = {0};
  for (int i = 0; i < 4; i++) {
    bool mine = i < (n->kind == HK_POINT_TRIANGLE ? 1 : 2);
    *(mine ? &first : &second) += n->w[i];
    assert_true(mine ? n->w[i] >= 0 && n->w[i] <= 1 : n->w[i] <= 0 && n->w[i] >= -1);
    assert_true(n->active >> i & 1 || n->w[i] == 0);
    for (int c = 0; c < 3; c++) d[c] += n->w[i] * x[3 * i + c];
  }
  assert_true(fabs(first - 1) < 1e-15 && fabs(second + 1) < 1e-15);
  for (int c = 0; c < 3; c++) assert_true(fabs(d[c] - n->d[c]) <= 1e-15 * size);
}

/* Rounding of the difference of two points: some units of 1e-16 of the coordinates. */
static void check_distance(hk_pair_kind kind, const double *x, double size) {
  hk_nearest n = hk_nearest_of_pair(kind, x);
  double d = sqrt(n.squared), truth = exact(kind, x, size);
  if (!(fabs(d - truth) <= 1e-15 * size)) {
    print_error("kind %d: distance %.17g, expected %.17g, of coordinates up to %g\n", kind, d, truth, size);
    for (int k = 0; k < 12; k++) print_error("%.17g%s", x[k], k % 3 == 2 ? "\n" : ", ");
    fail();
  }
  check_weights(&n, x, size);
}

static void distances_are_those_of_exact_arithmetic(void **s) {
  (void)s;
  static const double sizes[] = {1, 1e-12, 1e12, 1e-70, 1e70};
  static const double off[] = {0, 1e-16, 1e-13, 1e-10, 1e-7, 1e-4};
  for (int k = 0; k < 40000; k++) {
    double x[12], size = sizes[k % 5];
    scatter(x);
    int which = k / 5 % (2 * CASES);
    if (which < CASES) degenerate(x, which, off[k / 7 % 6]);
    for (int i = 0; i < 12; i++) x[i] *= size;
    check_distance(k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE, x, 2 * size);
  }
}

/* The sine of the angle between the edges, or between two sides of the triangle. */
static double sine(hk_pair_kind kind, const double *x) {
  const double *a = kind == HK_EDGE_EDGE ? x : x + 6, *b = x + 3, *c = kind == HK_EDGE_EDGE ? x + 6 : x + 3;
  double u[3], v[3], n[3];
  hk_subtract(u, b, a);
  hk_subtract(v, x + 9, c);
  hk_cross(n, u, v);
  return hk_length(n) / (hk_length(u) * hk_length(v));
}

/* ---- Derivatives ------------------------------------------------------------------------------------------------- */

static double squared(hk_pair_kind kind, const double *x) { return hk_nearest_of_pair(kind, x).squared; }

/* How far the gradient, and the Hessian, are from central differences of what they derive; -1: the active points change
 * within the differences. */
static void differences(hk_pair_kind kind, const double *x, double h, double off[2]) {
  double g[12], H[144], y[12], gy[2][12];
  hk_nearest n = hk_nearest_of_pair(kind, x);
  hk_distance_gradient(&n, g);
  hk_distance_energy_hessian(&n, x, 1, 0, false, H);
  off[0] = off[1] = 0;
  for (int j = 0; j < 12; j++) {
    double f[2];
    for (int side = 0; side < 2; side++) {
      memcpy(y, x, sizeof y);
      y[j] += side ? h : -h;
      hk_nearest m = hk_nearest_of_pair(kind, y);
      if (m.active != n.active) {
        off[0] = off[1] = -1;
        return;
      }
      f[side] = squared(kind, y);
      hk_distance_gradient(&m, gy[side]);
    }
    off[0] = fmax(off[0], fabs((f[1] - f[0]) / (2 * h) - g[j]));
    for (int i = 0; i < 12; i++) off[1] = fmax(off[1], fabs((gy[1][i] - gy[0][i]) / (2 * h) - H[12 * i + j]));
  }
}

/* Coordinates of size 1: central differences with h = 1e-5 are off by h^2 times the third derivative, which grows as
 * the inverse square of the sine of the angle between the lines, and by rounding, 1e-16/h. */
static void derivatives_are_differences_in_every_set_of_active_points(void **s) {
  (void)s;
  int seen[2][16] = {{0}};
  for (int k = 0; k < 20000; k++) {
    hk_pair_kind kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE;
    double x[12], off[2];
    scatter(x);
    if (sine(kind, x) < 0.3) continue;
    differences(kind, x, 1e-5, off);
    if (off[0] < 0) continue;
    seen[kind][hk_nearest_of_pair(kind, x).active]++;
    assert_true(off[0] < 1e-7 && off[1] < 1e-6);
  }
  for (unsigned a = 0; a < 16; a++) {
    bool of_triangle = (a & 1) && (a & 14), of_edges = (a & 3) && (a & 12);
    assert_int_equal(seen[0][a] > 0, of_triangle);
    assert_int_equal(seen[1][a] > 0, of_edges);
  }
}

/* Pairs off by `off` from a degenerate one change over that length: differences with h are off by (h/off)^2 of the
 * largest entry, and by rounding, 1e-16/(h off). */
static void derivatives_are_differences_near_degenerate_pairs(void **s) {
  (void)s;
  int checked[2][CASES] = {{0}};
  for (int k = 0; k < 20000; k++) {
    hk_pair_kind kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE;
    double x[12], g[12], H[144], largest = 1, off[2], by = k % 4 < 2 ? 1e-1 : 1e-2;
    scatter(x);
    degenerate(x, k / 4 % CASES, 0);
    for (int i = 0; i < 12; i++) x[i] += by * noise();
    hk_nearest n = hk_nearest_of_pair(kind, x);
    hk_distance_gradient(&n, g);
    hk_distance_energy_hessian(&n, x, 1, 0, false, H);
    for (int i = 0; i < 144; i++) largest = fmax(largest, fabs(H[i]));
    differences(kind, x, 1e-6, off);
    if (off[0] < 0 || sine(kind, x) < by / 10) continue;
    checked[kind][k / 4 % CASES]++;
    assert_true(off[0] < 1e-7 + 1e-10 * largest && off[1] < 1e-6 * largest);
  }
  for (int k = 0; k < 2 * CASES; k++) assert_true(checked[k / CASES][k % CASES] > 200);
}

/* Nothing is infinite, the gradient and the Hessian do not see a translation, and the Hessian is symmetric. With both
 * lines in it the Hessian is known as well as their normal, to rounding over the sine. */
static void degenerate_pairs_have_finite_derivatives(void **s) {
  (void)s;
  for (int k = 0; k < 4000; k++) {
    hk_pair_kind kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE;
    double x[12], g[12], H[144], largest = 0, off = k % 3 ? 0 : 1e-12;
    scatter(x);
    degenerate(x, k / 2 % CASES, off);
    hk_nearest n = hk_nearest_of_pair(kind, x);
    hk_distance_gradient(&n, g);
    hk_distance_energy_hessian(&n, x, 1, 0, false, H);
    double tolerance = n.active == 15 ? 1e-14 / sine(kind, x) : 1e-13;
    for (int i = 0; i < 144; i++) largest = fmax(largest, fabs(H[i]));
    for (int c = 0; c < 3; c++) assert_true(fabs(g[c] + g[3 + c] + g[6 + c] + g[9 + c]) < 1e-14);
    for (int i = 0; i < 144; i++) {
      assert_true(isfinite(H[i]) && fabs(H[i] - H[12 * (i % 12) + i / 12]) <= 1e-13 * largest);
      if (i % 12 < 3) assert_true(fabs(H[i] + H[i + 3] + H[i + 6] + H[i + 9]) <= tolerance * largest);
    }
  }
}

static void distances_near_zero_are_those_of_exact_arithmetic(void **s) {
  (void)s;
  for (int k = 0; k < 6000; k++) {
    double x[12], by = pow(10, -16 * fabs(noise()));
    scatter(x);
    for (int c = 0; c < 3; c++)
      if (k % 2) /* edges that cross in their middles */
        x[9 + c] = x[c] + x[3 + c] - x[6 + c] + by * noise();
      else
        x[c] = 0.2 * x[3 + c] + 0.3 * x[6 + c] + 0.5 * x[9 + c] + by * noise();
    check_distance(k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE, x, 3);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distances_are_those_of_exact_arithmetic),
      cmocka_unit_test(distances_near_zero_are_those_of_exact_arithmetic),
      cmocka_unit_test(derivatives_are_differences_in_every_set_of_active_points),
      cmocka_unit_test(derivatives_are_differences_near_degenerate_pairs),
      cmocka_unit_test(degenerate_pairs_have_finite_derivatives),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
