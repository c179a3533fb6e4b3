/* See barrier_pair.h. Derivatives are those of E(d^2) by the chain rule, with the exact ones of d^2 (distance.h). */
#include "plugins/common/contact/barrier/barrier_pair.h"
#include "plugins/common/contact/barrier/barrier_function.h"

/* The axis separates the two features by the distance of their nearest points where it was taken, and by no more than
 * their distance anywhere. */
bool hk_barrier_is_apart(const hk_barrier_pair *p, const hk_barrier_law *law, const double *x) {
  double at[4];
  for (size_t a = 0; a < 4; a++) {
    const double *y = x + 3 * (size_t)p->pair.vertex[a];
    at[a] = p->axis[0] * y[0] + p->axis[1] * y[1] + p->axis[2] * y[2];
  }
  bool point = p->pair.kind == HK_POINT_TRIANGLE;
  double first = point ? at[0] : fmin(at[0], at[1]), second = fmax(at[2], at[3]);
  if (point) second = fmax(at[1], second);
  return first - second > law->distance + p->pair.offset;
}

bool hk_barrier_evaluate(const hk_barrier_pair *p, const hk_barrier_law *law, const double *x, hk_barrier_value *v) {
  double xi = p->pair.offset, D = law->distance, whole = D * (D + 2 * xi), at[12];
  hk_pair_gather(&p->pair, x, at);
  v->nearest = hk_nearest_of_pair(p->pair.kind, at);
  double d = sqrt(v->nearest.squared), s = (d - xi) * (d + xi), u = s / whole, energy = law->stiffness * p->area * D;
  v->gap = d - xi;
  if (!(u < 1)) return false;
  v->m = p->limit > 0 ? hk_edge_mollifier(at, p->limit, NULL, NULL) : 1;
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

void hk_barrier_gradient(const hk_barrier_pair *p, const hk_barrier_value *v, const double *x, double g[12]) {
  double at[12], gm[12];
  hk_distance_gradient(&v->nearest, g);
  for (int e = 0; e < 12; e++) g[e] *= v->m * v->E1;
  if (!(v->m < 1)) return;
  hk_pair_gather(&p->pair, x, at);
  hk_edge_mollifier(at, p->limit, gm, NULL);
  for (int e = 0; e < 12; e++) g[e] += v->E * gm[e];
}

double hk_barrier_load(const hk_barrier_value *v) { return -2 * v->m * v->E1 * sqrt(v->nearest.squared); }
