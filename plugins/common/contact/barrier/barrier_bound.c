/* See barrier_bound.h. A pair whose energy curves by k along d has u.K u = k |sum w_i n.u_i|^2 <= 2 k sum |w_i|
 * |u_i|^2, because the |w_i| sum to 2. On one side of a surface the areas of the pairs that a particle takes part in,
 * weighted by |w_i|, add up to about four times its own: its own one as a point, as much as a corner of the triangles
 * that points of the other side meet, and twice as much by the crossings of its edges; and there are two sides. */
#include "plugins/common/contact/barrier/barrier_bound.h"
#include "plugins/common/contact/barrier/barrier_function.h"

static const double compressed = 0.1, areas = 8;

/* The least u of all pairs, at most `compressed`. */
static double least_part(const hk_barrier_contacts *c) {
  const hk_barrier_pair *near = c->near.item;
  double least = compressed, D = c->law.distance;
  for (size_t k = 0; k < c->found; k++) {
    double xi = near[k].pair.offset, u = near[k].pair.gap * (near[k].pair.gap + 2 * xi) / (D * (D + 2 * xi));
    if (u > 0) least = fmin(least, u);
  }
  return least;
}

/* N/m per m^2: d^2E/dd^2 = kappa D (b'' (2 d/S)^2 + 2 b'/S), of which the second part is negative, and the first one
 * largest for surfaces without thickness, (2 d/S)^2 = 4 u/D^2, or with a large one, 1/D^2. */
static double curvature(const hk_barrier_law *law, double u) {
  return law->stiffness / law->distance * hk_barrier_at(u).curvature * fmax(1, 4 * u);
}

static void add(double block[6], double k) { block[0] += k, block[3] += k, block[5] += k; }

void hk_barrier_bound(hk_barrier_contacts *c, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const hk_surface_mesh *mesh = c->surfaces->mesh(c->surfaces->self);
  const hk_barrier_shape *shape = (const hk_barrier_shape *)(const void *)c->shape;
  double k = 2 * areas * curvature(&c->law, least_part(c));
  for (size_t q = 0; q < mesh->points && part != HK_DAMPING_WHOLE; q++) {
    uint32_t i = mesh->point[q];
    if (!view->is_active || view->is_active[i]) add(block[i], k * shape[i].area);
  }
}
