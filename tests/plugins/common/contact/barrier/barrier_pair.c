/* The barrier of one pair: its value against the formula, gradient and Hessian against differences at random and
 * degenerate places, the projection's eigenvalues, and the area for which a pair stands. */
#include "plugins/common/contact/barrier/barrier_function.h"
#include "plugins/common/contact/barrier/barrier_pair.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const hk_barrier_law law = {.stiffness = 2e3, .distance = 0.1};

static double draw(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 9007199254740992.0 - 0.5;
}

static hk_barrier_pair pair_of(hk_pair_kind kind, double xi) {
  return (hk_barrier_pair){.pair = {.vertex = {0, 1, 2, 3}, .kind = kind, .offset = xi}, .area = 0.3};
}

/* A point at the height z above the middle of a triangle: E = kappa A D b(u), and the load is -dE/dz. */
static void a_point_over_a_face_by_hand(void **state) {
  (void)state;
  for (double xi = 0; xi < 0.1; xi += 0.04)
    for (double gap = 1e-6; gap < 0.12; gap *= 1.7) {
      hk_barrier_pair p = pair_of(HK_POINT_TRIANGLE, xi);
      hk_barrier_value v;
      double z = xi + gap, D = law.distance, x[] = {0, 0, z, -1, -1, 0, 1, -1, 0, 0, 2, 0};
      double S = D * D + 2 * D * xi, u = (z * z - xi * xi) / S, E = law.stiffness * p.area * D;
      bool acts = hk_barrier_evaluate(&p, &law, x, &v);
      assert_true(acts == (gap < D));
      assert_true(fabs(v.gap - gap) < 1e-16);
      if (!acts) continue;
      /* rounding of z against xi, amplified by 1/u in the slope */
      assert_true(fabs(v.E + E * (u - 1) * (u - 1) * log(u)) < 1e-9 * (E + v.E));
      double load = E * (2 * (u - 1) * log(u) + (u - 1) * (u - 1) / u) * 2 * z / S;
      assert_true(fabs(hk_barrier_load(&v) - load) < 1e-8 * load);
    }
}

static void it_ends_smoothly_and_has_no_end_below(void **state) {
  (void)state;
  hk_barrier_function b = hk_barrier_at(1 - 1e-8);
  assert_true(b.value < 1e-23 && fabs(b.slope) < 1e-15 && b.curvature < 1e-7);
  hk_barrier_pair p = pair_of(HK_EDGE_EDGE, 0.05);
  hk_barrier_value v;
  double touching[] = {-1, 0, 0, 1, 0, 0, 0, -1, 0.05, 0, 1, 0.05};
  assert_true(hk_barrier_evaluate(&p, &law, touching, &v) && v.E == INFINITY);
}

/* ---- derivatives ---- */

static double energy_at(const hk_barrier_pair *p, const double *x) {
  hk_barrier_value v;
  return hk_barrier_evaluate(p, &law, x, &v) ? v.m * v.E : 0;
}

static void hessian_at(const hk_barrier_pair *p, const hk_barrier_value *v, const double *x, bool definite,
                       double H[144]) {
  const size_t slot[] = {0, 1, 2, 3};
  hk_barrier_hessian h;
  double row[36];
  hk_barrier_hessian_of(p, v, x, definite, &h);
  for (int i = 0; i < 4; i++) {
    memset(row, 0, sizeof row);
    hk_barrier_hessian_row(&h, i, slot, row);
    for (int e = 0; e < 36; e++) H[12 * (3 * i + e % 9 / 3) + 3 * (e / 9) + e % 3] = row[e];
  }
}

/* The largest differences of the gradient from differences of the energy, and of the Hessian from those of the
 * gradient, of their largest entries. */
static void differ(const hk_barrier_pair *p, const double at[12], double *first, double *second) {
  double x[12], g[12], H[144], up[12], down[12], size = 0, bend = 0, step = 1e-7;
  hk_barrier_value v;
  *first = *second = 0;
  assert_true(hk_barrier_evaluate(p, &law, at, &v));
  hk_barrier_gradient(p, &v, at, g);
  hessian_at(p, &v, at, false, H);
  for (int e = 0; e < 12; e++) size = fmax(size, fabs(g[e]));
  for (int e = 0; e < 144; e++) bend = fmax(bend, fabs(H[e]));
  memcpy(x, at, sizeof x);
  for (int e = 0; e < 12; e++) {
    x[e] = at[e] + step;
    double above = energy_at(p, x);
    assert_true(hk_barrier_evaluate(p, &law, x, &v));
    hk_barrier_gradient(p, &v, x, up);
    x[e] = at[e] - step;
    double below = energy_at(p, x);
    assert_true(hk_barrier_evaluate(p, &law, x, &v));
    hk_barrier_gradient(p, &v, x, down);
    x[e] = at[e];
    *first = fmax(*first, fabs((above - below) / (2 * step) - g[e]) / size);
    for (int r = 0; r < 12; r++) *second = fmax(*second, fabs((up[r] - down[r]) / (2 * step) - H[12 * r + e]) / bend);
  }
}

/* Places of every class: over a face, an edge, a corner; edges that cross, nearly parallel, with an end; of length 0.
 */
static void place(int which, uint64_t *seed, hk_barrier_pair *p, double x[12]) {
  static const double at[7][12] = {
      {0, 0, 0.06, -1, -1, 0, 1, -1, 0, 0, 2, 0},           /* face */
      {0, -1.04, 0.05, -1, -1, 0, 1, -1, 0, 0, 2, 0},       /* edge of it */
      {0.01, 2.04, 0.05, -1, -1, 0, 1, -1, 0, 0, 2, 0},     /* corner */
      {-1, 0, 0.06, 1, 0, 0.06, 0, -1, 0, 0.1, 1, 0},       /* crossing */
      {-1, 0, 0.06, 1, 0, 0.06, -1, 0.02, 0, 1, -0.025, 0}, /* nearly parallel: the mollifier acts */
      {-1, 0, 0.06, 1, 0, 0.06, 1.02, -1, 0, 1.04, 1, 0},   /* the end of the first */
      {0.3, 0, 0.06, 0.3, 0, 0.06, -1, 0.02, 0, 1, 0, 0},   /* a point and an edge */
  };
  *p = pair_of(which < 3 ? HK_POINT_TRIANGLE : HK_EDGE_EDGE, which % 2 ? 0.03 : 0);
  for (int e = 0; e < 12; e++) x[e] = at[which][e] + 0.004 * draw(seed);
  if (which == 6) memcpy(x + 3, x, 3 * sizeof *x);
  if (p->pair.kind == HK_EDGE_EDGE && which < 6) p->limit = 1e-3 * 16;
}

/* Differences with steps of 1e-7 of derivatives that change over 0.01: 1e-10 by curvature, and rounding of
 * 1e-16/(1e-7 0.05) in energies, amplified by up to 30 where the gap is a part of the thickness. */
static void derivatives_are_those_of_the_energy(void **state) {
  (void)state;
  uint64_t seed = 1;
  double worst[2] = {0};
  for (int k = 0; k < 700; k++) {
    hk_barrier_pair p;
    double x[12], first, second;
    place(k % 7, &seed, &p, x);
    if (k % 7 == 6) continue; /* the two ends of an edge without length move as one */
    differ(&p, x, &first, &second);
    worst[0] = fmax(worst[0], first), worst[1] = fmax(worst[1], second);
  }
  print_message("gradient off by %.1e, Hessian by %.1e\n", worst[0], worst[1]);
  assert_true(worst[0] < 1e-6 && worst[1] < 1e-6);
}

static void the_projection_has_no_negative_directions(void **state) {
  (void)state;
  uint64_t seed = 7;
  for (int k = 0; k < 700; k++) {
    hk_barrier_pair p;
    hk_barrier_value v;
    double x[12], H[144], u[12], size = 0;
    place(k % 7, &seed, &p, x);
    assert_true(hk_barrier_evaluate(&p, &law, x, &v));
    hessian_at(&p, &v, x, true, H);
    for (int e = 0; e < 144; e++) size = fmax(size, fabs(H[e]));
    for (int t = 0; t < 50; t++) {
      double sum = 0;
      for (int e = 0; e < 12; e++) u[e] = draw(&seed);
      for (int e = 0; e < 144; e++) sum += u[e / 12] * H[e] * u[e % 12];
      assert_true(sum > -1e-12 * size);
    }
  }
}

/* An axis of other positions hides no pair that acts; that of the same positions shows a pair that does not, but for
 * rounding of the distance. */
static void an_axis_hides_nothing_that_acts(void **state) {
  (void)state;
  uint64_t seed = 3;
  int apart = 0;
  for (int k = 0; k < 7000; k++) {
    hk_barrier_pair p;
    hk_barrier_value v;
    double x[12];
    place(k % 7, &seed, &p, x);
    for (int e = 0; e < 12; e++) x[e] += 0.1 * draw(&seed);
    hk_barrier_evaluate(&p, &law, x, &v);
    for (int c = 0; c < 3; c++) p.axis[c] = v.nearest.d[c] / sqrt(v.nearest.squared);
    if (v.gap > law.distance * (1 + 1e-12)) assert_true(hk_barrier_is_apart(&p, &law, x));
    for (int e = 0; e < 12; e++) x[e] += 0.1 * draw(&seed);
    if (!hk_barrier_is_apart(&p, &law, x)) continue;
    assert_false(hk_barrier_evaluate(&p, &law, x, &v));
    apart++;
  }
  assert_true(apart > 500);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_point_over_a_face_by_hand),
      cmocka_unit_test(it_ends_smoothly_and_has_no_end_below),
      cmocka_unit_test(derivatives_are_those_of_the_energy),
      cmocka_unit_test(the_projection_has_no_negative_directions),
      cmocka_unit_test(an_axis_hides_nothing_that_acts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
