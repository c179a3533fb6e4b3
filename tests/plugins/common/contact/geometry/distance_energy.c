/* The Hessian of an energy of the distance by differences, and its projection against a dense decomposition; the
 * mollifier of edges by differences and at its ends. */
#include "plugins/common/contact/geometry/distance.h"

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

/* A pair whose nearest points tend to be inside, at a distance of about `apart`. */
static void pair(hk_pair_kind kind, double *x, double apart) {
  for (int k = 0; k < 12; k++) x[k] = noise();
  hk_nearest n = hk_nearest_of_pair(kind, x);
  double d = sqrt(n.squared);
  for (int i = 0; i < (kind == HK_POINT_TRIANGLE ? 1 : 2); i++)
    for (int c = 0; c < 3; c++) x[3 * i + c] += (apart / d - 1) * n.d[c];
}

static double largest(const double *a, int n) {
  double most = 0;
  for (int k = 0; k < n; k++) most = fmax(most, fabs(a[k]));
  return most;
}

/* ---- A barrier --------------------------------------------------------------------------------------------------- */

/* E = -(s - L)^2 log(s/L), of the squared distance s below L (Li and others 2020). */
static const double L = 0.25;

static double barrier(double s, double *E2) {
  double a = s - L, l = log(s / L);
  *E2 = -2 * l - 4 * a / s + a * a / (s * s);
  return -2 * a * l - a * a / s;
}

static void energy_gradient(hk_pair_kind kind, const double *x, double g[12]) {
  hk_nearest n = hk_nearest_of_pair(kind, x);
  double E2, E1 = barrier(n.squared, &E2);
  hk_distance_gradient(&n, g);
  for (int k = 0; k < 12; k++) g[k] *= E1;
}

/* With h = 1e-6 of a length of 0.2 differences are off by (h/d)^2 and by 1e-16/h of what they derive. */
static void hessian_is_that_of_the_energy(void **state) {
  (void)state;
  int checked = 0;
  for (int k = 0; k < 2000; k++) {
    hk_pair_kind kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE;
    double x[12], H[144], D[144], g[2][12], h = 1e-6, E2;
    bool same = true;
    pair(kind, x, 0.2);
    hk_nearest n = hk_nearest_of_pair(kind, x);
    double E1 = barrier(n.squared, &E2);
    hk_distance_energy_hessian(&n, x, E1, E2, false, H);
    for (int j = 0; j < 12; j++) {
      for (int side = 0; side < 2; side++) {
        double y[12];
        memcpy(y, x, sizeof y);
        y[j] += side ? h : -h;
        same = same && hk_nearest_of_pair(kind, y).active == n.active;
        energy_gradient(kind, y, g[side]);
      }
      for (int i = 0; i < 12; i++) D[12 * i + j] = (g[1][i] - g[0][i]) / (2 * h);
    }
    if (!same || largest(H, 144) > 100) continue; /* nearly parallel lines: other lengths count */
    checked++;
    for (int i = 0; i < 144; i++) assert_true(fabs(H[i] - D[i]) < 1e-7 * (1 + largest(H, 144)));
  }
  assert_true(checked > 1500);
}

/* ---- The projection ---------------------------------------------------------------------------------------------- */

/* A becomes diagonal, V^T A V; by Jacobi's rotations. */
static void decompose(double A[12][12], double V[12][12]) {
  for (int i = 0; i < 144; i++) V[i / 12][i % 12] = i / 12 == i % 12;
  for (int sweep = 0; sweep < 30; sweep++)
    for (int p = 0; p < 12; p++)
      for (int q = p + 1; q < 12; q++) {
        if (A[p][q] == 0) continue;
        double h = (A[q][q] - A[p][p]) / (2 * A[p][q]), t = copysign(1, h) / (fabs(h) + hypot(1, h)),
               c = 1 / hypot(1, t), s = t * c;
        for (int k = 0; k < 12; k++) {
          double a = A[k][p], b = A[k][q];
          A[k][p] = c * a - s * b, A[k][q] = s * a + c * b;
          a = V[k][p], b = V[k][q];
          V[k][p] = c * a - s * b, V[k][q] = s * a + c * b;
        }
        for (int k = 0; k < 12; k++) {
          double a = A[p][k], b = A[q][k];
          A[p][k] = c * a - s * b, A[q][k] = s * a + c * b;
        }
      }
}

static void clamp(const double *H, double P[144]) {
  double A[12][12], V[12][12];
  memcpy(A, H, sizeof A);
  decompose(A, V);
  for (int i = 0; i < 144; i++) {
    P[i] = 0;
    for (int k = 0; k < 12; k++) P[i] += fmax(0, A[k][k]) * V[i / 12][k] * V[i % 12][k];
  }
}

/* Both by rotations: to rounding of the largest entry. */
static void projection_is_that_of_a_dense_decomposition(void **state) {
  (void)state;
  int seen[2][16] = {{0}};
  for (int k = 0; k < 1000; k++) {
    hk_pair_kind kind = k % 2 ? HK_EDGE_EDGE : HK_POINT_TRIANGLE;
    double x[12], H[144], P[144], C[144], E1 = noise(), E2 = noise();
    pair(kind, x, k % 5 ? 0.3 : 1e-6);
    if (k % 11 == 0) memcpy(x, x + 6, 3 * sizeof *x); /* no distance */
    if (k % 13 == 0) memcpy(x + 9, x + 6, 3 * sizeof *x);
    hk_nearest n = hk_nearest_of_pair(kind, x);
    seen[kind][n.active]++;
    hk_distance_energy_hessian(&n, x, E1, E2, false, H);
    hk_distance_energy_hessian(&n, x, E1, E2, true, P);
    clamp(H, C);
    for (int i = 0; i < 144; i++) assert_true(fabs(P[i] - C[i]) <= 1e-13 * largest(H, 144));
  }
  assert_true(seen[0][15] > 10 && seen[1][15] > 10 && seen[0][3] + seen[0][5] + seen[0][9] > 10 && seen[1][7] > 5);
}

/* ---- The mollifier ----------------------------------------------------------------------------------------------- */

static void mollifier_has_its_derivatives(void **state) {
  (void)state;
  int below = 0;
  for (int k = 0; k < 500; k++) {
    double x[12], g[12], H[144], h = 1e-5, limit = 0.1 + 2 * fabs(noise());
    for (int i = 0; i < 12; i++) x[i] = noise();
    double m = hk_edge_mollifier(x, limit, g, H);
    assert_true(m >= 0 && m <= 1);
    below += m < 1;
    for (int j = 0; j < 12; j++) {
      double y[12], f[2], gy[2][12];
      for (int side = 0; side < 2; side++) {
        memcpy(y, x, sizeof y);
        y[j] += side ? h : -h;
        f[side] = hk_edge_mollifier(y, limit, gy[side], NULL);
      }
      assert_true(fabs((f[1] - f[0]) / (2 * h) - g[j]) < 1e-6); /* h^2 third derivatives of up to 1e3 */
      if (m > 0.999) continue;                                  /* the second derivative jumps at 1 */
      for (int i = 0; i < 12; i++) assert_true(fabs((gy[1][i] - gy[0][i]) / (2 * h) - H[12 * i + j]) < 1e-5);
    }
  }
  assert_true(below > 100);
}

static void mollifier_ends_at_parallel_and_at_its_limit(void **state) {
  (void)state;
  double g[12], H[144], along[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 1, 0},
                        across[12] = {0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 1}, point[12] = {0};
  assert_true(hk_edge_mollifier(along, 0.1, g, H) == 0 && largest(g, 12) == 0);
  assert_true(hk_edge_mollifier(across, 4, g, H) == 1 && largest(g, 12) == 0 && largest(H, 144) == 0);
  assert_true(hk_edge_mollifier(across, 8, NULL, NULL) == 0.75); /* c = 4: (2 - 1/2)/2 */
  assert_true(hk_edge_mollifier(point, 1, g, H) == 0 && largest(g, 12) == 0 && largest(H, 144) == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hessian_is_that_of_the_energy),
      cmocka_unit_test(projection_is_that_of_a_dense_decomposition),
      cmocka_unit_test(mollifier_has_its_derivatives),
      cmocka_unit_test(mollifier_ends_at_parallel_and_at_its_limit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
