/* See barrier_pair.h. Derivatives are those of E(d^2) by the chain rule, with the exact ones of d^2 (distance.h). */
#include "plugins/common/barrier/barrier_pair.h"
#include "plugins/common/barrier/barrier_function.h"

#include <string.h>

void hk_barrier_gather(const uint32_t vertex[4], const double *x, double at[12]) {
  for (size_t a = 0; a < 4; a++) memcpy(at + 3 * a, x + 3 * (size_t)vertex[a], 3 * sizeof *at);
}

bool hk_barrier_evaluate(const hk_barrier_pair *p, const hk_barrier_law *law, const double *x, hk_barrier_value *v) {
  double xi = p->pair.offset, D = law->distance, whole = D * (D + 2 * xi);
  hk_barrier_gather(p->pair.vertex, x, v->x);
  v->nearest = hk_nearest_of_pair((hk_pair_kind)p->pair.kind, v->x);
  double d = sqrt(v->nearest.squared), s = (d - xi) * (d + xi), u = s / whole, energy = law->stiffness * p->area * D;
  v->gap = d - xi;
  if (!(u < 1)) return false;
  v->m = p->limit > 0 ? hk_edge_mollifier(v->x, p->limit, NULL, NULL) : 1;
  if (v->m < 1) hk_edge_mollifier(v->x, p->limit, v->g, NULL);
  if (!(u > 0)) {
    v->E = INFINITY, v->E1 = v->E2 = 0;
    return true;
  }
  hk_barrier_function b = hk_barrier_at(u);
  v->E = energy * b.value;
  v->E1 = energy * b.slope / whole;
  v->E2 = energy * b.curvature / (whole * whole);
  return true;
}

void hk_barrier_gradient(const hk_barrier_value *v, double g[12]) {
  hk_distance_gradient(&v->nearest, g);
  for (int e = 0; e < 12; e++) g[e] *= v->m * v->E1;
  for (int e = 0; e < 12 && v->m < 1; e++) g[e] += v->E * v->g[e];
}

static void add_mollified(const hk_barrier_pair *p, const hk_barrier_value *v, double H[144]) {
  double g[12], gm[12], M[144];
  hk_distance_gradient(&v->nearest, g);
  hk_edge_mollifier(v->x, p->limit, gm, M);
  for (int r = 0; r < 12; r++)
    for (int c = 0; c < 12; c++) H[12 * r + c] += v->E1 * (g[r] * gm[c] + gm[r] * g[c]) + v->E * M[12 * r + c];
}

void hk_barrier_hessian(const hk_barrier_pair *p, const hk_barrier_value *v, bool definite, double H[144]) {
  hk_distance_energy_hessian(&v->nearest, v->x, v->m * v->E1, v->m * v->E2, definite, H);
  if (v->m < 1 && !definite) add_mollified(p, v, H);
}

double hk_barrier_load(const hk_barrier_value *v) { return -2 * v->m * v->E1 * sqrt(v->nearest.squared); }
