/* Derivatives of the squared distance. With the parameters q of the active points (none, one or two), the difference of
 * points d(q) = sum_i w_i(q) x_i is linear in q, and |d|^2 is least at d.d_k = 0, where d_k = dd/dq_k. By the envelope
 * theorem the gradient by x_i is 2 w_i d, and with G_kl = d_k.d_l
 *     H = 2 (w w^T (x) I - sum_kl (G^-1)_kl u_k u_l^T),   u_k = dw/dq_k (x) d + w (x) d_k,
 * one formula for all kinds and sets of active points. With parameters for which G is the unit matrix (nearest_frame.h)
 *     H = 2 (w w^T (x) (I - sum_k d_k d_k^T) - sum_k (p_k p_k^T + p_k (w (x) d_k)^T + (w (x) d_k) p_k^T)),
 *     p_k = dw/dq_k (x) d. */
#include "plugins/common/collision/distance.h"
#include "plugins/common/collision/nearest_frame.h"

void hk_distance_gradient(const hk_nearest *near, double g[12]) {
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 3; c++) g[3 * i + c] = 2 * near->w[i] * near->d[c];
}

/* The 3 x 3 block of points i and j. `across`: I - sum_k d_k d_k^T. turn_i = sum_k dw_k(i) d_k. */
static void block(const hk_nearest *near, const hk_nearest_frame *f, double across[3][3], double turn[4][3], int i,
                  int j, double B[3][3]) {
  double wi = near->w[i], wj = near->w[j], shift = f->dw[0][i] * f->dw[0][j] + f->dw[1][i] * f->dw[1][j];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      B[r][c] = 2 * (wi * wj * across[r][c] - near->d[r] * (shift * near->d[c] + wj * turn[i][c]) -
                     wi * turn[j][r] * near->d[c]);
}

void hk_distance_hessian(const hk_nearest *near, const double x[12], double H[144]) {
  hk_nearest_frame f = hk_nearest_frame_of(near, x);
  double across[3][3], turn[4][3], B[3][3];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      across[r][c] = f.axis[0][r] * f.axis[0][c];
      for (int k = f.count; k < 2; k++) across[r][c] += f.axis[1 + k][r] * f.axis[1 + k][c];
    }
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 3; c++) turn[i][c] = f.dw[0][i] * f.axis[1][c] + f.dw[1][i] * f.axis[2][c];
  for (int i = 0; i < 4; i++)
    for (int j = i; j < 4; j++) {
      block(near, &f, across, turn, i, j, B);
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) H[12 * (3 * i + r) + 3 * j + c] = H[12 * (3 * j + c) + 3 * i + r] = B[r][c];
    }
}
