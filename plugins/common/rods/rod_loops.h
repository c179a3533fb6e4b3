/* The loops of rod_path.h, with vectors of four on every processor: one with narrower registers takes two for each. The
 * file that includes this one defines TARGET, the attribute of functions with vectors, which each needs: without it
 * compilers take vectors apart before they inline (1.3 times the time); and ROD_PATH, the table.
 *
 * With unit vectors t0, t1 of the edges at a joint, chi = 1 + t0.t1, the curvature binormal is kb = 2 t0 x t1/chi
 * (Bergou and others 2008). It is orthogonal to both edges and the same after parallel transport from one to the other,
 * so its components on directors do not depend on the edge whose directors are taken, but for the twist m = angle1 -
 * angle0 between them. Those of the frame halfway, at (angle0 + angle1)/2, are
 *     k = R(-(angle0 + angle1)/2) (kb.b, -kb.a),     b = t0 x a,
 * and |k| = |kb| for any twist, also of many turns within a joint; the mean of the components on both edges (Bergou and
 * others 2010) is shorter by cos(m/2). The energy of a joint is
 *     1/2 sum_c bend_c (k_c - rest_c)^2 + 1/2 twist (m - rest_twist)^2.
 * With w_c = bend_c (k_c - rest_c) and the vector w = w_1 d_2 - w_2 d_1 on the directors halfway, d_2 = t x d_1, its
 * derivatives with respect to the edges, at angles that are transported with the edges, are
 *     dE/de0 = (-(w.k) s + t1 x W + T kb/2)/|e0|,     dE/de1 = (-(w.k) s - t0 x W + T kb/2)/|e1|,
 * s = (t0 + t1)/chi, W = (2 w - (w.t1) s)/chi with w on the edge before, T = twist (m - rest_twist); and with respect
 * to the angle halfway, w_1 k_2 - w_2 k_1. At the angles of least energy these are the whole derivatives. */
#include "plugins/common/rods/rod_path.h"

#include "core/plugin/widest.h"

#include <math.h>
#include <string.h>

#define INLINE TARGET HK_INLINE

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(32), aligned(8), may_alias));
typedef uint64_t bits __attribute__((vector_size(32), aligned(8), may_alias));

enum { LANES = HK_ROD_LANES, MOST_ITERATIONS = 1000 };

typedef struct place {
  vector x, y, z;
} place;

#define LOAD(p, row) (*(const vector *)((p) + (row)*LANES))
#define STORE(p, row, value) (*(vector *)((p) + (row)*LANES) = (value))

/* All functions with vectors are inlined: how others would hand them over does not matter. */
#pragma GCC diagnostic ignored "-Wpsabi"

#define FILL(a) ((vector){(a), (a), (a), (a)})

INLINE vector root(vector a) { return (vector){sqrt(a[0]), sqrt(a[1]), sqrt(a[2]), sqrt(a[3])}; }
INLINE double sum(vector a) { return (a[0] + a[1]) + (a[2] + a[3]); }
INLINE vector pick(mask m, vector yes, vector no) { return (vector)((mask)no ^ (m & ((mask)yes ^ (mask)no))); }
INLINE vector larger(vector a, vector b) { return pick((mask)(a > b), a, b); }
INLINE vector size_of(vector a) { return larger(a, -a); }
INLINE place load(double *const p[3], size_t row) { return (place){LOAD(p[0], row), LOAD(p[1], row), LOAD(p[2], row)}; }
INLINE void store(double *const p[3], size_t row, place a) {
  STORE(p[0], row, a.x);
  STORE(p[1], row, a.y);
  STORE(p[2], row, a.z);
}
INLINE vector dot(place a, place b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE place plus(place a, place b) { return (place){a.x + b.x, a.y + b.y, a.z + b.z}; }
INLINE place minus(place a, place b) { return (place){a.x - b.x, a.y - b.y, a.z - b.z}; }
INLINE place times(vector s, place a) { return (place){s * a.x, s * a.y, s * a.z}; }
INLINE place cross(place a, place b) {
  return (place){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* sin and cos to 1e-16 or so for |a| < 1e5: the remainder of multiples of pi/2 in three parts, then Taylor's series up
 * to pi/4, whose first terms left out are 4e-19 and 8e-18. */
INLINE void sine_cosine(vector a, vector *sine, vector *cosine) {
  const vector shift = FILL(6755399441055744.); /* 1.5 2^52: adding it rounds to integers */
  vector n = a * FILL(0.63661977236758134308) + shift;
  bits quarter = (bits)n;
  n -= shift;
  vector r = ((a - n * FILL(1.57079632673412561417)) - n * FILL(6.07710050630396597660e-11)) -
             n * FILL(2.02226624879595063154e-21);
  vector q = r * r;
  vector s = FILL(-7.6471637318198164759e-13), c = FILL(4.7794773323873852974e-14);
  s = FILL(1.6059043836821614599e-10) + q * s;
  s = FILL(-2.5052108385441718775e-8) + q * s;
  s = FILL(2.7557319223985890653e-6) + q * s;
  s = FILL(-1.9841269841269841270e-4) + q * s;
  s = FILL(8.3333333333333333333e-3) + q * s;
  s = r + r * q * (FILL(-1.6666666666666666667e-1) + q * s);
  c = FILL(-1.1470745597729724714e-11) + q * c;
  c = FILL(2.0876756987868098979e-9) + q * c;
  c = FILL(-2.7557319223985890653e-7) + q * c;
  c = FILL(2.4801587301587301587e-5) + q * c;
  c = FILL(-1.3888888888888888889e-3) + q * c;
  c = FILL(4.1666666666666666667e-2) + q * c;
  c = 1 - q * FILL(0.5) + q * q * c;
  mask odd = (mask)(-(quarter & 1)), low = (mask)(-(quarter >> 1 & 1)), shifted = (mask)(-((quarter + 1) >> 1 & 1));
  vector sin_of = pick(odd, c, s), cos_of = pick(odd, s, c);
  *sine = pick(low, -sin_of, sin_of);
  *cosine = pick(shifted, -cos_of, cos_of);
}

/* ---- geometry ---- */

TARGET static void gather(const hk_rod_rows *r, const hk_rod_batch *b, const double *x) {
  size_t first = (b->first + b->number) * LANES;
  for (size_t k = first; k < first + (b->edges + 1) * LANES; k++) {
    const double *at = x + 3 * (size_t)r->node[k];
    r->x[0][k] = at[0], r->x[1][k] = at[1], r->x[2][k] = at[2];
  }
}

/* The unit vector of edge k of the batch, and 1/length. */
INLINE place direction(const hk_rod_rows *r, const hk_rod_batch *b, size_t k, vector *inverse) {
  size_t node = b->first + b->number + k;
  place e = minus(load(r->x, node + 1), load(r->x, node));
  vector l2 = dot(e, e);
  mask some = (mask)(l2 > FILL(1e-300));
  *inverse = (vector)(some & (mask)(1 / root(pick(some, l2, FILL(1)))));
  return times(*inverse, e);
}

INLINE vector chi_of(place t0, place t1) { return larger(1 + dot(t0, t1), FILL(HK_ROD_FOLD)); }

INLINE size_t joints_of(const hk_rod_batch *b) { return b->ring ? b->edges : b->edges - 1; }
INLINE size_t after(const hk_rod_batch *b, size_t k) { return k + 1 < b->edges ? k + 1 : 0; }

TARGET static bool sound(const hk_rod_rows *r, const hk_rod_batch *b) {
  vector inverse0, inverse1, bad = FILL(0);
  place t0 = direction(r, b, 0, &inverse0);
  for (size_t k = 0; k < joints_of(b); k++) {
    place t1 = direction(r, b, after(b, k), &inverse1);
    mask poor = ~(mask)(1 + dot(t0, t1) > FILL(HK_ROD_FOLD)), without = ~(mask)(inverse0 * inverse1 > FILL(0));
    vector joint = LOAD(r->bend[0], b->first + k) + LOAD(r->bend[1], b->first + k);
    bad = larger(bad, pick(poor, joint, FILL(0)));
    bad = larger(bad, pick(without, joint, FILL(0)));
    t0 = t1, inverse0 = inverse1;
  }
  return sum(bad) == 0;
}

/* ---- forces from dE/de of the edges: on node k, dE/de_k - dE/de_(k-1) ---- */

typedef struct slopes {
  place last;  /* dE/de of the edge before */
  place carry; /* what the joint before adds to the present one */
} slopes;

/* Joint k, with its dE/de of both edges: completes edge k and the force on node k. */
INLINE void add_joint(const hk_rod_rows *r, size_t node, slopes *s, place D0, place D1) {
  place whole = plus(s->carry, D0);
  store(r->f, node, minus(whole, s->last));
  s->last = whole;
  s->carry = D1;
}

/* After the last joint, which is beyond the last edge of a ring. */
INLINE void finish(const hk_rod_rows *r, const hk_rod_batch *b, const slopes *s) {
  const place none = {FILL(0), FILL(0), FILL(0)};
  size_t node = b->first + b->number, last = node + b->edges;
  if (b->ring) {
    store(r->f, node, plus(load(r->f, node), minus(s->carry, s->last)));
    store(r->f, node + 1, minus(load(r->f, node + 1), s->carry));
    store(r->f, last, none);
  } else {
    store(r->f, last - 1, minus(s->carry, s->last));
    store(r->f, last, minus(none, s->carry));
  }
}

/* ---- straight isotropic rods: E = bend/2 |kb|^2, |kb|^2 = 4 (1 - c)/(1 + c), dE/dc = -4 bend/(1 + c)^2 ---- */

TARGET static double plain(const hk_rod_rows *r, const hk_rod_batch *b) {
  size_t nodes = b->first + b->number;
  vector inverse0, inverse1, energy = FILL(0);
  place t0 = direction(r, b, 0, &inverse0);
  slopes s = {{FILL(0), FILL(0), FILL(0)}, {FILL(0), FILL(0), FILL(0)}};
  for (size_t k = 0; k < joints_of(b); k++) {
    place t1 = direction(r, b, after(b, k), &inverse1);
    vector c = dot(t0, t1), chi = larger(1 + c, FILL(HK_ROD_FOLD));
    vector q = FILL(4) * LOAD(r->bend[0], b->first + k) / (chi * chi);
    energy += FILL(0.5) * q * (1 - c) * chi;
    add_joint(r, nodes + k, &s, times(q * inverse0, minus(times(c, t0), t1)),
              times(q * inverse1, minus(times(c, t1), t0)));
    t0 = t1, inverse0 = inverse1;
  }
  finish(r, b, &s);
  return sum(energy);
}

/* ---- frames ---- */

/* a, orthogonal to t0, transported to t1. */
INLINE place transport(place a, place t0, place t1, vector chi) {
  return minus(a, times(dot(a, t1) / chi, plus(t0, t1)));
}

TARGET static void frames(const hk_rod_rows *r, const hk_rod_batch *b) {
  vector inverse;
  for (size_t k = 0; k < b->edges; k++) {
    store(r->t, b->first + k, direction(r, b, k, &inverse));
    STORE(r->inverse, b->first + k, inverse);
  }
  for (size_t k = 0; k < joints_of(b); k++) {
    size_t row = b->first + k, next = b->first + after(b, k);
    place t0 = load(r->t, row), t1 = load(r->t, next), a = load(r->a, row);
    vector chi = chi_of(t0, t1);
    place kb = times(2 / chi, cross(t0, t1));
    STORE(r->turn[0], row, dot(kb, cross(t0, a)));
    STORE(r->turn[1], row, -dot(kb, a));
    if (next > row) store(r->a, next, transport(a, t0, t1, chi));
  }
}

/* ---- the angles of least energy ---- */

/* A joint at its angles. */
typedef struct joint {
  vector s, c;   /* of the angle halfway */
  vector k[2];   /* curvature on the directors halfway */
  vector w[2];   /* dE/dk */
  vector torque; /* dE/dm */
  vector energy;
} joint;

INLINE joint joint_at(const hk_rod_rows *r, size_t row, size_t next) {
  joint j;
  vector angle0 = LOAD(r->angle, row), angle1 = LOAD(r->angle, next) + LOAD(r->offset, row);
  vector off = angle1 - angle0 - LOAD(r->rest_twist, row), u = LOAD(r->turn[0], row), v = LOAD(r->turn[1], row);
  sine_cosine(FILL(0.5) * (angle0 + angle1), &j.s, &j.c);
  j.k[0] = j.c * u + j.s * v;
  j.k[1] = j.c * v - j.s * u;
  vector d0 = j.k[0] - LOAD(r->rest[0], row), d1 = j.k[1] - LOAD(r->rest[1], row);
  j.w[0] = LOAD(r->bend[0], row) * d0;
  j.w[1] = LOAD(r->bend[1], row) * d1;
  j.torque = LOAD(r->twist, row) * off;
  j.energy = FILL(0.5) * (j.w[0] * d0 + j.w[1] * d1 + j.torque * off);
  return j;
}

/* The equations for the changes of the angles: diagonals in `pivot`, what couples an edge to the next in `lower`, minus
 * the gradient in `right`. Where `stiff` is set, negative curvatures of the bending energy are left out. Returns the
 * largest size of a term of the gradient; *limit: the longest step, 1 rad where bending depends on the angles. */
INLINE vector assemble(const hk_rod_rows *r, const hk_rod_batch *b, mask stiff, vector *limit) {
  vector most = FILL(0), flat = FILL(0), curved = FILL(0), diagonal = FILL(0), gradient = FILL(0), first_diagonal,
         first_gradient;
  for (size_t k = 0; k < b->edges; k++) {
    size_t row = b->first + k, next = b->first + after(b, k);
    vector own = FILL(0), own_gradient = FILL(0), off = FILL(0), to_next = FILL(0), gradient_next = FILL(0);
    if (k < joints_of(b)) {
      joint j = joint_at(r, row, next);
      vector twist = LOAD(r->twist, row), g = FILL(0.5) * (j.w[0] * j.k[1] - j.w[1] * j.k[0]);
      vector whole = LOAD(r->bend[0], row) * j.k[1] * j.k[1] + LOAD(r->bend[1], row) * j.k[0] * j.k[0];
      vector h = whole - (j.w[0] * j.k[0] + j.w[1] * j.k[1]);
      flat = larger(flat, whole), curved = larger(curved, size_of(h));
      h = FILL(0.25) * pick(stiff, larger(h, FILL(0)), h);
      most = larger(most, larger(size_of(j.w[0] * j.k[1]) + size_of(j.w[1] * j.k[0]),
                                 twist * (size_of(LOAD(r->angle, row)) + size_of(LOAD(r->angle, next)) + 1)));
      own = to_next = h + twist;
      off = h - twist;
      own_gradient = g - j.torque;
      gradient_next = g + j.torque;
    }
    mask held = (mask)(LOAD(r->held, row) != 0), next_held = (mask)(LOAD(r->held, next) != 0);
    STORE(r->pivot, row, pick(held, FILL(1), diagonal + own));
    STORE(r->right, row, pick(held, FILL(0), -(gradient + own_gradient)));
    STORE(r->lower, row, pick(held, FILL(0), pick(next_held, FILL(0), off)));
    diagonal = to_next;
    gradient = gradient_next;
  }
  *limit = pick((mask)(curved > FILL(1e-12) * flat), FILL(1), FILL(1e300));
  if (b->ring) {
    mask held = (mask)(LOAD(r->held, b->first) != 0);
    first_diagonal = LOAD(r->pivot, b->first), first_gradient = LOAD(r->right, b->first);
    STORE(r->pivot, b->first, pick(held, first_diagonal, first_diagonal + diagonal));
    STORE(r->right, b->first, pick(held, first_gradient, first_gradient - gradient));
  }
  return most;
}

/* Solves the equations; the changes are in `right`. Of a ring the first edge is left to the end, `column` is what the
 * others answer to it. Returns the lanes in which the matrix is not positive definite. */
INLINE mask eliminate(const hk_rod_rows *r, const hk_rod_batch *b) {
  size_t first = b->first, last = first + b->edges - 1, begin = b->ring ? first + 1 : first;
  mask bad = (mask)FILL(0);
  if (b->ring) {
    for (size_t row = begin; row <= last; row++) STORE(r->column, row, FILL(0));
    STORE(r->column, begin, LOAD(r->lower, first));
    STORE(r->column, last, LOAD(r->lower, last));
  }
  for (size_t row = begin; row <= last; row++) {
    vector pivot = LOAD(r->pivot, row), whole = pivot;
    if (row > begin) {
      vector part = LOAD(r->lower, row - 1) / LOAD(r->pivot, row - 1);
      pivot -= part * LOAD(r->lower, row - 1);
      STORE(r->right, row, LOAD(r->right, row) - part * LOAD(r->right, row - 1));
      if (b->ring) STORE(r->column, row, LOAD(r->column, row) - part * LOAD(r->column, row - 1));
    }
    mask poor = ~(mask)(pivot > FILL(1e-13) * size_of(whole));
    bad |= poor;
    STORE(r->pivot, row, pick(poor, FILL(1e-13) * size_of(whole) + FILL(1e-300), pivot));
  }
  for (size_t row = last + 1; row-- > begin;) {
    vector y = LOAD(r->right, row), z = b->ring ? LOAD(r->column, row) : y;
    if (row < last) {
      y -= LOAD(r->lower, row) * LOAD(r->right, row + 1);
      if (b->ring) z -= LOAD(r->lower, row) * LOAD(r->column, row + 1);
    }
    STORE(r->right, row, y / LOAD(r->pivot, row));
    if (b->ring) STORE(r->column, row, z / LOAD(r->pivot, row));
  }
  if (b->ring) {
    vector to = LOAD(r->lower, first), from = LOAD(r->lower, last), whole = LOAD(r->pivot, first);
    vector pivot = whole - (to * LOAD(r->column, begin) + from * LOAD(r->column, last));
    vector y = LOAD(r->right, first) - (to * LOAD(r->right, begin) + from * LOAD(r->right, last));
    mask poor = ~(mask)(pivot > FILL(1e-13) * size_of(whole));
    bad |= poor;
    y = y / pick(poor, FILL(1e-13) * size_of(whole) + FILL(1e-300), pivot);
    STORE(r->right, first, y);
    for (size_t row = begin; row <= last; row++) STORE(r->right, row, LOAD(r->right, row) - LOAD(r->column, row) * y);
  }
  return bad;
}

/* Newton's method. Convergence is quadratic, so a step of 1e-9 rad is the last. Where the
 * matrix is not positive definite the step is repeated with what is left of it without negative curvatures. */
TARGET static bool solve(const hk_rod_rows *r, const hk_rod_batch *b) {
  const vector zero = FILL(0), one = FILL(1);
  vector active = one, stiff = zero; /* 1 or 0 in each lane */
  for (int iteration = 0; iteration < MOST_ITERATIONS; iteration++) {
    vector limit, most = assemble(r, b, (mask)(stiff > zero), &limit), residual = zero, change = zero;
    for (size_t k = 0; k < b->edges; k++) residual = larger(residual, size_of(LOAD(r->right, b->first + k)));
    active = pick((mask)(residual > FILL(1e-15) * most), active, zero);
    vector repeat = pick(eliminate(r, b), active * (1 - stiff), zero);
    stiff += repeat;
    if (sum(repeat) > 0) continue;
    for (size_t k = 0; k < b->edges; k++) change = larger(change, size_of(LOAD(r->right, b->first + k)));
    vector scale = active * limit / larger(change, limit);
    for (size_t k = 0; k < b->edges; k++) {
      size_t row = b->first + k;
      STORE(r->angle, row, LOAD(r->angle, row) + scale * LOAD(r->right, row));
    }
    vector last = pick((mask)(stiff > zero), FILL(1e-14), FILL(1e-9));
    active = pick((mask)(change > last), active, zero);
    if (sum(active) == 0) return true;
    stiff = zero;
  }
  return false;
}

/* ---- forces ---- */

TARGET static double forces(const hk_rod_rows *r, const hk_rod_batch *b) {
  size_t nodes = b->first + b->number;
  vector energy = FILL(0);
  slopes s = {{FILL(0), FILL(0), FILL(0)}, {FILL(0), FILL(0), FILL(0)}};
  for (size_t k = 0; k < joints_of(b); k++) {
    size_t row = b->first + k, next = b->first + after(b, k);
    joint j = joint_at(r, row, next);
    place t0 = load(r->t, row), t1 = load(r->t, next), a = load(r->a, row);
    vector chi = chi_of(t0, t1), wk = j.w[0] * j.k[0] + j.w[1] * j.k[1];
    place mean = times(1 / chi, plus(t0, t1)), kb = times(j.torque / chi, cross(t0, t1));
    place w = plus(times(-(j.w[0] * j.s + j.w[1] * j.c), a), times(j.w[0] * j.c - j.w[1] * j.s, cross(t0, a)));
    place W = times(1 / chi, minus(times(FILL(2), w), times(dot(w, t1), mean)));
    place both = minus(kb, times(wk, mean));
    energy += j.energy;
    add_joint(r, nodes + k, &s, times(LOAD(r->inverse, row), plus(both, cross(t1, W))),
              times(LOAD(r->inverse, next), minus(both, cross(t0, W))));
  }
  finish(r, b, &s);
  return sum(energy);
}

const hk_rod_path ROD_PATH = {gather, sound, plain, frames, solve, forces};
