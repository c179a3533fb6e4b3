/* The derivatives of a bilinear form of the blocks of damped springs (facets/implicit.h, spring_blocks.h). With x = x_j
 * - x_i, l = |x|, r = 1/l, n = r x, U = v_j - v_i, m = u_j - u_i and w likewise, P = n.m and Q = n.w, a spring has
 *
 *   f = by_x ((k - b) P Q + b m.w + c r P (U.w - (U.n) Q)) + by_v c P Q,   b = k (s - L) r + c r U.n,
 *
 * without the third term where blocks are symmetric, and with b = 0 where it is negative and blocks are definite. s is
 * l, or what was foretold: e.z with z = x_j - x_i of the positions that were reached, y likewise of those of the
 * linearisation, and e = y/|y|. With B = by_x (m.w - P Q), the derivative by b, and
 *
 *   N = (by_x ((k - b) Q + c r (U.w - (U.n) Q)) + by_v c Q) m + (by_x ((k - b) P - c r P U.n) + by_v c P) w
 *       + (B c r - by_x c r P Q) U
 *
 * that by n, f changes with x by r (N - (n.N) n) - r^2 (B (k (s - L) + c U.n) + by_x c P (U.w - (U.n) Q)) n and, where
 * s is l, B r k n; with U by B c r n + by_x c r P (w - Q n); with z by B r k e, with y by B r k (z - s e)/|y|. */
#ifndef HK_SPRING_BILINEAR_H
#define HK_SPRING_BILINEAR_H

#include "plugins/kit/springs/spring_transposed.h"

/* Adds to into->x and into->v, to those by the positions of the form, and to the slopes. `springs` are all tuples, also
 * those that do not act. */
static inline void hk_spring_bilinear(const hk_elements *springs, const hk_view *view, const hk_bilinear *form,
                                      const hk_transposed *into, const hk_spring_slopes *slopes);

/* ---- how ---- */

static inline double hk_spring_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The derivatives of one spring's form. */
typedef struct hk_spring_form {
  double k, c, L;
  double m[3], w[3], U[3];          /* of the vectors and of the velocities */
  double e[3], stretched, foretold; /* y/|y|, s - L, 1/|y|; foretold 0: s is l */
  double by_x[3], by_v[3], by_k, by_c, by_L, by_z[3], by_y[3];
} hk_spring_form;

/* s of what was foretold, and what remains of z. */
static inline void hk_spring_foretell(const hk_bilinear *form, const uint32_t pair[2], hk_spring_form *f, double z[3]) {
  double y[3], length = hk_edge_difference(form->linearised, pair, y);
  hk_edge_difference(form->reached, pair, z);
  f->foretold = length > 0 ? 1 / length : 0;
  for (int a = 0; a < 3; a++) f->e[a] = f->foretold * y[a];
  double along = hk_spring_dot(f->e, z);
  f->stretched = length > 0 ? along - f->L : 0;
  for (int a = 0; a < 3; a++) z[a] -= along * f->e[a];
}

/* The vector N, which by_x begins as, and the derivative by r. */
static inline double hk_spring_turn(const hk_bilinear *form, hk_spring_form *f, const double n[3], double r, double b,
                                    double by_b, double turning) {
  double P = hk_spring_dot(n, f->m), Q = hk_spring_dot(n, f->w), un = hk_spring_dot(n, f->U);
  double apart = hk_spring_dot(f->U, f->w) - un * Q, cr = turning * f->c * r, x = form->by_x, along = form->by_v * f->c;
  double of_m = x * ((f->k - b) * Q + cr * apart) + along * Q, of_w = x * ((f->k - b) * P - cr * P * un) + along * P;
  double of_U = by_b * f->c * r - x * cr * P * Q;
  for (int a = 0; a < 3; a++) {
    f->by_x[a] = of_m * f->m[a] + of_w * f->w[a] + of_U * f->U[a];
    f->by_v[a] = by_b * f->c * r * n[a] + x * cr * P * (f->w[a] - Q * n[a]);
  }
  f->by_c = by_b * r * un + x * turning * r * P * apart + form->by_v * P * Q;
  f->by_k = x * P * Q + by_b * r * f->stretched;
  return by_b * (f->k * f->stretched + f->c * un) + x * turning * f->c * P * apart;
}

static inline void hk_spring_form_of(const hk_bilinear *form, const uint32_t pair[2], const double *x,
                                     hk_spring_form *f) {
  double n[3], z[3] = {0}, l = hk_edge_difference(x, pair, n), mw = hk_spring_dot(f->m, f->w);
  bool foretold = form->linearised != NULL;
  if (!(l > 0)) { /* k times the identity, where L is 0 */
    f->by_k = f->L == 0 ? form->by_x * mw : 0;
    return;
  }
  double r = 1 / l;
  for (int a = 0; a < 3; a++) n[a] *= r;
  f->stretched = l - f->L;
  if (foretold) hk_spring_foretell(form, pair, f, z);
  double b = r * (f->k * f->stretched + f->c * hk_spring_dot(n, f->U));
  bool none = b < 0 && form->want & HK_WANT_DEFINITE;
  double by_b = none ? 0 : form->by_x * (mw - hk_spring_dot(n, f->m) * hk_spring_dot(n, f->w)), by_s = by_b * r * f->k;
  double by_r = hk_spring_turn(form, f, n, r, none ? 0 : b, by_b, form->want & HK_WANT_SYMMETRIC ? 0 : 1);
  double along = hk_spring_dot(n, f->by_x);
  for (int a = 0; a < 3; a++) {
    f->by_x[a] = r * (f->by_x[a] - along * n[a]) - r * r * by_r * n[a] + (foretold ? 0 : by_s * n[a]);
    f->by_z[a] = by_s * f->e[a];
    f->by_y[a] = by_s * f->foretold * z[a];
  }
  f->by_L = foretold && !(f->foretold > 0) ? 0 : -by_s;
}

static inline void hk_spring_spread(const double by[3], const uint32_t pair[2], double *to) {
  for (size_t a = 0; a < 3; a++) {
    to[3 * (size_t)pair[1] + a] += by[a];
    to[3 * (size_t)pair[0] + a] -= by[a];
  }
}

static inline void hk_spring_bilinear(const hk_elements *s, const hk_view *view, const hk_bilinear *form,
                                      const hk_transposed *into, const hk_spring_slopes *slopes) {
  for (size_t e = 0; e < s->node.count; e++) {
    const uint32_t *pair = hk_pairs(&s->node)[e];
    if (!hk_edge_acts(view, pair)) continue;
    hk_spring_form f = {
        .k = hk_tuple_value(&s->stiffness, e), .c = hk_tuple_value(&s->damping, e), .L = hk_tuple_value(&s->rest, e)};
    hk_edge_difference(form->u, pair, f.m);
    hk_edge_difference(form->w, pair, f.w);
    hk_edge_difference(view->v, pair, f.U);
    hk_spring_form_of(form, pair, view->x, &f);
    hk_spring_spread(f.by_x, pair, into->x);
    hk_spring_spread(f.by_v, pair, into->v);
    if (form->linearised) {
      hk_spring_spread(f.by_y, pair, form->by_linearised);
      hk_spring_spread(f.by_z, pair, form->by_reached);
    }
    if (slopes->k) slopes->k[e] += f.by_k;
    if (slopes->c) slopes->c[e] += f.by_c;
    if (slopes->L) slopes->L[e] += f.by_L;
  }
}

#endif
