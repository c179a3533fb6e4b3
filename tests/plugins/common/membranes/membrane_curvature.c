/* Definite second derivatives against dense eigen-decompositions, at random deformations and where directions have no
 * length or no area is left. */
#include "plugins/common/membranes/membrane_curvature.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { N = 6 };

static uint64_t seed = 11;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static hk_metric metric(const double f[N]) { return (hk_metric){dot(f, f), dot(f + 3, f + 3), dot(f, f + 3)}; }

/* d^2E/d[f g]^2 as a full matrix. */
static void expand(const hk_curvature *k, const double f[N], double H[N][N]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double ff = f[i] * f[j], fg = f[i] * f[3 + j], gf = f[3 + i] * f[j], gg = f[3 + i] * f[3 + j], one = i == j;
      H[i][j] = k->uu.i * one + k->uu.ff * ff + k->uu.fg * (fg + gf) + k->uu.gg * gg;
      H[3 + i][3 + j] = k->vv.i * one + k->vv.ff * ff + k->vv.fg * (fg + gf) + k->vv.gg * gg;
      H[i][3 + j] = H[3 + j][i] = k->uv.i * one + k->uv.ff * ff + k->uv.fg * fg + k->uv.gf * gf + k->uv.gg * gg;
    }
}

/* Jacobi's method: A becomes diagonal, the columns of V its eigenvectors. */
static void decompose(double A[N][N], double V[N][N]) {
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) V[i][j] = i == j;
  for (int sweep = 0; sweep < 30; sweep++)
    for (int p = 0; p < N; p++)
      for (int q = p + 1; q < N; q++) {
        if (A[p][q] == 0) continue;
        double theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < N; k++) {
          double a = A[k][p], b = A[k][q];
          A[k][p] = c * a - s * b, A[k][q] = s * a + c * b;
        }
        for (int k = 0; k < N; k++) {
          double a = A[p][k], b = A[q][k], v = V[k][p], w = V[k][q];
          A[p][k] = c * a - s * b, A[q][k] = s * a + c * b;
          V[k][p] = c * v - s * w, V[k][q] = s * v + c * w;
        }
      }
}

static double largest(const double H[N][N]) {
  double most = 0;
  for (int i = 0; i < N * N; i++) most = fmax(most, fabs(H[i / N][i % N]));
  return most;
}

/* H without its negative eigenvalues. */
static void project(const double H[N][N], double P[N][N]) {
  double A[N][N], V[N][N];
  memcpy(A, H, sizeof A);
  decompose(A, V);
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      P[i][j] = 0;
      for (int k = 0; k < N; k++) P[i][j] += fmax(0, A[k][k]) * V[i][k] * V[j][k];
    }
}

static double least_eigenvalue(const double H[N][N]) {
  double A[N][N], V[N][N], least = INFINITY;
  memcpy(A, H, sizeof A);
  decompose(A, V);
  for (int k = 0; k < N; k++) least = fmin(least, A[k][k]);
  return least;
}

/* Deformation number k: random, and some in which directions have no length or no area is left. */
static void deformation(int k, double f[N]) {
  for (int c = 0; c < N; c++) f[c] = noise();
  for (int c = 0; c < 3; c++) {
    if (k == 0) f[c] = 0;
    if (k == 1) f[c] = f[3 + c] = 0;
    if (k == 2) f[3 + c] = f[c];
    if (k == 3) f[3 + c] = -2 * f[c];
    if (k == 4) f[3 + c] = c == 0, f[c] = c == 1; /* at rest */
    if (k == 5) f[3 + c] = 0.5 * (c == 0), f[c] = 0.5 * (c == 1);
  }
}

static void compare(const hk_curvature *definite, const hk_curvature *exact, const double f[N], const double at[N]) {
  double H[N][N], P[N][N], D[N][N];
  expand(exact, f, H);
  project((const double(*)[N])H, P);
  expand(definite, at, D);
  /* rounding of six eigenvalues and of the turn */
  for (int i = 0; i < N * N; i++)
    assert_true(fabs(P[i / N][i % N] - D[i / N][i % N]) <= 1e-13 * largest((const double(*)[N])H));
}

static void conditions_are_projected_one_by_one(void **state) {
  (void)state;
  static const hk_elasticity one[] = {{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 0, 1.5}};
  for (int k = 0; k < 3000; k++) {
    double f[N], sum[N][N] = {{0}}, D[N][N];
    deformation(k, f);
    for (int c = 0; c < 3; c++) {
      if (k < 2 && c < 2) continue; /* a direction without length has no second derivative */
      hk_curvature exact = hk_curvature_baraff_witkin(one[c], metric(f), false);
      hk_curvature definite = hk_curvature_baraff_witkin(one[c], metric(f), true);
      compare(&definite, &exact, f, f);
      expand(&definite, f, D);
      for (int i = 0; i < N * N; i++) sum[i / N][i % N] += D[i / N][i % N];
    }
    hk_curvature all = hk_curvature_baraff_witkin((hk_elasticity){2, 3, 0, 1.5}, metric(f), true);
    expand(&all, f, D);
    for (int i = 0; i < N * N && k > 1; i++)
      assert_true(fabs(D[i / N][i % N] - sum[i / N][i % N]) <= 1e-13 * largest((const double(*)[N])D));
    assert_true(least_eigenvalue((const double(*)[N])D) >= -1e-14 * largest((const double(*)[N])D));
  }
}

/* The frame is turned, and the matrix with it: that of F' = F R has the blocks of H between columns of R. */
static void turn_back(const double D[N][N], double p, double q, double H[N][N]) {
  const double R[2][2] = {{p, -q}, {q, p}};
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++)
      for (int i = 0; i < 9; i++) {
        double sum = 0;
        for (int c = 0; c < 4; c++) sum += R[a][c / 2] * R[b][c % 2] * D[3 * (c / 2) + i / 3][3 * (c % 2) + i % 3];
        H[3 * a + i / 3][3 * b + i % 3] = sum;
      }
}

static void rubber_is_projected_as_a_whole(void **state) {
  (void)state;
  for (int k = 1; k < 3000; k++) {
    double f[N], g[N], p, q, H[N][N], P[N][N], D[N][N], back[N][N], n = k % 3 == 0 ? 1 : k % 3 == 1 ? 0.4 : 0;
    deformation(k, f);
    hk_metric m = metric(f);
    hk_volume_term w = hk_volume_term_at(m.a * m.b - m.c * m.c, n);
    hk_principal_turn(m, &p, &q);
    for (int c = 0; c < 3; c++) g[c] = p * f[c] + q * f[3 + c], g[3 + c] = p * f[3 + c] - q * f[c];
    hk_metric h = metric(g);
    assert_true(fabs(h.c) <= 2e-15 * h.a); /* the rounding of f_u, f_v and their products */
    hk_curvature exact = hk_curvature_neo_hookean(2, m, w.first, w.second);
    hk_curvature definite = hk_curvature_neo_hookean_definite(2, (hk_metric){h.a, h.b, 0}, w.first, w.second);
    expand(&definite, g, D);
    turn_back((const double(*)[N])D, p, q, back);
    assert_true(least_eigenvalue((const double(*)[N])back) >= -1e-13 * largest((const double(*)[N])back));
    if (k <= 3) continue; /* no second direction: what acts along it is left out */
    expand(&exact, f, H);
    project((const double(*)[N])H, P);
    /* the turn is known to eps over the difference of its lengths, so rounding is that of the matrix */
    for (int i = 0; i < N * N; i++)
      assert_true(fabs(P[i / N][i % N] - back[i / N][i % N]) <= 1e-11 * largest((const double(*)[N])H));
  }
}

/* The difference to the exact matrix is that of the stresses, and has no negative eigenvalue. */
static void green_strains_keep_what_is_definite(void **state) {
  (void)state;
  const hk_elasticity e = {3, 2, 0.5, 0.7};
  for (int k = 0; k < 3000; k++) {
    double f[N], H[N][N], D[N][N], more[N][N];
    deformation(k, f);
    hk_curvature exact = hk_curvature_stvk(e, metric(f), false), definite = hk_curvature_stvk(e, metric(f), true);
    expand(&exact, f, H);
    expand(&definite, f, D);
    for (int i = 0; i < N * N; i++) more[i / N][i % N] = D[i / N][i % N] - H[i / N][i % N];
    double size = fmax(largest((const double(*)[N])H), largest((const double(*)[N])D));
    assert_true(least_eigenvalue((const double(*)[N])D) >= -1e-14 * size);
    assert_true(least_eigenvalue((const double(*)[N])more) >= -1e-14 * size);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(conditions_are_projected_one_by_one),
      cmocka_unit_test(rubber_is_projected_as_a_whole),
      cmocka_unit_test(green_strains_keep_what_is_definite),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
