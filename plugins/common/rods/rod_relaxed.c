/* What the sections' angles soften: of the energy at the angles of least energy the second derivative is
 * H - C^T A^-1 C, with A that of the angles, tridiagonal and in the corners of a ring, and C of angles and positions.
 * It joins all particles of a rod. The directions of C are those of rod_blocks.c, so angles are transported with edges.
 */
#include "plugins/common/rods/rod_angles.h"
#include "plugins/common/rods/rod_joint.h"

#include <string.h>

enum { LANES = HK_ROD_LANES };

static size_t longest(const hk_rods *r) {
  size_t edges = 0;
  for (size_t q = 0; q < r->batches; q++)
    if (r->batch[q].framed && r->batch[q].edges > edges) edges = r->batch[q].edges;
  return edges;
}

hk_status hk_rod_relaxed_reserve(hk_rods *r) {
  size_t n = longest(r);
  r->host->release(r->host, r->dense);
  r->dense = r->host->allocate(r->host, (n * n + 3 * n * (n + 1) + 1) * sizeof *r->dense);
  return r->dense ? HK_OK : r->host->fail(r->host, HK_NO_MEMORY, "no memory for the blocks of %zu edges", n);
}

static size_t nodes_of(const hk_rod_batch *b, size_t lane) { return b->count[lane] + !b->ring; }

/* Adds a joint's second derivatives to A (n x n) and C (n x 3 nodes). */
static void add_joint(const hk_rods *r, const hk_rod_batch *b, size_t lane, size_t k, double *A, double *C) {
  hk_rod_joint j;
  double g[2][6], m[6], half[6];
  size_t n = b->count[lane], nodes = nodes_of(b, lane), edge[2] = {k, k + 1 < n ? k + 1 : 0};
  hk_rod_joint_at(r, b, lane, k, &j);
  hk_rod_joint_gradients(&j, g, m);
  double h = j.bend[0] * j.k[1] * j.k[1] + j.bend[1] * j.k[0] * j.k[0] - j.w[0] * j.k[0] - j.w[1] * j.k[1];
  for (int q = 0; q < 6; q++)
    half[q] = ((j.bend[0] * j.k[1] - j.w[1]) * g[0][q] + (j.w[0] - j.bend[1] * j.k[0]) * g[1][q]) / 2;
  for (int s = 0; s < 2; s++) {
    for (int t = 0; t < 2; t++) A[edge[s] * n + edge[t]] += h / 4 + (s == t ? j.twist : -j.twist);
    double *row = C + edge[s] * 3 * nodes;
    for (size_t q = 0; q < 6; q++) { /* an edge is its second node less its first */
      double slope = half[q] + (s == 0 ? -j.twist : j.twist) * m[q];
      size_t first = edge[q / 3], second = first + 1 < nodes ? first + 1 : 0;
      row[3 * first + q % 3] -= slope;
      row[3 * second + q % 3] += slope;
    }
  }
}

/* A = L L^T in place; C becomes L^-1 C. Angles that are held, or free of any energy, have no part. */
static void forward(double *A, double *C, size_t n, size_t width) {
  for (size_t i = 0; i < n; i++) {
    double whole = A[i * n + i];
    for (size_t k = 0; k < i; k++) {
      double l = A[i * n + k];
      for (size_t q = 0; q < k; q++) l -= A[i * n + q] * A[k * n + q];
      if (l == 0) continue;
      l *= A[k * n + k]; /* 1/diagonal */
      A[i * n + k] = l;
      A[i * n + i] -= l * l;
      for (size_t c = 0; c < width; c++) C[i * width + c] -= l * C[k * width + c];
    }
    double scale = A[i * n + i] > 1e-12 * whole && whole > 0 ? 1 / sqrt(A[i * n + i]) : 0;
    A[i * n + i] = scale;
    for (size_t c = 0; c < width; c++) C[i * width + c] *= scale;
  }
}

/* Subtracts C^T C; the slots of a rod are node by node. */
static const size_t *subtract(const double *C, size_t n, size_t nodes, const size_t *slot, double *K) {
  for (size_t a = 0; a < nodes; a++)
    for (size_t b = 0; b < nodes; b++, slot++)
      for (size_t k = 0; k < n; k++) {
        const double *row = C + k * 3 * nodes;
        for (size_t q = 0; q < 9; q++) K[9 * *slot + q] -= row[3 * a + q / 3] * row[3 * b + q % 3];
      }
  return slot;
}

static const size_t *relax(const hk_rods *r, const hk_rod_batch *b, size_t lane, const size_t *slot, double *K) {
  size_t n = b->count[lane], nodes = nodes_of(b, lane);
  double *A = r->dense, *C = A + n * n;
  memset(A, 0, (n * n + 3 * n * nodes) * sizeof *A);
  for (size_t k = 0; k < hk_rod_joints(b, lane); k++) add_joint(r, b, lane, k, A, C);
  for (size_t k = 0; k < n; k++) {
    if (r->rows.held[(b->first + k) * LANES + lane] == 0) continue;
    for (size_t q = 0; q < n; q++) A[k * n + q] = A[q * n + k] = 0;
    memset(C + k * 3 * nodes, 0, 3 * nodes * sizeof *C);
  }
  forward(A, C, n, 3 * nodes);
  return subtract(C, n, nodes, slot, K);
}

void hk_rod_relaxed_pattern(const hk_rods *r, hk_pattern *p) {
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; r->batch[q].framed && lane < LANES; lane++) {
      const hk_rod_batch *b = &r->batch[q];
      const uint32_t *node = r->rows.node + (b->first + b->number) * LANES + lane;
      size_t nodes = b->count[lane] ? nodes_of(b, lane) : 0;
      for (size_t a = 0; a < nodes * nodes; a++) p->block(p, node[a / nodes * LANES], node[a % nodes * LANES]);
    }
}

void hk_rod_relaxed_subtract(const hk_rods *r, size_t joints, const hk_blocks *into) {
  const size_t *slot = into->slot + 9 * joints;
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; r->batch[q].framed && lane < LANES; lane++)
      if (r->batch[q].count[lane]) slot = relax(r, &r->batch[q], lane, slot, into->K);
}
