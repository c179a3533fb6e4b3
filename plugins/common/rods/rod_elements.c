/* Rods that only bend, straight at rest and alike in all directions, as elements: the three components of the curvature
 * binormal at each joint, E = bend/2 |kb|^2. Others have none: the angles of their sections belong to whole rods. A
 * clamp that is released keeps its half length in what methods took from here. */
#include "plugins/common/rods/rod_elements.h"
#include "plugins/kit/vector3.h"

enum { LANES = HK_ROD_LANES };

typedef struct edge {
  double t[3], inverse;
} edge;

static edge edge_between(const double *x, uint32_t i, uint32_t j) {
  edge e;
  hk_subtract(e.t, x + 3 * (size_t)j, x + 3 * (size_t)i);
  double l2 = hk_dot(e.t, e.t);
  e.inverse = l2 > 1e-300 ? 1 / sqrt(l2) : 0;
  for (int c = 0; c < 3; c++) e.t[c] *= e.inverse;
  return e;
}

/* d kb/de for a change of the first or, with sign -1, the second edge's vector: kb = 2 t0 x t1/chi, so that
 * d kb = 2/chi dt0 x t1 - kb (dt0.t1)/chi, dt0 = (I - t0 t0) de/|e|. */
static void slope(const edge *own, const edge *other, const double kb[3], double chi, double sign, double D[3][3]) {
  for (int c = 0; c < 3; c++) { /* along axis c */
    double dt[3], side[3];
    for (int q = 0; q < 3; q++) dt[q] = own->inverse * ((q == c) - own->t[q] * own->t[c]);
    hk_cross(side, dt, other->t);
    double along = hk_dot(dt, other->t);
    for (int q = 0; q < 3; q++) D[q][c] = (2 * sign * side[q] - kb[q] * along) / chi;
  }
}

static void evaluate(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const hk_rod_elements *r = self;
  for (size_t k = begin; k < end; k++, C += 3, dC += 9) {
    const uint32_t *node = r->node + 3 * k;
    edge e0 = edge_between(x, node[0], node[1]), e1 = edge_between(x, node[1], node[2]);
    double chi = fmax(1 + hk_dot(e0.t, e1.t), HK_ROD_FOLD), D0[3][3], D1[3][3];
    hk_cross(C, e0.t, e1.t);
    for (int c = 0; c < 3; c++) C[c] *= 2 / chi;
    slope(&e0, &e1, C, chi, 1, D0);
    slope(&e1, &e0, C, chi, -1, D1);
    for (int q = 0; q < 3; q++)
      for (int c = 0; c < 3; c++) {
        dC[3 * q][c] = -D0[q][c];
        dC[3 * q + 1][c] = D0[q][c] - D1[q][c];
        dC[3 * q + 2][c] = D1[q][c];
      }
  }
}

static size_t joints_of(const hk_rod_batch *b, size_t lane) {
  return b->count[lane] > b->ring ? b->count[lane] - !b->ring : 0;
}

void hk_rod_elements_fill(hk_rod_elements *r, const hk_rod_rows *w, const hk_rod_batch *batch, size_t batches) {
  size_t k = 0;
  for (size_t q = 0; q < batches; q++)
    for (size_t lane = 0; lane < LANES; lane++)
      for (size_t j = 0; j < joints_of(&batch[q], lane); j++, k++) {
        const uint32_t *node = w->node + (batch[q].first + batch[q].number) * LANES + lane;
        size_t last = j + 2 <= batch[q].count[lane] ? j + 2 : 1;
        r->node[3 * k] = node[j * LANES], r->node[3 * k + 1] = node[(j + 1) * LANES];
        r->node[3 * k + 2] = node[last * LANES];
        r->stiffness[k] = w->bend[0][(batch[q].first + j) * LANES + lane];
      }
  r->count = k;
}

void hk_rod_elements_offer(const hk_rod_elements *r, const hk_rod_batch *batch, size_t batches, hk_elements *out) {
  out->values = 3;
  for (size_t q = 0; q < batches; q++)
    if (batch[q].framed) out->values = 0;
  out->node = (hk_tuples){r->count, 3, r->node};
  out->stiffness = (hk_per_tuple){r->count, r->stiffness};
  out->damping = out->rest = (hk_per_tuple){0, NULL};
  out->evaluate = evaluate;
  out->self = r;
}
