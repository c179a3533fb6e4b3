/* Continuous collision by directions that separate.
 *
 * The differences r_k of the corners of the two features (four for two edges, three for a point and a triangle, where
 * the last counts twice) move linearly, and the features are as far apart as the hull of the r_k is from the origin. So
 * a vector n proves that they are further apart than the gap from t to t' if n.r_k > gap |n| at t and at t', for all k:
 * n.r_k is linear in between. The difference of the nearest points at t is the best n there. It proves the time up to
 * the first root of n.r_k(t') = gap |n|, and at this t' the next one goes on: the additive advance of Li, Kaufman and
 * Jiang 2021 ("Codimensional incremental potential contact", section 5), with the speeds along n in place of the
 * lengths of relative displacements, and with a proof of each step in place of trust in the distance.
 *
 * Where features turn while they stay close such steps are as short as their distance. Then an interval is tried with a
 * vector that goes linearly from n at t to n' at t'. n(s).r_k(s) is quadratic in s, and greater than its least
 * Bernstein coefficient, an inclusion function in the sense of Snyder 1992 and of Wang and others 2021 ("A large-scale
 * benchmark and an inclusion-based algorithm for continuous collision detection"); intervals that it does not prove are
 * bisected.
 *
 * Rounding: let the largest coordinate of r_k be M, u = 2^-53 and |n|_1 = sum |n_c|. A coordinate of r_k is off by u M,
 * at a time within [0, 1] by 4 u M; n.r_k by (4 + 3) u M |n|_1, its value between the ends of time by 3 u M |n|_1 more;
 * and gap |n|, where the pair is not a hit at once, by 8 u M |n|_1. A proof keeps a margin of 32 u M |n|_1. Where
 * squares would leave the range of doubles all is scaled by a power of 2. */
#include "plugins/common/contact/geometry/ccd.h"
#include "plugins/common/contact/geometry/nearest_frame.h"
#include "plugins/kit/vector3.h"

#include <float.h>

static const double MARGIN = 32 * 0x1p-53;
/* Parts of M within the gap where the margin leaves nothing to prove: |n|_1 is at most sqrt(3) |n|. */
static const double NEAREST = 100 * 0x1p-53;
/* Parts of M below which rounding tilts the difference of the nearest points by as much as 1e-12. */
static const double TILTED = 1e-4;
/* Steps after which intervals are tried as well; most pairs need no more than two. Of 100,000 hard motions those that
 * are not a matter of rounding took at most 217. */
enum { CORNERS = 4, PLAIN_STEPS = 4, MOST_STEPS = 400 };

typedef struct motion {
  hk_pair_kind kind;
  double r[2][CORNERS][3]; /* at both ends of time */
  double size;             /* M */
  double gap, near;        /* a distance up to `near` is a hit */
} motion;

/* What is known at one time. */
typedef struct state {
  double t;
  double r[CORNERS][3];
  double distance;
  double n[3];   /* largest coordinate: 1 */
  double margin; /* to be exceeded by n.r_k */
} state;

/* ---- Differences of corners -------------------------------------------------------------------------------------- */

static void differences(hk_pair_kind kind, const double *x, double r[CORNERS][3]) {
  static const int from[2][CORNERS] = {{0, 0, 0, 0}, {0, 3, 0, 3}}, to[2][CORNERS] = {{3, 6, 9, 9}, {6, 6, 9, 9}};
  for (int k = 0; k < CORNERS; k++) hk_subtract(r[k], x + from[kind][k], x + to[kind][k]);
}

/* The bounds of all r_k. False: they are not finite. */
static bool find_bounds(const motion *m, double low[3], double high[3]) {
  const double *at0 = m->r[0][0], *at1 = m->r[1][0];
  double least[3 * CORNERS], most[3 * CORNERS];
  int bad = 0;
  for (int k = 0; k < 3 * CORNERS; k++) {
    bad |= !(fabs(at0[k]) <= DBL_MAX) | !(fabs(at1[k]) <= DBL_MAX);
    least[k] = at0[k] < at1[k] ? at0[k] : at1[k];
    most[k] = at0[k] > at1[k] ? at0[k] : at1[k];
  }
  for (int c = 0; c < 3; c++) {
    low[c] = least[c], high[c] = most[c];
    for (int k = c + 3; k < 3 * CORNERS; k += 3) {
      low[c] = least[k] < low[c] ? least[k] : low[c];
      high[c] = most[k] > high[c] ? most[k] : high[c];
    }
  }
  return !bad;
}

static double largest(const double low[3], const double high[3]) {
  double most = 0;
  for (int c = 0; c < 3; c++) {
    double a = fmax(-low[c], high[c]);
    if (a > most) most = a;
  }
  return most;
}

/* Brings M near 1 where it is far from it; one power of 2 may not be enough. */
static void scale(motion *m, double low[3], double high[3]) {
  static const double LEAST = 0x1p-200, MOST = 0x1p200;
  while (m->size > 0 && (m->size < LEAST || m->size > MOST)) {
    double s = m->size < LEAST ? MOST : LEAST;
    for (int k = 0; k < 6 * CORNERS; k++) m->r[k / (3 * CORNERS)][k / 3 % CORNERS][k % 3] *= s;
    for (int c = 0; c < 3; c++) low[c] *= s, high[c] *= s;
    m->gap *= s, m->near *= s, m->size *= s;
  }
}

/* Whether the direction of an axis proves all of the time. */
static bool axis_separates(const motion *m, const double low[3], const double high[3]) {
  double margin = m->gap + MARGIN * m->size;
  for (int c = 0; c < 3; c++)
    if (low[c] > margin || high[c] < -margin) return true;
  return false;
}

/* ---- Directions -------------------------------------------------------------------------------------------------- */

/* The pair whose differences of corners are r, with a corner of the second feature, or the point, at the origin. */
static void pair_of(hk_pair_kind kind, double r[CORNERS][3], double x[12]) {
  for (int c = 0; c < 3; c++)
    if (kind == HK_POINT_TRIANGLE) {
      x[c] = 0, x[3 + c] = -r[0][c], x[6 + c] = -r[1][c], x[9 + c] = -r[2][c];
    } else {
      x[c] = r[0][c], x[3 + c] = r[1][c], x[6 + c] = 0, x[9 + c] = r[0][c] - r[2][c];
    }
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

static void normalize(double n[3]) {
  double x = fabs(n[0]), y = fabs(n[1]), z = fabs(n[2]), most = x > y ? x : y;
  most = most > z ? most : z;
  for (int c = 0; c < 3; c++) n[c] = most > 0 ? n[c] / most : 0;
}

static state state_at(const motion *m, double t, hk_ccd_cost *cost) {
  state s = {.t = t};
  double x[12];
  cost->steps++;
  for (int k = 0; k < CORNERS; k++)
    for (int c = 0; c < 3; c++) s.r[k][c] = (1 - t) * m->r[0][k][c] + t * m->r[1][k][c];
  pair_of(m->kind, s.r, x);
  hk_nearest near = hk_nearest_of_pair(m->kind, x);
  s.distance = sqrt(near.squared);
  hk_copy(s.n, near.d);
  normalize(s.n);
  if (s.distance < TILTED * m->size) {
    straighten(&near, x, s.n);
    normalize(s.n);
  }
  s.margin = m->gap * hk_length(s.n) + MARGIN * m->size * (fabs(s.n[0]) + fabs(s.n[1]) + fabs(s.n[2]));
  return s;
}

/* ---- Proofs ------------------------------------------------------------------------------------------------------ */

static double between(double at0, double at1, double t) { return (1 - t) * at0 + t * at1; }

/* The latest time up to which the direction of s proves from its time on; that time where it does not. */
static double proved_until(const motion *m, const state *s) {
  double from[CORNERS], to[CORNERS], until = 1;
  for (int k = 0; k < CORNERS; k++) {
    from[k] = hk_dot(s->n, m->r[0][k]), to[k] = hk_dot(s->n, m->r[1][k]);
    if (!(between(from[k], to[k], s->t) > s->margin)) return s->t;
    if (to[k] > s->margin) continue;
    double root = (from[k] - s->margin) / (from[k] - to[k]);
    until = root < until ? root : until;
  }
  /* The root is rounded: a little earlier all must hold. */
  if (until < 1) until -= 4 * 0x1p-53;
  if (!(until > s->t)) return s->t;
  for (int k = 0; k < CORNERS; k++)
    if (!(between(from[k], to[k], until) > s->margin)) return s->t;
  return until;
}

/* Whether the vector that goes linearly from that of a to that of b separates all the time. */
static bool proves(const state *a, const state *b) {
  double margin = a->margin > b->margin ? a->margin : b->margin;
  for (int k = 0; k < CORNERS; k++)
    if (!(hk_dot(a->n, a->r[k]) > margin && hk_dot(b->n, b->r[k]) > margin &&
          (hk_dot(a->n, b->r[k]) + hk_dot(b->n, a->r[k])) / 2 > margin))
      return false;
  return true;
}

/* ---- The search -------------------------------------------------------------------------------------------------- */

/* Goes on from *s as far as can be proved. `stride` is what is tried next. */
static void advance(const motion *m, state *s, double *stride, hk_ccd_cost *cost) {
  double until = proved_until(m, s);
  if (until >= 1) {
    s->t = 1;
    return;
  }
  if (cost->steps >= PLAIN_STEPS || until == s->t) {
    *stride = fmax(*stride, 2 * (until - s->t));
    state far = state_at(m, fmin(1, s->t + *stride), cost);
    if (far.distance > m->near && proves(s, &far)) {
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
  while (s.distance > m->near && s.t < 1 && cost->steps < MOST_STEPS) advance(m, &s, &stride, cost);
  *t = s.t;
  if (s.t >= 1 && s.distance > m->near) return false;
  cost->gave_up = s.distance > m->near;
  return true;
}

bool hk_ccd_counted(hk_pair_kind kind, const double x0[12], const double x1[12], double gap, double tolerance,
                    double *t, hk_ccd_cost *cost) {
  motion m = {.kind = kind, .gap = gap, .near = gap + tolerance};
  double low[3], high[3];
  *cost = (hk_ccd_cost){0};
  *t = 0;
  differences(kind, x0, m.r[0]);
  differences(kind, x1, m.r[1]);
  if (!find_bounds(&m, low, high)) return true;
  m.size = largest(low, high);
  if (m.size == 0) return true;
  scale(&m, low, high);
  if (axis_separates(&m, low, high)) {
    *t = 1;
    return false;
  }
  m.near = fmax(m.near, m.gap + NEAREST * m.size);
  return search(&m, t, cost);
}

bool hk_ccd(hk_pair_kind kind, const double x0[12], const double x1[12], double gap, double tolerance, double *t) {
  hk_ccd_cost cost;
  return hk_ccd_counted(kind, x0, x1, gap, tolerance, t, &cost);
}
