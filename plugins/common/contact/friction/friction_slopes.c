/* See friction.h. */
#include "plugins/common/contact/friction/friction.h"
#include "plugins/common/contact/geometry/nearest_frame.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* Of the nearest points: w, and d, m. */
static void move_nearest(const hk_nearest *near, const double at[12], double w[4][12], double d[3][12]) {
  double c[2][4], along[2][3], by[2][12];
  int count = hk_nearest_directions(near, at, c, along);
  memset(w, 0, 4 * sizeof *w);
  for (int r = 0; r < 3; r++)
    for (int j = 0; j < 12; j++) d[r][j] = j % 3 == r ? near->w[j / 3] : 0;
  if (count == 0) return;
  double g00 = hk_dot(along[0], along[0]), g01 = 0, g11 = 1;
  if (count == 2) g01 = hk_dot(along[0], along[1]), g11 = hk_dot(along[1], along[1]);
  double det = g00 * g11 - g01 * g01;
  for (int j = 0; j < 12; j++) {
    double b[2] = {0};
    for (int k = 0; k < count; k++) b[k] = c[k][j / 3] * near->d[j % 3] + near->w[j / 3] * along[k][j % 3];
    by[0][j] = -(g11 * b[0] - g01 * b[1]) / det;
    by[1][j] = -(g00 * b[1] - g01 * b[0]) / det;
  }
  for (int k = 0; k < count; k++)
    for (int j = 0; j < 12; j++) {
      for (int i = 0; i < 4; i++) w[i][j] += c[k][i] * by[k][j];
      for (int r = 0; r < 3; r++) d[r][j] += along[k][r] * by[k][j];
    }
}

static void move_load(const hk_barrier_pair *p, const hk_barrier_value *v, const double at[12], double load[12]) {
  double size = sqrt(v->nearest.squared), by[12], g[12] = {0};
  hk_distance_gradient(&v->nearest, by);
  if (p->limit > 0) hk_edge_mollifier(at, p->limit, g, NULL);
  for (int j = 0; j < 12; j++)
    load[j] = -2 * (v->m * (v->E2 * size + v->E1 / (2 * size)) * by[j] + v->E1 * size * g[j]);
}

/* u' = W' - n' (n.W) - n (n'.W + n.W'), where W changes by w alone. */
static void move_slip(const hk_nearest *near, const double slip[3], const double way[12], const hk_friction_slopes *s,
                      const double d[3][12], double u[3][12]) {
  hk_pair_frame f = hk_pair_frame_of(near);
  double size = sqrt(near->squared), W[3];
  hk_copy(W, slip);
  for (int i = 0; i < 4; i++) hk_add_scaled(W, f.w[i], way + 3 * i);
  double along = hk_dot(f.n, W);
  for (int j = 0; j < 12; j++) {
    double dn[3] = {d[0][j] / size, d[1][j] / size, d[2][j] / size}, dW[3] = {0};
    hk_add_scaled(dn, -hk_dot(dn, f.n), f.n);
    for (int i = 0; i < 4; i++) hk_add_scaled(dW, s->w[i][j], way + 3 * i);
    double change = hk_dot(dn, W) + hk_dot(f.n, dW);
    for (int r = 0; r < 3; r++) u[r][j] = dW[r] - dn[r] * along - f.n[r] * change;
  }
}

void hk_friction_slopes_of(const hk_barrier_pair *p, const hk_barrier_value *v, const double *x, const double slip[3],
                           const double way[12], hk_friction_slopes *s) {
  double at[12], d[3][12];
  hk_pair_gather(&p->pair, x, at);
  move_nearest(&v->nearest, at, s->w, d);
  move_load(p, v, at, s->load);
  move_slip(&v->nearest, slip, way, s, (const double(*)[12])d, s->u);
}
