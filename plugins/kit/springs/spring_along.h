/* The change of the forces of damped springs along a direction, from the tuples as they are given. With x = x_j - x_i,
 * l = |x|, n = x/l, v = v_j - v_i, and dx, dv, dk, dc and dL the changes, the force on j changes by
 *
 *   -(d(pull) n + pull dn),   pull = k (l - L) + c v.n,   dn = (dx - (n.dx) n)/l,
 *   d(pull) = k (n.dx - dL) + dk (l - L) + c (n.dv + v.dn) + dc v.n.
 *
 * Where l is 0 a spring with L = 0 is k times the identity, and others have no derivative, as in spring_blocks.h.
 *
 * HK_SPRING_BATCH springs at a time are gathered once for all directions, computed in vectors, and added one after the
 * other. */
#ifndef HK_SPRING_ALONG_H
#define HK_SPRING_ALONG_H

#include "plugins/kit/springs/spring_transposed.h"

/* Rows of the force's parameters, by which hk_tangent.parameter has the changes of every tuple. */
typedef struct hk_spring_rows {
  size_t k, c, L;
} hk_spring_rows;

/* `springs` are all tuples, also those that do not act. */
static inline void hk_spring_along(const hk_elements *springs, const hk_view *view, const hk_spring_rows *,
                                   const hk_tangent *directions, size_t count);

/* ---- how ---- */

/* Beside `of`, whose w is dx and whose by_x is the change of the force on i. */
typedef struct hk_spring_changes {
  hk_spring_batch of;
  double u[3][HK_SPRING_BATCH]; /* dv */
  double dk[HK_SPRING_BATCH], dc[HK_SPRING_BATCH], dL[HK_SPRING_BATCH];
} hk_spring_changes;

HK_INLINE void hk_spring_along_each(hk_spring_changes *q) {
  hk_spring_batch *b = &q->of;
  for (size_t e = 0; e < HK_SPRING_BATCH; e++) {
    double x = b->d[0][e], y = b->d[1][e], z = b->d[2][e], wx = b->w[0][e], wy = b->w[1][e], wz = b->w[2][e];
    double vx = b->v[0][e], vy = b->v[1][e], vz = b->v[2][e], k = b->k[e], c = b->c[e], L = b->L[e];
    double ll = x * x + y * y + z * z, some = ll > 0 ? 1. : 0., root = sqrt(some > 0 ? ll : 1);
    double r = some / root, l = some * root, nx = x * r, ny = y * r, nz = z * r;
    double nw = nx * wx + ny * wy + nz * wz, nv = nx * vx + ny * vy + nz * vz;
    double nu = nx * q->u[0][e] + ny * q->u[1][e] + nz * q->u[2][e], turn = r * (vx * wx + vy * wy + vz * wz - nw * nv);
    double limit = L == 0 ? k : 0, pull = (k * (l - L) + c * nv) * r, bend = some > 0 ? pull : limit;
    double more = k * (nw - q->dL[e]) + q->dk[e] * (l - L) + c * (nu + turn) + q->dc[e] * nv, along = bend * nw - more;
    b->by_x[0][e] = bend * wx - along * nx;
    b->by_x[1][e] = bend * wy - along * ny;
    b->by_x[2][e] = bend * wz - along * nz;
  }
}

HK_VERSIONS(static inline void, hk_spring_along_work, (hk_spring_changes * q), hk_spring_along_each(q))

static inline void hk_spring_take_changes(const hk_tangent *t, size_t row, size_t first, size_t count, double *to) {
  const double *from = t->parameter ? t->parameter[row] : NULL;
  if (from)
    memcpy(to, from + first, count * sizeof *to);
  else
    memset(to, 0, count * sizeof *to);
}

/* Where an end is not acted on, nothing changes. */
static inline void hk_spring_leave_others(hk_spring_batch *b, const hk_view *view) {
  for (size_t e = 0; e < b->count; e++)
    if (!hk_edge_acts(view, b->pair[e])) b->by_x[0][e] = b->by_x[1][e] = b->by_x[2][e] = 0;
}

static inline bool hk_spring_any_damped(const hk_elements *s, const hk_spring_rows *rows, const hk_tangent *t,
                                        size_t count) {
  for (size_t j = 0; j < count; j++)
    if (t[j].parameter && t[j].parameter[rows->c]) return true;
  for (size_t e = 0; e < s->damping.count; e++)
    if (s->damping.value[e] > 0) return true;
  return false;
}

static inline void hk_spring_along(const hk_elements *s, const hk_view *view, const hk_spring_rows *rows,
                                   const hk_tangent *t, size_t count) {
  hk_spring_changes q = {.u = {{0}}};
  hk_spring_batch *b = &q.of;
  bool damped = hk_spring_any_damped(s, rows, t, count);
  for (size_t e = 0; e < s->node.count; e += HK_SPRING_BATCH) {
    hk_spring_batch_of(b, s, e);
    hk_spring_gather(b, view->x, b->d);
    if (damped) hk_spring_gather(b, view->v, b->v);
    hk_spring_batch_numbers(&s->stiffness, e, b->count, b->k);
    hk_spring_batch_numbers(&s->damping, e, b->count, b->c);
    hk_spring_batch_numbers(&s->rest, e, b->count, b->L);
    for (size_t j = 0; j < count; j++) {
      hk_spring_gather(b, t[j].x, b->w);
      if (damped) hk_spring_gather(b, t[j].v, q.u);
      hk_spring_take_changes(&t[j], rows->k, e, b->count, q.dk);
      hk_spring_take_changes(&t[j], rows->c, e, b->count, q.dc);
      hk_spring_take_changes(&t[j], rows->L, e, b->count, q.dL);
      HK_WIDEST(view->host->lanes, hk_spring_along_work)(&q);
      if (view->is_active) hk_spring_leave_others(b, view);
      hk_spring_scatter(b, b->by_x, t[j].force);
    }
  }
}

#endif
