/* Products of the transposed Jacobian of damped springs with a vector u, and derivatives by their coefficients, from
 * the tuples as they are given. With x = x_j - x_i, l = |x|, n = x/l, v = v_j - v_i and w = u_j - u_i, the force on j
 * is
 *
 *   f = -(k (l - L) + c v.n) n,   u.F = w.f,
 *
 * and (spring_blocks.h) with b = k (1 - L/l) + (c/l) v.n
 *
 *   d(w.f)/dx = -((k - b) (n.w) n + b w + (c/l) (n.w) (v - (v.n) n)),
 *   d(w.f)/dv = -c (n.w) n,
 *   d(w.f)/dk = -(l - L) n.w,   d(w.f)/dc = -(v.n) n.w,   d(w.f)/dL = k n.w.
 *
 * Where l is 0 a spring with L = 0 is k times the identity, and others have no derivative, as in spring_blocks.h.
 *
 * HK_SPRING_BATCH springs at a time are gathered, computed in vectors, and added one after the other. */
#ifndef HK_SPRING_TRANSPOSED_H
#define HK_SPRING_TRANSPOSED_H

#include "plugins/kit/springs/edge.h"

#include <string.h>

enum { HK_SPRING_BATCH = 64 };

/* The derivatives by the coefficients of every tuple; NULL: not wanted. */
typedef struct hk_spring_slopes {
  double *k, *c, *L;
} hk_spring_slopes;

/* Adds to into->x and into->v, and to the slopes. `springs` are all tuples, also those that do not act. */
static inline void hk_spring_transposed(const hk_elements *springs, const hk_view *view, const double *u,
                                        const hk_transposed *into, const hk_spring_slopes *slopes);

/* ---- how ---- */

typedef struct hk_spring_batch {
  const uint32_t (*pair)[2];
  size_t count;
  size_t i[HK_SPRING_BATCH], j[HK_SPRING_BATCH]; /* where the ends are in x */
  double d[3][HK_SPRING_BATCH], w[3][HK_SPRING_BATCH], v[3][HK_SPRING_BATCH];
  double k[HK_SPRING_BATCH], c[HK_SPRING_BATCH], L[HK_SPRING_BATCH];
  double by_x[3][HK_SPRING_BATCH], by_v[3][HK_SPRING_BATCH];
  double by_k[HK_SPRING_BATCH], by_c[HK_SPRING_BATCH], by_L[HK_SPRING_BATCH];
} hk_spring_batch;

static inline void hk_spring_batch_of(hk_spring_batch *b, const hk_elements *s, size_t first) {
  b->pair = hk_pairs(&s->node) + first;
  b->count = s->node.count - first < HK_SPRING_BATCH ? s->node.count - first : HK_SPRING_BATCH;
  for (size_t e = 0; e < b->count; e++) b->i[e] = 3 * (size_t)b->pair[e][0], b->j[e] = 3 * (size_t)b->pair[e][1];
}

static inline void hk_spring_gather(const hk_spring_batch *b, const double *restrict x,
                                    double (*restrict to)[HK_SPRING_BATCH]) {
  const size_t count = b->count;
  for (size_t e = 0; e < count; e++) {
    const double *i = x + b->i[e], *j = x + b->j[e];
    double first = j[0] - i[0], second = j[1] - i[1], third = j[2] - i[2];
    to[0][e] = first, to[1][e] = second, to[2][e] = third;
  }
}

/* Where an end is not acted on, w is 0, and with it all that is added. */
static inline void hk_spring_drop_others(hk_spring_batch *b, const hk_view *view) {
  for (size_t e = 0; e < b->count; e++)
    if (!hk_edge_acts(view, b->pair[e])) b->w[0][e] = b->w[1][e] = b->w[2][e] = 0;
}

static inline void hk_spring_scatter(const hk_spring_batch *b, double (*restrict by)[HK_SPRING_BATCH],
                                     double *restrict to) {
  const size_t count = b->count;
  for (size_t e = 0; e < count; e++) {
    double *i = to + b->i[e], *j = to + b->j[e], first = by[0][e], second = by[1][e], third = by[2][e];
    j[0] -= first, j[1] -= second, j[2] -= third;
    i[0] += first, i[1] += second, i[2] += third;
  }
}

static inline void hk_spring_batch_numbers(const hk_per_tuple *from, size_t first, size_t count, double *to) {
  if (from->count > 1)
    memcpy(to, from->value + first, count * sizeof *to);
  else
    for (size_t e = 0; e < count; e++) to[e] = hk_tuple_value(from, 0);
}

HK_INLINE void hk_spring_batch_each(hk_spring_batch *b) {
  for (size_t e = 0; e < HK_SPRING_BATCH; e++) {
    double x = b->d[0][e], y = b->d[1][e], z = b->d[2][e], wx = b->w[0][e], wy = b->w[1][e], wz = b->w[2][e];
    double vx = b->v[0][e], vy = b->v[1][e], vz = b->v[2][e], k = b->k[e], c = b->c[e], L = b->L[e];
    double ll = x * x + y * y + z * z, some = ll > 0 ? 1. : 0., root = sqrt(some > 0 ? ll : 1);
    double r = some / root, l = some * root;
    double nx = x * r, ny = y * r, nz = z * r, nw = nx * wx + ny * wy + nz * wz, nv = nx * vx + ny * vy + nz * vz;
    double limit = L == 0 ? k : 0, away = k * (1 - L * r) + c * r * nv, bend = some > 0 ? away : limit;
    double turn = c * r * nw, along = (k - bend) * nw - turn * nv, damp = c * nw;
    b->by_x[0][e] = along * nx + bend * wx + turn * vx;
    b->by_x[1][e] = along * ny + bend * wy + turn * vy;
    b->by_x[2][e] = along * nz + bend * wz + turn * vz;
    b->by_v[0][e] = damp * nx;
    b->by_v[1][e] = damp * ny;
    b->by_v[2][e] = damp * nz;
    b->by_k[e] = -(l - L) * nw;
    b->by_c[e] = -nv * nw;
    b->by_L[e] = k * nw;
  }
}

HK_VERSIONS(static inline void, hk_spring_batch_work, (hk_spring_batch * b), hk_spring_batch_each(b))

static inline void hk_spring_batch_add(const double *from, size_t count, double *to) {
  for (size_t e = 0; e < count; e++) to[e] += from[e];
}

static inline void hk_spring_transposed(const hk_elements *s, const hk_view *view, const double *u,
                                        const hk_transposed *into, const hk_spring_slopes *slopes) {
  hk_spring_batch b = {0};
  bool damped = slopes->c != NULL;
  for (size_t e = 0; e < s->damping.count && !damped; e++) damped = s->damping.value[e] > 0;
  for (size_t e = 0; e < s->node.count; e += HK_SPRING_BATCH) {
    hk_spring_batch_of(&b, s, e);
    hk_spring_gather(&b, view->x, b.d);
    hk_spring_gather(&b, u, b.w);
    if (view->is_active) hk_spring_drop_others(&b, view);
    if (damped) hk_spring_gather(&b, view->v, b.v);
    hk_spring_batch_numbers(&s->stiffness, e, b.count, b.k);
    hk_spring_batch_numbers(&s->damping, e, b.count, b.c);
    hk_spring_batch_numbers(&s->rest, e, b.count, b.L);
    HK_WIDEST(view->host->lanes, hk_spring_batch_work)(&b);
    hk_spring_scatter(&b, b.by_x, into->x);
    if (damped) hk_spring_scatter(&b, b.by_v, into->v);
    if (slopes->k) hk_spring_batch_add(b.by_k, b.count, slopes->k + e);
    if (slopes->c) hk_spring_batch_add(b.by_c, b.count, slopes->c + e);
    if (slopes->L) hk_spring_batch_add(b.by_L, b.count, slopes->L + e);
  }
}

#endif
