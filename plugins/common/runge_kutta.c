/* See runge_kutta.h. Stages are evaluated in order; the stability function comes from the same tableau, by applying
 * the method to y' = z y: Y_i = 1 + z sum a_ij Y_j, R = 1 + z sum b_i Y_i (Hairer and Wanner, Solving ODEs II, IV.2).
 */
#include "plugins/common/runge_kutta.h"

#include <complex.h>
#include <string.h>

/* Dormand and Prince 1980, RK5(4)7M. */
const hk_tableau hk_dormand_prince = {
    .stages = 7,
    .c = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1},
    .a = {{0},
          {1.0 / 5},
          {3.0 / 40, 9.0 / 40},
          {44.0 / 45, -56.0 / 15, 32.0 / 9},
          {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
          {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
          {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}},
    .b = {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0},
};

static void combine(double *restrict into, const double *restrict X, const double *k, size_t size, const double *weight,
                    int count, double h) {
  if (into != X) memcpy(into, X, size * sizeof *into);
  for (int j = 0; j < count; j++) {
    const double *restrict kj = k + (size_t)j * size;
    double w = h * weight[j];
    if (w == 0) continue;
    for (size_t e = 0; e < size; e++) into[e] += w * kj[e];
  }
}

hk_status hk_rk_stages(const hk_tableau *T, hk_system *s, double h, double *k, int first) {
  double *stage = k + (size_t)T->stages * s->size;
  for (int i = first; i < T->stages; i++) {
    double *X = s->X;
    if (i > 0) {
      combine(stage, s->X, k, s->size, T->a[i], i, h);
      X = stage;
    }
    hk_status status = s->rates(s, s->t + T->c[i] * h, X, k + (size_t)i * s->size);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

void hk_rk_advance(const hk_tableau *T, const hk_system *s, double h, const double *k, double *X) {
  for (int i = 0; i < T->stages; i++) {
    const double *restrict ki = k + (size_t)i * s->size;
    double *restrict into = X, w = h * T->b[i];
    if (w == 0) continue;
    for (size_t e = 0; e < s->size; e++) into[e] += w * ki[e];
  }
}

static double stability(const hk_tableau *T, double complex z) {
  double complex Y[HK_RK_STAGES], R = 1;
  for (int i = 0; i < T->stages; i++) {
    Y[i] = 1;
    for (int j = 0; j < i; j++) Y[i] += z * T->a[i][j] * Y[j];
    R += z * T->b[i] * Y[i];
  }
  return cabs(R);
}

double hk_rk_amplification(const hk_tableau *T, double hw, double hg) {
  double complex root = csqrt(hg * hg - 4 * hw * hw);
  return fmax(stability(T, (-hg + root) / 2), stability(T, (-hg - root) / 2));
}
