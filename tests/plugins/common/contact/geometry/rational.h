/* Exact rational arithmetic for references: numbers of GMP from a pool that grows and is used anew (q_reset), vectors
 * of three of them, and the squared distance of a pair of features, from the formulas of textbooks. */
#ifndef HK_RATIONAL_H
#define HK_RATIONAL_H

#include "plugins/common/contact/geometry/distance.h"

#include <gmp.h>
#include <stdlib.h>

typedef mpq_ptr num;

enum { POOL = 1 << 15 };
static mpq_t q_pool[POOL];
static int q_used, q_made;

static inline void q_reset(int to) { q_used = to; }

static inline num q_take(void) {
  if (q_used == POOL) abort();
  if (q_used == q_made) mpq_init(q_pool[q_made++]);
  return q_pool[q_used++];
}

static inline num q(double x) {
  num r = q_take();
  mpq_set_d(r, x);
  return r;
}
static inline num q_add(num a, num b) {
  num r = q_take();
  mpq_add(r, a, b);
  return r;
}
static inline num q_sub(num a, num b) {
  num r = q_take();
  mpq_sub(r, a, b);
  return r;
}
static inline num q_mul(num a, num b) {
  num r = q_take();
  mpq_mul(r, a, b);
  return r;
}
static inline num q_div(num a, num b) {
  num r = q_take();
  mpq_div(r, a, b);
  return r;
}
static inline num q_min(num a, num b) { return mpq_cmp(a, b) < 0 ? a : b; }
static inline num q_half(num a) {
  num r = q_take();
  mpq_div_2exp(r, a, 1);
  return r;
}

typedef struct vec {
  num c[3];
} vec;

static inline vec v_of(const double *x) { return (vec){{q(x[0]), q(x[1]), q(x[2])}}; }
static inline vec v_sub(vec a, vec b) {
  return (vec){{q_sub(a.c[0], b.c[0]), q_sub(a.c[1], b.c[1]), q_sub(a.c[2], b.c[2])}};
}
static inline vec v_add_scaled(vec a, num s, vec b) {
  for (int c = 0; c < 3; c++) a.c[c] = q_add(a.c[c], q_mul(s, b.c[c]));
  return a;
}
static inline num v_dot(vec a, vec b) {
  return q_add(q_mul(a.c[0], b.c[0]), q_add(q_mul(a.c[1], b.c[1]), q_mul(a.c[2], b.c[2])));
}
static inline vec v_cross(vec a, vec b) {
  vec r;
  for (int c = 0; c < 3; c++) {
    int i = (c + 1) % 3, j = (c + 2) % 3;
    r.c[c] = q_sub(q_mul(a.c[i], b.c[j]), q_mul(a.c[j], b.c[i]));
  }
  return r;
}

/* The squared distance of p from the segment a b. */
static inline num q_point_segment(vec p, vec a, vec b) {
  vec e = v_sub(b, a), r = v_sub(p, a);
  num ee = v_dot(e, e), re = v_dot(r, e);
  if (mpq_sgn(ee) == 0 || mpq_sgn(re) <= 0) return v_dot(r, r);
  num s = q_div(re, ee);
  if (mpq_cmp_ui(s, 1, 1) > 0) s = q(1);
  r = v_sub(r, v_add_scaled((vec){{q(0), q(0), q(0)}}, s, e));
  return v_dot(r, r);
}

static inline num q_point_triangle(vec p, vec a, vec b, vec c) {
  vec e = v_sub(b, a), f = v_sub(c, a), r = v_sub(p, a), n = v_cross(e, f);
  num nn = v_dot(n, n);
  if (mpq_sgn(nn) > 0) {
    num wb = q_div(v_dot(v_cross(r, f), n), nn), wc = q_div(v_dot(v_cross(e, r), n), nn), h = v_dot(r, n);
    if (mpq_sgn(wb) >= 0 && mpq_sgn(wc) >= 0 && mpq_cmp_ui(q_add(wb, wc), 1, 1) <= 0) return q_div(q_mul(h, h), nn);
  }
  return q_min(q_point_segment(p, a, b), q_min(q_point_segment(p, b, c), q_point_segment(p, c, a)));
}

static inline num q_edge_edge(vec a, vec b, vec c, vec d) {
  vec u = v_sub(b, a), v = v_sub(d, c), r = v_sub(a, c), n = v_cross(u, v);
  num nn = v_dot(n, n);
  if (mpq_sgn(nn) > 0) {
    num s = q_div(v_dot(v_cross(v, r), n), nn), t = q_div(v_dot(v_cross(u, r), n), nn), h = v_dot(r, n);
    if (mpq_sgn(s) >= 0 && mpq_cmp_ui(s, 1, 1) <= 0 && mpq_sgn(t) >= 0 && mpq_cmp_ui(t, 1, 1) <= 0)
      return q_div(q_mul(h, h), nn);
  }
  num one = q_min(q_point_segment(a, c, d), q_point_segment(b, c, d));
  return q_min(one, q_min(q_point_segment(c, a, b), q_point_segment(d, a, b)));
}

static inline num q_squared_distance(hk_pair_kind kind, const vec x[4]) {
  return kind == HK_POINT_TRIANGLE ? q_point_triangle(x[0], x[1], x[2], x[3]) : q_edge_edge(x[0], x[1], x[2], x[3]);
}

#endif
