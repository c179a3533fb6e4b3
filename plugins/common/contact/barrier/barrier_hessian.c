/* The Hessian of a pair: see barrier_pair.h. With the gradients g of E and h of m, and the Hessian M of m, m E has the
 * Hessian m E'' + g h^T + h g^T + E M, where g_i = w_i times one vector, and h and M depend on x_i by the two edges
 * alone. */
#include "plugins/common/contact/barrier/barrier_pair.h"

/* The derivative of an edge by x_i is the unit matrix with this sign. */
static double sign_of(int i) { return i % 2 == 0 ? -1 : 1; }

static void find_turn(const hk_barrier_pair *p, const hk_barrier_value *v, const double at[12], hk_barrier_turn *t) {
  static const int row[3] = {3, 3, 9}, column[3] = {3, 9, 9}; /* of x1 and x3, whose signs are 1 */
  double g[12], H[144];
  hk_edge_mollifier(at, p->limit, g, H);
  for (int c = 0; c < 3; c++) {
    t->force[c] = 2 * v->E1 * v->nearest.d[c];
    t->gradient[0][c] = g[3 + c];
    t->gradient[1][c] = g[9 + c];
  }
  for (int b = 0; b < 3; b++)
    for (int e = 0; e < 9; e++) t->M[b][e] = v->E * H[12 * (row[b] + e / 3) + column[b] + e % 3];
}

void hk_barrier_hessian_of(const hk_barrier_pair *p, const hk_barrier_value *v, const double *x, bool definite,
                           hk_barrier_hessian *h) {
  double at[12];
  hk_pair_gather(&p->pair, x, at);
  hk_distance_energy_form(&v->nearest, at, v->m * v->E1, v->m * v->E2, definite, &h->form);
  h->turns = v->m < 1 && !definite;
  if (h->turns) find_turn(p, v, at, &h->turn);
}

static void add_turn(const hk_barrier_turn *t, const double w[4], int i, int j, double B[9]) {
  const double *M = t->M[i / 2 + j / 2], *hi = t->gradient[i / 2], *hj = t->gradient[j / 2];
  bool turned = i / 2 > j / 2; /* vu is uv transposed */
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      B[3 * r + c] += w[i] * t->force[r] * sign_of(j) * hj[c] + w[j] * t->force[c] * sign_of(i) * hi[r] +
                      sign_of(i) * sign_of(j) * M[turned ? 3 * c + r : 3 * r + c];
}

void hk_barrier_turn_row(const hk_barrier_hessian *h, int i, const size_t slot[4], double *B) {
  for (int j = 0; j < 4; j++) add_turn(&h->turn, h->form.w, i, j, B + 9 * slot[j]);
}
