/* Bounds of the stiffness and damping of forces along edges: see edge_stiffness.c. */
#ifndef HK_COMMON_EDGE_STIFFNESS_H
#define HK_COMMON_EDGE_STIFFNESS_H

#include "core/plugin.h"
#include "plugins/kit/springs/edge.h"

typedef struct hk_edge_stiffness {
  const hk_tuples *edges;
  const hk_per_tuple *k, *damping, *rest; /* N/m, N s/m, m */
  bool drawn; /* bounds the limit of infinite extension, where an edge is as stiff across as along */
} hk_edge_stiffness;

/* Adds the share of one edge along the unit vector n (0: no direction) with the stiffness or damping `along` it and
 * `across`, neither negative. */
static inline void hk_edge_stiffness_add(const hk_view *, const uint32_t pair[2], const double n[3], double along,
                                         double across, double (*block)[6]);

typedef struct hk_edge_numbers {
  double k, damping, rest; /* N/m, N s/m, m */
} hk_edge_numbers;

/* Adds the share of one spring to what the function below has to sum; `drawn` as above. */
static inline void hk_edge_stiffness_one(const hk_view *, const uint32_t pair[2], hk_edge_numbers, bool drawn,
                                         hk_stiffness_part, double (*block)[6]);

/* As hk_force.stiffness_bound, for all u that are 0 at particles without inverse mass: those have no share. */
static inline void hk_edge_stiffness_bound(const hk_edge_stiffness *, const hk_view *, hk_stiffness_part,
                                           double (*block)[6]);

/* ---- how ---- */

/* Bounds of the stiffness and damping of forces along edges.
 *
 * A spring along the unit vector n, of length l, stiffness k and rest length L, has for u = u_j - u_i the energy
 * Hessian H = k n n^T + k (1 - L/l) (I - n n^T). Its second term is used when positive (tension); omitting it when
 * negative (compression) only raises the bound. By Young's inequality u^T H u <= (1 + s) u_i^T H u_i + (1 + 1/s) u_j^T
 * H u_j,   s = sqrt(m_i/m_j), which divides the bound between the two ends; this s makes the bound of the frequencies
 * smallest. It keeps the directions of the springs, so it does not depend on the axes, and regular grids of any spacing
 * reach it; a bound of each block by its norm would be too large by a factor of 2. */

/* Adds factor (along n n^T + across (I - n n^T)) to a block; n is 0 where there is no direction. */
static inline void hk_edge_add_block(double *block, double factor, double along, double across, const double n[3]) {
  double lateral = factor * across, rest = factor * (along - across);
  block[0] += lateral + rest * n[0] * n[0];
  block[1] += rest * n[0] * n[1];
  block[2] += rest * n[0] * n[2];
  block[3] += lateral + rest * n[1] * n[1];
  block[4] += rest * n[1] * n[2];
  block[5] += lateral + rest * n[2] * n[2];
}

static inline double hk_edge_value(const hk_per_tuple *p, size_t e) { return p->count ? hk_tuple_value(p, e) : 0; }

/* Stiffness across a spring of length 1/r. At length 0 (r = 0, too) there is no direction: the result is the limit k
 * for L = 0, otherwise 0. */
static inline double hk_edge_across(hk_edge_numbers q, bool drawn, double r) {
  if (drawn || q.rest == 0) return q.k;
  double tension = r > 0 ? 1 - q.rest * r : 0;
  return tension > 0 ? q.k * tension : 0;
}

static inline void hk_edge_stiffness_add(const hk_view *view, const uint32_t pair[2], const double n[3], double along,
                                         double across, double (*block)[6]) {
  double wi = view->model->inverse_mass[pair[0]], wj = view->model->inverse_mass[pair[1]];
  double s = wi == wj ? 1 : sqrt(wj / wi); /* unequal masses pay for the root */
  if (wi > 0) hk_edge_add_block(block[pair[0]], 1 + s, along, across, n);
  if (wj > 0) hk_edge_add_block(block[pair[1]], wi > 0 ? 1 + 1 / s : 1, along, across, n);
}

static inline void hk_edge_stiffness_one(const hk_view *view, const uint32_t pair[2], hk_edge_numbers q, bool drawn,
                                         hk_stiffness_part part, double (*block)[6]) {
  double n[3], l = hk_edge_difference(view->x, pair, n), along = 0, across = 0;
  double r = l > 0 ? 1 / l : 0;
  for (int c = 0; c < 3; c++) n[c] *= r;
  if (part == HK_DAMPING_WHOLE)
    along = q.damping, across = drawn ? along : 0; /* the direction is not known */
  else
    across = hk_edge_across(q, drawn, r);
  if (part == HK_STIFFNESS_WHOLE) along = q.k;
  hk_edge_stiffness_add(view, pair, n, along, across, block);
}

static inline void hk_edge_stiffness_bound(const hk_edge_stiffness *s, const hk_view *view, hk_stiffness_part part,
                                           double (*block)[6]) {
  for (size_t e = 0; e < s->edges->count; e++) {
    const hk_edge_numbers q = {hk_edge_value(s->k, e), hk_edge_value(s->damping, e), hk_edge_value(s->rest, e)};
    const uint32_t *pair = hk_tuple(s->edges, e);
    if (hk_edge_acts(view, pair)) hk_edge_stiffness_one(view, pair, q, s->drawn, part, block);
  }
}

#endif
