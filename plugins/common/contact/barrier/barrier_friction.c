/* See barrier_friction.h. */
#include "plugins/common/contact/barrier/barrier_friction.h"
#include "plugins/common/contact/geometry/nearest_frame.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* A contact that rubs. */
typedef struct rub {
  const hk_barrier_pair *pair;
  const hk_barrier_value *value;
  hk_pair_frame frame;
  double load;         /* l, N */
  double u[3], size;   /* m/s, the velocity across the normal */
  double ratio, slope; /* N s/m: mu l f/|u|, and the derivative of mu l f by |u| */
} rub;

/* The velocity across the normal. */
static void find_slip(rub *r, const double *v) {
  double along = 0;
  for (size_t c = 0; c < 3; c++) {
    r->u[c] = 0;
    for (int a = 0; a < 4; a++) r->u[c] += r->frame.w[a] * v[3 * (size_t)r->pair->pair.vertex[a] + c];
  }
  along = hk_dot(r->u, r->frame.n);
  hk_add_scaled(r->u, -along, r->frame.n);
  r->size = hk_length(r->u);
}

static rub rub_of(const hk_barrier_friction *f, const hk_barrier_contacts *c, size_t k, const double *v) {
  const hk_barrier_value *value = hk_barrier_acting(c, k);
  rub r = {.pair = (const hk_barrier_pair *)c->near.item + value->near, .value = value};
  r.frame = hk_pair_frame_of(&value->nearest);
  r.load = hk_barrier_load(value);
  find_slip(&r, v);
  double y = r.size / f->speed, most = f->coefficient * r.load;
  r.ratio = most * (y < 1 ? (2 - y) / f->speed : 1 / r.size);
  r.slope = y < 1 ? 2 * most * (1 - y) / f->speed : 0;
  return r;
}

static size_t rubbing(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view) {
  if (!(f->coefficient > 0)) return 0;
  hk_barrier_values_at(c, view);
  return c->acting_count;
}

double hk_friction_add(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view, double *F) {
  size_t count = rubbing(f, c, view);
  double power = 0;
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view->v);
    for (int a = 0; a < 4; a++) hk_add_scaled(F + 3 * (size_t)r.pair->pair.vertex[a], -r.ratio * r.frame.w[a], r.u);
    power -= r.ratio * r.size * r.size;
  }
  return power;
}

double hk_friction_power(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view) {
  size_t count = rubbing(f, c, view);
  double power = 0;
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view->v);
    power -= r.ratio * r.size * r.size;
  }
  return power;
}

/* ---- slopes ---- */

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
static void move_slip(const hk_nearest *near, const double v[12], const hk_friction_slopes *s, const double d[3][12],
                      double u[3][12]) {
  hk_pair_frame f = hk_pair_frame_of(near);
  double size = sqrt(near->squared), W[3] = {0};
  for (int i = 0; i < 4; i++) hk_add_scaled(W, f.w[i], v + 3 * i);
  double along = hk_dot(f.n, W);
  for (int j = 0; j < 12; j++) {
    double dn[3] = {d[0][j] / size, d[1][j] / size, d[2][j] / size}, dW[3] = {0};
    hk_add_scaled(dn, -hk_dot(dn, f.n), f.n);
    for (int i = 0; i < 4; i++) hk_add_scaled(dW, s->w[i][j], v + 3 * i);
    double change = hk_dot(dn, W) + hk_dot(f.n, dW);
    for (int r = 0; r < 3; r++) u[r][j] = dW[r] - dn[r] * along - f.n[r] * change;
  }
}

void hk_friction_slopes_of(const hk_barrier_pair *p, const hk_barrier_value *v, const hk_view *view,
                           hk_friction_slopes *s) {
  double at[12], speed[12], d[3][12];
  hk_pair_gather(&p->pair, view->x, at);
  hk_pair_gather(&p->pair, view->v, speed);
  move_nearest(&v->nearest, at, s->w, d);
  move_load(p, v, at, s->load);
  move_slip(&v->nearest, speed, s, (const double(*)[12])d, s->u);
}

/* ---- blocks ---- */

/* -dF/dv: r (P - e e^T) + s e e^T, P the projection across the normal, e = u/|u|, s the slope of the force. */
static void add_damping(const rub *r, const size_t *slot, double *to) {
  double D[9];
  for (int p = 0; p < 9; p++) {
    double ee = r->size > 0 ? r->u[p / 3] * r->u[p % 3] / (r->size * r->size) : 0;
    D[p] = r->ratio * ((p % 4 == 0) - r->frame.n[p / 3] * r->frame.n[p % 3] - ee) + r->slope * ee;
  }
  for (size_t b = 0; b < 16; b++)
    for (size_t p = 0; p < 9; p++) to[9 * slot[b] + p] += r->frame.w[b / 4] * r->frame.w[b % 4] * D[p];
}

/* -dF_i/dx = w_i' ratio u + w_i (ratio/l) u l' + w_i (ratio (I - e e^T) + slope e e^T) u'. */
static void add_turning(const rub *r, const hk_friction_slopes *d, const size_t *slot, double *to) {
  double part = r->load > 0 ? r->ratio / r->load : 0, more = r->slope - r->ratio;
  for (int j = 0; j < 12; j++) {
    double du[3] = {d->u[0][j], d->u[1][j], d->u[2][j]};
    double along = r->size > 0 ? hk_dot(r->u, du) / (r->size * r->size) : 0;
    for (int e = 0; e < 12; e++) {
      int i = e / 3, a = e % 3;
      double by = d->w[i][j] * r->ratio * r->u[a] +
                  r->frame.w[i] * (part * d->load[j] * r->u[a] + r->ratio * du[a] + more * along * r->u[a]);
      to[9 * slot[4 * i + j / 3] + 3 * (size_t)a + (size_t)(j % 3)] += by;
    }
  }
}

void hk_friction_blocks(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view,
                        const hk_blocks *into) {
  size_t count = rubbing(f, c, view);
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view->v);
    const size_t *slot = into->slot + 16 * (size_t)r.pair->name;
    if (into->want & HK_WANT_DEFINITE) r.slope = r.ratio;
    add_damping(&r, slot, into->D);
    if (into->want & (HK_WANT_SYMMETRIC | HK_WANT_DEFINITE)) continue;
    hk_friction_slopes slopes;
    hk_friction_slopes_of(r.pair, r.value, view, &slopes);
    add_turning(&r, &slopes, slot, into->K);
  }
}
