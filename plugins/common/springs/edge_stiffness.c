/* Bounds of the stiffness and damping of forces along edges.
 *
 * A spring along the unit vector n, of length l, stiffness k and rest length L, has for u = u_j - u_i the energy
 * Hessian H = k n n^T + k (1 - L/l) (I - n n^T). Its second term is used when positive (tension); omitting it when
 * negative (compression) only raises the bound. By Young's inequality u^T H u <= (1 + s) u_i^T H u_i + (1 + 1/s) u_j^T
 * H u_j,   s = sqrt(m_i/m_j), which divides the bound between the two ends; this s makes the bound of the frequencies
 * smallest. It keeps the directions of the springs, so it does not depend on the axes, and regular grids of any spacing
 * reach it; a bound of each block by its norm would be too large by a factor of 2. */
#include "plugins/common/springs/edge_stiffness.h"
#include "plugins/common/springs/edge.h"

/* Adds factor (along n n^T + across (I - n n^T)) to a block; n is 0 where there is no direction. */
static void add_block(double *block, double factor, double along, double across, const double n[3]) {
  double lateral = factor * across, rest = factor * (along - across);
  block[0] += lateral + rest * n[0] * n[0];
  block[1] += rest * n[0] * n[1];
  block[2] += rest * n[0] * n[2];
  block[3] += lateral + rest * n[1] * n[1];
  block[4] += rest * n[1] * n[2];
  block[5] += lateral + rest * n[2] * n[2];
}

static double value_of(const hk_per_tuple *p, size_t e) { return p->count ? hk_tuple_value(p, e) : 0; }

/* Stiffness across a spring of length 1/r. At length 0 (r = 0, too) there is no direction: the result is the limit k for
 * L = 0, otherwise 0. */
static double across_of(hk_edge_numbers q, bool drawn, double r) {
  if (drawn || q.rest == 0) return q.k;
  double tension = r > 0 ? 1 - q.rest * r : 0;
  return tension > 0 ? q.k * tension : 0;
}

void hk_edge_stiffness_add(const hk_view *view, const uint32_t pair[2], const double n[3], double along, double across,
                           double (*block)[6]) {
  double wi = view->model->inverse_mass[pair[0]], wj = view->model->inverse_mass[pair[1]];
  double s = wi == wj ? 1 : sqrt(wj / wi); /* unequal masses pay for the root */
  if (wi > 0) add_block(block[pair[0]], 1 + s, along, across, n);
  if (wj > 0) add_block(block[pair[1]], wi > 0 ? 1 + 1 / s : 1, along, across, n);
}

void hk_edge_stiffness_one(const hk_view *view, const uint32_t pair[2], hk_edge_numbers q, bool drawn,
                           hk_stiffness_part part, double (*block)[6]) {
  double n[3], l = hk_edge_difference(view->x, pair, n), along = 0, across = 0;
  double r = l > 0 ? 1 / l : 0;
  for (int c = 0; c < 3; c++) n[c] *= r;
  if (part == HK_DAMPING_WHOLE)
    along = q.damping, across = drawn ? along : 0; /* the direction is not known */
  else
    across = across_of(q, drawn, r);
  if (part == HK_STIFFNESS_WHOLE) along = q.k;
  hk_edge_stiffness_add(view, pair, n, along, across, block);
}

void hk_edge_stiffness_bound(const hk_edge_stiffness *s, const hk_view *view, hk_stiffness_part part,
                             double (*block)[6]) {
  for (size_t e = 0; e < s->edges->count; e++) {
    const hk_edge_numbers q = {value_of(s->k, e), value_of(s->damping, e), value_of(s->rest, e)};
    const uint32_t *pair = hk_tuple(s->edges, e);
    if (hk_edge_acts(view, pair)) hk_edge_stiffness_one(view, pair, q, s->drawn, part, block);
  }
}
