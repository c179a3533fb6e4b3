/* Continuous collision by directions that separate.
 *
 * The differences r_k of the corners of the two features (three for a point and a triangle, four for two edges) move
 * linearly, and the features are as far apart as the hull of the r_k is from the origin. So a vector n proves that they
 * are further apart than the gap from t to t' if n.r_k > gap |n| at t and at t', for all k: n.r_k is linear in between.
 * The difference of the nearest points at t is the best n there. It proves the time up to the first root of n.r_k(t') =
 * gap |n|, and at this t' the next one goes on: the additive advance of Li, Kaufman and Jiang 2021 ("Codimensional
 * incremental potential contact", section 5), with the speeds along n in place of the lengths of relative
 * displacements, and with a proof of each step in place of trust in the distance.
 *
 * Where features turn while they stay close such steps are as short as their distance. Then an interval is tried with a
 * vector that goes linearly from n at t to n' at t'. n(s).r_k(s) is quadratic in s, and greater than its least
 * Bernstein coefficient, an inclusion function in the sense of Snyder 1992 and of Wang and others 2021 ("A large-scale
 * benchmark and an inclusion-based algorithm for continuous collision detection"); intervals that it does not prove are
 * bisected.
 *
 * Rounding: all is scaled by a power of 2 so that the largest coordinate of r_k is between 1/2 and 1. With u = 2^-53
 * and |n|_1 = sum |n_c| a coordinate of r_k is off by u, at a time within [0, 1] by 4 u; n.r_k by |n|_1 (4 + 3) u, its
 * value between the ends of time by 3 |n|_1 u more; gap |n|, where it is not a hit at once, by 8 |n|_1 u. A proof keeps
 * a margin of 32 |n|_1 u. */
#include "plugins/common/collision/ccd.h"
#include "plugins/common/space/vector3.h"

static const double MARGIN = 32 * 0x1p-53;
/* Where a hit is so near to the gap that the margin leaves nothing to prove: |n|_1 is at most sqrt(3) |n|. */
static const double NEAREST = 100 * 0x1p-53;
/* Steps after which intervals are tried as well; most pairs need no more than two. */
enum { PLAIN_STEPS = 4, MOST_STEPS = 1000 };

typedef struct motion {
  hk_pair_kind kind;
  int count;
  double r[2][4][3]; /* at both ends of time, scaled */
  double gap, near;  /* scaled; a distance up to `near` is a hit */
} motion;

typedef struct direction {
  double n[3];   /* largest coordinate: 1 */
  double margin; /* to be exceeded by n.r_k */
  double distance;
} direction;

/* ---- Differences of corners -------------------------------------------------------------------------------------- */

static void difference_at(hk_pair_kind kind, const double *x, double r[4][3]) {
  for (int k = 0; k < (kind == HK_POINT_TRIANGLE ? 3 : 4); k++)
    if (kind == HK_POINT_TRIANGLE)
      hk_subtract(r[k], x, x + 3 * (k + 1));
    else
      hk_subtract(r[k], x + 3 * (k % 2), x + 3 * (2 + k / 2));
}

static double largest(const motion *m) {
  double most = 0;
  for (int k = 0; k < 6 * m->count; k++) {
    double a = fabs(m->r[k / (3 * m->count)][k / 3 % m->count][k % 3]);
    if (!(a <= most)) most = a; /* keeps what is not a number */
  }
  return most;
}

static void multiply(motion *m, double s) {
  for (int k = 0; k < 24; k++) m->r[k / 12][k / 3 % 4][k % 3] *= s;
  m->gap *= s, m->near *= s;
}

/* Whether there is something to scale: not if all is 0, or not finite. A power of 2 that is itself in range may not be
 * enough at once. */
static bool scale(motion *m) {
  for (;;) {
    int e;
    double most = largest(m);
    if (!(most > 0 && isfinite(most))) return false;
    frexp(most, &e);
    if (e == 0) return true;
    multiply(m, ldexp(1, e > 1000 ? -1000 : e < -1000 ? 1000 : -e));
  }
}

static void at_time(const motion *m, double t, double r[4][3]) {
  for (int k = 0; k < m->count; k++)
    for (int c = 0; c < 3; c++) r[k][c] = (1 - t) * m->r[0][k][c] + t * m->r[1][k][c];
}

/* ---- Directions -------------------------------------------------------------------------------------------------- */

/* The pair whose differences of corners are r, with a corner of the second feature, or the point, at the origin. */
static void pair_of(hk_pair_kind kind, double r[4][3], double x[12]) {
  for (int c = 0; c < 3; c++)
    if (kind == HK_POINT_TRIANGLE) {
      x[c] = 0, x[3 + c] = -r[0][c], x[6 + c] = -r[1][c], x[9 + c] = -r[2][c];
    } else {
      x[c] = r[0][c], x[3 + c] = r[1][c], x[6 + c] = 0, x[9 + c] = r[0][c] - r[2][c];
    }
}

/* Makes the largest coordinate 1. */
static void normalize(double n[3]) {
  double most = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
  for (int c = 0; c < 3; c++) n[c] = most > 0 ? n[c] / most : 0;
}

/* d is at right angles to the edges of the active parts; of a small distance rounding tilts it against them. */
static void straighten(const hk_nearest *near, const double x[12], double n[3]) {
  double dw[2][4], e[2][3], m[3];
  int count = hk_nearest_directions(near, x, dw, e);
  if (count == 2) {
    hk_cross(m, e[0], e[1]);
    double sign = hk_dot(m, n) < 0 ? -1 : 1;
    for (int c = 0; c < 3; c++) n[c] = sign * m[c];
  } else if (count == 1) {
    hk_add_scaled(n, -hk_dot(n, e[0]) / hk_dot(e[0], e[0]), e[0]);
  }
}

static direction direction_at(const motion *m, double t, double r[4][3]) {
  double x[12];
  at_time(m, t, r);
  pair_of(m->kind, r, x);
  hk_nearest near = hk_nearest_of_pair(m->kind, x);
  direction d = {.n = {near.d[0], near.d[1], near.d[2]}, .distance = sqrt(near.squared)};
  normalize(d.n);
  straighten(&near, x, d.n);
  normalize(d.n);
  d.margin = m->gap * hk_length(d.n) + MARGIN * (fabs(d.n[0]) + fabs(d.n[1]) + fabs(d.n[2]));
  return d;
}

static double value(double at0, double at1, double t) { return (1 - t) * at0 + t * at1; }

/* The latest time up to which n proves from t on; t where it does not. */
static double proved_until(const motion *m, const direction *d, double t) {
  double from[4], to[4], until = 1;
  for (int k = 0; k < m->count; k++) {
    from[k] = hk_dot(d->n, m->r[0][k]), to[k] = hk_dot(d->n, m->r[1][k]);
    if (!(value(from[k], to[k], t) > d->margin)) return t;
    if (to[k] <= d->margin) until = fmin(until, (from[k] - d->margin) / (from[k] - to[k]));
  }
  /* The root is rounded: a little earlier all must hold. */
  if (until < 1) until -= 4 * 0x1p-53;
  if (!(until > t)) return t;
  for (int k = 0; k < m->count; k++)
    if (!(value(from[k], to[k], until) > d->margin)) return t;
  return until;
}

/* What is known at one time. */
typedef struct state {
  double t;
  direction d;
  double r[4][3];
} state;

/* Whether the vector that goes linearly from that of a to that of b separates all the time. */
static bool proves(int count, const state *a, const state *b) {
  double margin = fmax(a->d.margin, b->d.margin);
  for (int k = 0; k < count; k++)
    if (!(hk_dot(a->d.n, a->r[k]) > margin && hk_dot(b->d.n, b->r[k]) > margin &&
          (hk_dot(a->d.n, b->r[k]) + hk_dot(b->d.n, a->r[k])) / 2 > margin))
      return false;
  return true;
}

/* ---- The search -------------------------------------------------------------------------------------------------- */

static state state_at(const motion *m, double t, hk_ccd_cost *cost) {
  state s = {.t = t};
  s.d = direction_at(m, t, s.r);
  cost->steps++;
  return s;
}

/* Goes on from *s as far as can be proved. `stride` is what is tried next. */
static void advance(const motion *m, state *s, double *stride, hk_ccd_cost *cost) {
  double until = proved_until(m, &s->d, s->t);
  if (until >= 1) {
    s->t = 1;
    return;
  }
  if (cost->steps >= PLAIN_STEPS || until == s->t) {
    *stride = fmax(*stride, 2 * (until - s->t));
    state far = state_at(m, fmin(1, s->t + *stride), cost);
    if (far.d.distance > m->near && proves(m->count, s, &far)) {
      *stride = 2 * (far.t - s->t);
      *s = far;
      return;
    }
    *stride /= 4;
  }
  if (until > s->t) *s = state_at(m, until, cost);
}

static bool search(const motion *m, double *t, hk_ccd_cost *cost) {
  double stride = 0.5;
  state s = state_at(m, 0, cost);
  while (s.d.distance > m->near) {
    if (s.t >= 1) {
      *t = 1;
      return false;
    }
    *t = s.t;
    if (cost->steps >= MOST_STEPS) {
      cost->gave_up = true;
      return true;
    }
    advance(m, &s, &stride, cost);
  }
  *t = s.t;
  return true;
}

bool hk_ccd_counted(hk_pair_kind kind, const double x0[12], const double x1[12], double gap, double tolerance,
                    double *t, hk_ccd_cost *cost) {
  motion m = {.kind = kind, .count = kind == HK_POINT_TRIANGLE ? 3 : 4, .gap = gap, .near = gap + tolerance};
  *cost = (hk_ccd_cost){0};
  *t = 0;
  difference_at(kind, x0, m.r[0]);
  difference_at(kind, x1, m.r[1]);
  if (!scale(&m)) return true;
  m.near = fmax(m.near, m.gap + NEAREST);
  return search(&m, t, cost);
}

bool hk_ccd(hk_pair_kind kind, const double x0[12], const double x1[12], double gap, double tolerance, double *t) {
  hk_ccd_cost cost;
  return hk_ccd_counted(kind, x0, x1, gap, tolerance, t, &cost);
}
