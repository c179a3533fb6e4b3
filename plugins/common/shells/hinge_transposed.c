/* Products of hinges for adjoints and tangents, in blocks as the forces have them (hinge_kernel.c). With C = angle -
 * rest, g its gradient, H its Hessian, w = g.u and z = k C + c g.v, u.F = -z w has the derivatives by x  -(k w g + H (z
 * u + c w v)),    by v  -c w g,    by k  -C w,    by c  -(g.v) w,    by rest  k w. Forwards, along dx, dv, dk, dc and
 * dr, F = -z g changes by -(dz g + z H dx), dz = k (g.dx - dr) + dk C + c (g.dv + v.H dx) + dc g.v. H d along a change
 * d of the corners is how g_c = -|e| m/|m|^2, g_d and the feet s and t change with it (hinge.c). All is in differences
 * from a, which gets what balances the others. */
#include "plugins/common/shells/hinge_kernel.h"
#include "plugins/common/shells/hinge_lane.h"

enum { BLOCK = 64 };

typedef struct block {
  double d[3][3][BLOCK], w[3][3][BLOCK], v[3][3][BLOCK]; /* e, p, q, m; differences of u; rates, m/s */
  double k[BLOCK], c[BLOCK], rest[BLOCK], turned[BLOCK];
  double x_to[3][3][BLOCK], v_to[3][3][BLOCK]; /* on b, c, d */
  double by_k[BLOCK], by_c[BLOCK], by_rest[BLOCK];
  double u[3][3][BLOCK], dk[BLOCK], dc[BLOCK], dr[BLOCK]; /* differences of dv, and the changes of the numbers */
} block;

HK_HINGE_INLINE void cross(const double a[3], const double b[3], double to[3]) {
  to[0] = a[1] * b[2] - a[2] * b[1], to[1] = a[2] * b[0] - a[0] * b[2], to[2] = a[0] * b[1] - a[1] * b[0];
}

HK_HINGE_INLINE double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The change of -|e| m/|m|^2. */
HK_HINGE_INLINE void turn_wing(const double m[3], const double dm[3], double one, double length, double dlength,
                               double dg[3]) {
  double along = 2 * dot(m, dm) * one;
  for (int r = 0; r < 3; r++) dg[r] = -(dlength * m[r] + length * (dm[r] - along * m[r])) * one;
}

/* H y, y the changes of b, c and d beside that of a; 0 where a triangle has no area. */
HK_HINGE_INLINE void hessian_product(const hk_hinge_lane *h, const double d[3][3], const double y[3][3],
                                     double to[3][3]) {
  double dm[3], dn[3], part[3], by_ee = 1 / h->ee, by_mm = 1 / h->mm, by_nn = 1 / h->nn, on = h->fine ? 1 : 0;
  cross(y[0], d[1], dm);
  cross(d[0], y[1], part);
  for (int r = 0; r < 3; r++) dm[r] += part[r];
  cross(y[2], d[0], dn);
  cross(d[2], y[0], part);
  for (int r = 0; r < 3; r++) dn[r] += part[r];
  double along = dot(d[0], y[0]), dlength = along / h->length;
  double ds = (dot(y[1], d[0]) + dot(d[1], y[0]) - 2 * h->s * along) * by_ee;
  double dt = (dot(y[2], d[0]) + dot(d[2], y[0]) - 2 * h->t * along) * by_ee;
  turn_wing(h->m, dm, by_mm, h->length, dlength, to[1]);
  turn_wing(h->n, dn, by_nn, h->length, dlength, to[2]);
  for (int r = 0; r < 3; r++) {
    to[1][r] *= on, to[2][r] *= on;
    double feet = h->length * (ds * by_mm * h->m[r] + dt * by_nn * h->n[r]) * on;
    to[0][r] = feet - h->s * to[1][r] - h->t * to[2][r];
  }
}

HK_HINGE_INLINE void load(const double from[3][3][BLOCK], int r, double to[3][3]) {
  for (int m = 0; m < 3; m++)
    for (int c = 0; c < 3; c++) to[m][c] = from[m][c][r];
}

HK_HINGE_INLINE double along(const double g[3][3], const double y[3][3]) {
  return dot(g[0], y[0]) + dot(g[1], y[1]) + dot(g[2], y[2]);
}

/* C and g of a hinge; 0 where a triangle has no area. */
HK_HINGE_INLINE double angle_of(const block *o, const hk_hinge_lane *h, const double last[3], int r, double g[3][3]) {
  double on = h->fine ? -h->length : 0, x = on / h->mm, z = on / h->nn;
  for (int c = 0; c < 3; c++) {
    g[1][c] = x * h->m[c], g[2][c] = z * h->n[c];
    g[0][c] = -h->s * g[1][c] - h->t * g[2][c];
  }
  return h->fine ? hk_hinge_unwrap(hk_hinge_lane_angle(h, last), o->turned[r]) - o->rest[r] : 0;
}

HK_HINGE_INLINE void compute(block *o, bool damped) {
  for (int r = 0; r < BLOCK; r++) {
    double d[3][3], w[3][3], v[3][3] = {{0}}, g[3][3], y[3][3], Hy[3][3], rate = 0;
    load((const double(*)[3][BLOCK])o->d, r, d);
    load((const double(*)[3][BLOCK])o->w, r, w);
    if (damped) load((const double(*)[3][BLOCK])o->v, r, v);
    hk_hinge_lane h = hk_hinge_measure(d[0], d[1], d[2]);
    double C = angle_of(o, &h, d[2], r, g);
    double turn = along((const double(*)[3])g, (const double(*)[3])w), k = o->k[r], moment = k * C, drag = 0;
    if (damped) {
      rate = along((const double(*)[3])g, (const double(*)[3])v);
      drag = o->c[r] * turn, moment += o->c[r] * rate;
    }
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) y[m][c] = moment * w[m][c] + drag * v[m][c];
    hessian_product(&h, (const double(*)[3])d, (const double(*)[3])y, Hy);
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) {
        o->x_to[m][c][r] = -(k * turn * g[m][c] + Hy[m][c]);
        if (damped) o->v_to[m][c][r] = -drag * g[m][c];
      }
    o->by_k[r] = -C * turn, o->by_c[r] = -rate * turn, o->by_rest[r] = k * turn;
  }
}

/* The change of the force on b, c and d, in x_to. */
HK_HINGE_INLINE void change(block *o, bool damped) {
  for (int r = 0; r < BLOCK; r++) {
    double d[3][3], w[3][3], g[3][3], Hw[3][3];
    load((const double(*)[3][BLOCK])o->d, r, d);
    load((const double(*)[3][BLOCK])o->w, r, w);
    hk_hinge_lane h = hk_hinge_measure(d[0], d[1], d[2]);
    double C = angle_of(o, &h, d[2], r, g), k = o->k[r], moment = k * C;
    hessian_product(&h, (const double(*)[3])d, (const double(*)[3])w, Hw);
    double turn = along((const double(*)[3])g, (const double(*)[3])w), dz = k * (turn - o->dr[r]) + o->dk[r] * C;
    if (damped) {
      double v[3][3], u[3][3];
      load((const double(*)[3][BLOCK])o->v, r, v);
      load((const double(*)[3][BLOCK])o->u, r, u);
      double rate = along((const double(*)[3])g, (const double(*)[3])v);
      moment += o->c[r] * rate;
      dz += o->c[r] * (along((const double(*)[3])g, (const double(*)[3])u) +
                       along((const double(*)[3])Hw, (const double(*)[3])v)) +
            o->dc[r] * rate;
    }
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) o->x_to[m][c][r] = -(dz * g[m][c] + moment * Hw[m][c]);
  }
}

HK_VERSIONS(static void, compute_many, (block * o, bool damped), damped ? compute(o, true) : compute(o, false))
HK_VERSIONS(static void, change_many, (block * o, bool damped), damped ? change(o, true) : change(o, false))

/* The differences from a of one array, of hinges from `first` on; lanes beyond get those of the first. */
static void gather(const hk_tuples *node, const double *from, size_t first, size_t count, double into[3][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *member = hk_tuple(node, first + (r < count ? r : 0));
    const double *a = from + 3 * (size_t)member[0];
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) into[m][c][r] = from[3 * (size_t)member[m + 1] + (size_t)c] - a[c];
  }
}

static void scatter(const hk_tuples *node, const double by[3][3][BLOCK], size_t first, size_t count, double *to) {
  for (size_t r = 0; r < count; r++) {
    const uint32_t *member = hk_tuple(node, first + r);
    for (size_t c = 0; c < 3; c++) {
      to[3 * (size_t)member[0] + c] -= by[0][c][r] + by[1][c][r] + by[2][c][r];
      for (size_t m = 0; m < 3; m++) to[3 * (size_t)member[m + 1] + c] += by[m][c][r];
    }
  }
}

static bool take(const hk_bending *b, const double *rest, const double *turned, size_t first, size_t count, block *o) {
  const hk_elements *a = &b->element.acting;
  bool damped = false;
  for (size_t r = 0; r < BLOCK; r++) {
    size_t k = first + (r < count ? r : 0), q = b->number[k];
    o->k[r] = a->stiffness.value[k], o->c[r] = a->damping.value[k];
    o->rest[r] = rest[q], o->turned[r] = turned[q];
    damped = damped || o->c[r] != 0;
  }
  return damped;
}

static void add_slopes(const hk_bending *b, const hk_bending_params *given, const block *o, size_t first, size_t count,
                       double *const *parameter) {
  for (size_t r = 0; r < count; r++) {
    size_t start = b->number[first + r], at = given->hinges.count ? start : 0;
    parameter[HK_BENDING_RIGIDITY][at] += b->per_rigidity[start] * o->by_k[r];
    parameter[HK_BENDING_DAMPING][at] += b->per_rigidity[start] * o->by_c[r];
    parameter[HK_BENDING_REST][at] += o->by_rest[r];
  }
}

void hk_hinge_transposed(const hk_bending *b, const double *rest, const double *turned, const hk_view *view,
                         const hk_bending_params *given, const double *u, const hk_transposed *into) {
  const hk_tuples *node = &b->element.acting.node;
  block o;
  for (size_t k = 0; k < node->count; k += BLOCK) {
    size_t count = node->count - k < BLOCK ? node->count - k : BLOCK;
    bool damped = take(b, rest, turned, k, count, &o) || into->parameter;
    gather(node, view->x, k, count, o.d);
    gather(node, u, k, count, o.w);
    if (damped) gather(node, view->v, k, count, o.v);
    HK_WIDEST(view->host->lanes, compute_many)(&o, damped);
    scatter(node, (const double(*)[3][BLOCK])o.x_to, k, count, into->x);
    if (damped) scatter(node, (const double(*)[3][BLOCK])o.v_to, k, count, into->v);
    if (into->parameter) add_slopes(b, given, &o, k, count, into->parameter);
  }
}

/* ---- along directions ---- */

/* The changes of the stiffness and the damping, which are the parameters times `per`, or of the angle at rest. */
static void take_changes(const hk_bending *b, const hk_bending_params *given, const hk_tangent *t, size_t row,
                         const double *per, size_t first, size_t count, double to[BLOCK]) {
  const double *from = t->parameter ? t->parameter[row] : NULL;
  for (size_t r = 0; r < count; r++) {
    size_t start = b->number[first + r], at = given->hinges.count ? start : 0;
    to[r] = from ? from[at] * (per ? per[start] : 1) : 0;
  }
}

void hk_hinge_along(const hk_bending *b, const double *rest, const double *turned, const hk_view *view,
                    const hk_bending_params *given, const hk_tangent *directions, size_t count_directions) {
  const hk_tuples *node = &b->element.acting.node;
  block o = {.dk = {0}, .dc = {0}, .dr = {0}};
  bool creeps = false;
  for (size_t j = 0; j < count_directions; j++)
    creeps = creeps || (directions[j].parameter && directions[j].parameter[HK_BENDING_DAMPING]);
  for (size_t k = 0; k < node->count; k += BLOCK) {
    size_t count = node->count - k < BLOCK ? node->count - k : BLOCK;
    bool damped = take(b, rest, turned, k, count, &o) || creeps;
    gather(node, view->x, k, count, o.d);
    if (damped) gather(node, view->v, k, count, o.v);
    for (const hk_tangent *t = directions; t < directions + count_directions; t++) {
      gather(node, t->x, k, count, o.w);
      if (damped) gather(node, t->v, k, count, o.u);
      take_changes(b, given, t, HK_BENDING_RIGIDITY, b->per_rigidity, k, count, o.dk);
      take_changes(b, given, t, HK_BENDING_DAMPING, b->per_rigidity, k, count, o.dc);
      take_changes(b, given, t, HK_BENDING_REST, NULL, k, count, o.dr);
      HK_WIDEST(view->host->lanes, change_many)(&o, damped);
      scatter(node, (const double(*)[3][BLOCK])o.x_to, k, count, t->force);
    }
  }
}
