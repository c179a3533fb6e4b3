/* The first contact of a pair of features in linear motion, decided in exact arithmetic; shares nothing with ccd.c.
 *
 * Features in contact are coplanar. Unless they are so all the time contact is at a root of the cubic of their volume;
 * otherwise it begins at the start or where a corner comes onto the line of an edge, or onto a corner: at roots of the
 * coordinates of cross products, and of differences. Roots are isolated by bisection of Bernstein coefficients, whose
 * changes of sign bound their number (Descartes), and there the exact distance tells: features that come no nearer than
 * their motion in 2^-90 of the time cannot be told from ones in contact, and count as such. */
#ifndef HK_EXACT_MOTION_H
#define HK_EXACT_MOTION_H

#include "tests/plugins/common/contact/geometry/rational.h"

enum { DEEPEST = 90 };

typedef struct motion {
  hk_pair_kind kind;
  vec x[2][4];
  vec r[2][4]; /* differences of the corners of the two features */
  int corners;
  num speed; /* at least the largest displacement of these: by the sum of its coordinates */
  num first; /* the earliest contact known, at the end of its bracket; NULL: none */
} motion;

static inline motion q_motion(hk_pair_kind kind, const double *x0, const double *x1) {
  motion m = {.kind = kind, .corners = kind == HK_POINT_TRIANGLE ? 3 : 4, .speed = q(0)};
  for (int side = 0; side < 2; side++) {
    for (int i = 0; i < 4; i++) m.x[side][i] = v_of((side ? x1 : x0) + 3 * i);
    for (int k = 0; k < m.corners; k++)
      m.r[side][k] = kind == HK_POINT_TRIANGLE ? v_sub(m.x[side][0], m.x[side][1 + k])
                                               : v_sub(m.x[side][k % 2], m.x[side][2 + k / 2]);
  }
  for (int k = 0; k < m.corners; k++) {
    vec d = v_sub(m.r[1][k], m.r[0][k]);
    num sum = q(0);
    for (int c = 0; c < 3; c++) sum = mpq_sgn(d.c[c]) < 0 ? q_sub(sum, d.c[c]) : q_add(sum, d.c[c]);
    if (mpq_cmp(sum, m.speed) > 0) m.speed = sum;
  }
  return m;
}

static inline num q_squared_at(const motion *m, num t) {
  vec x[4];
  for (int i = 0; i < 4; i++) x[i] = v_add_scaled(m->x[0][i], t, v_sub(m->x[1][i], m->x[0][i]));
  return q_squared_distance(m->kind, x);
}

/* Whether the distance is greater than the gap for all times within w of t: sure where true. */
static inline bool q_apart(const motion *m, num t, num w, num gap) {
  int mark = q_used;
  num bound = q_add(gap, q_mul(m->speed, w));
  bool apart = mpq_cmp(q_squared_at(m, t), q_mul(bound, bound)) > 0;
  q_reset(mark);
  return apart;
}

/* The same for the times from `low` to `high`, by bisection; not sure at that depth: false. */
static inline bool q_stays_apart(const motion *m, num low, num high, num gap, int depth) {
  int mark = q_used;
  num middle = q_half(q_add(low, high));
  bool apart = q_apart(m, middle, q_half(q_sub(high, low)), gap);
  if (!apart && depth > 0)
    apart = q_stays_apart(m, low, middle, gap, depth - 1) && q_stays_apart(m, middle, high, gap, depth - 1);
  q_reset(mark);
  return apart;
}

static inline void q_consider(motion *m, num t, num w, num end) {
  if (!q_apart(m, t, w, q(0)) && (!m->first || mpq_cmp(end, m->first) < 0)) m->first = end;
}

static inline int q_changes(num *b, int degree) {
  int changes = 0, last = 0;
  for (int k = 0; k <= degree; k++) {
    int s = mpq_sgn(b[k]);
    if (s && last && s != last) changes++;
    if (s) last = s;
  }
  return changes;
}

/* Roots of the polynomial with Bernstein coefficients b on [low, high]. */
static inline void q_roots(motion *m, num *b, int degree, num low, num high, int depth) {
  if (m->first && mpq_cmp(low, m->first) >= 0) return;
  if (mpq_sgn(b[0]) == 0) q_consider(m, low, q(0), low);
  if (mpq_sgn(b[degree]) == 0) q_consider(m, high, q(0), high);
  if (q_changes(b, degree) == 0) return;
  num middle = q_half(q_add(low, high)), w = q_half(q_sub(high, low));
  bool look = depth == 3 || depth == 8 || depth == 20 || depth == 45 || depth == DEEPEST;
  if (look && q_apart(m, middle, w, q(0))) return;
  if (depth == DEEPEST) {
    q_consider(m, middle, w, high);
    return;
  }
  num left[4], right[4], row[4];
  for (int k = 0; k <= degree; k++) row[k] = b[k];
  for (int k = 0; k <= degree; k++) {
    left[k] = row[0], right[degree - k] = row[degree - k];
    for (int i = 0; i < degree - k; i++) row[i] = q_half(q_add(row[i], row[i + 1]));
  }
  q_roots(m, left, degree, low, middle, depth + 1);
  q_roots(m, right, degree, middle, high, depth + 1);
}

static inline bool q_roots_in_time(motion *m, num *b, int degree) {
  bool zero = true;
  for (int k = 0; k <= degree; k++) zero = zero && mpq_sgn(b[k]) == 0;
  if (!zero) q_roots(m, b, degree, q(0), q(1), 0);
  return !zero;
}

static inline bool q_volume_roots(motion *m) {
  num b[4] = {q(0), q(0), q(0), q(0)};
  for (int s = 0; s < 8; s++) {
    int ends = (s & 1) + (s >> 1 & 1) + (s >> 2);
    num volume = v_dot(m->r[s & 1][0], v_cross(m->r[s >> 1 & 1][1], m->r[s >> 2][2]));
    b[ends] = q_add(b[ends], volume);
  }
  b[1] = q_div(b[1], q(3)), b[2] = q_div(b[2], q(3));
  return q_roots_in_time(m, b, 3);
}

/* Where the corner of one feature, from which r_j and r_k go to the ends of an edge, is on its line. */
static inline void q_line_roots(motion *m, int j, int k) {
  vec at0 = v_cross(m->r[0][j], m->r[0][k]), at1 = v_cross(m->r[1][j], m->r[1][k]), a = v_cross(m->r[0][j], m->r[1][k]),
      b = v_cross(m->r[1][j], m->r[0][k]);
  for (int c = 0; c < 3; c++) q_roots_in_time(m, (num[]){at0.c[c], q_half(q_add(a.c[c], b.c[c])), at1.c[c]}, 2);
}

/* Whether they touch; *first: the time by which they have. */
static inline bool q_first_contact(motion *m, num *first) {
  static const int lines[2][4][2] = {{{0, 1}, {1, 2}, {2, 0}, {0, 1}}, {{0, 1}, {2, 3}, {0, 2}, {1, 3}}};
  q_consider(m, q(1), q(0), q(1));
  q_consider(m, q(0), q(0), q(0));
  if (!q_volume_roots(m)) {
    for (int k = 0; k < 4; k++) q_line_roots(m, lines[m->kind][k][0], lines[m->kind][k][1]);
    for (int k = 0; k < m->corners; k++)
      for (int c = 0; c < 3; c++) q_roots_in_time(m, (num[]){m->r[0][k].c[c], m->r[1][k].c[c]}, 1);
  }
  *first = m->first;
  return m->first;
}

#endif
