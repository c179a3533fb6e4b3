/* The angle of a joint and its first and second derivatives.
 *
 * With t_1, t_2 the unit vectors along the edges, l_1, l_2 their lengths and b the unit vector along t_1 x t_2, in
 * space angle = atan2(|e_1 x e_2|, e_1.e_2),    a_1 = -b x t_1,  a_2 = b x t_2,    d angle/d e_m = a_m/l_m, d^2 angle/d
 * e_m^2 = (-t_m a_m^T - a_m t_m^T + cot(angle) b b^T)/l_m^2, d^2 angle/d e_1 d e_2 = -b b^T/(l_1 l_2 sin(angle)), from
 * the polar angle of spherical coordinates about the other edge. In a plane with the normal b the edges are projected,
 * angle = atan2(b.(e_1 x e_2), e_1.e_2) has a sign, and the terms with b b^T are absent.
 *
 * In space the angle is the length of a vector, so where e_1 x e_2 = 0 it has no direction. Straight joints (angle 0)
 * that are straight at rest take any b across the edge: force and energy are 0 there, and their second derivative has a
 * limit, the same in all planes. Folded joints (angle pi), straight ones that are bent at rest, and edges without
 * length get no gradient: a balance that is not stable, which the least push ends. In a plane only the angle's range
 * ends at pi: hk_joint_off measures from the angle at rest, so that what jumps lies half a turn away from it. */
#include "plugins/common/joints/joint.h"
#include "plugins/kit/vector3.h"

#include <float.h>
#include <string.h>

/* A unit vector across t: along the axis from which t is furthest away, less its part along t. */
static void any_across(const double t[3], double b[3]) {
  int least = fabs(t[1]) < fabs(t[0]) ? 1 : 0;
  if (fabs(t[2]) < fabs(t[least])) least = 2;
  for (int c = 0; c < 3; c++) b[c] = (c == least) - t[least] * t[c];
  double length = hk_length(b);
  for (int c = 0; c < 3; c++) b[c] /= length;
}

/* The edges, in a plane without their parts along its normal; false: one of them has no length. */
static bool edges(const double *x, const uint32_t node[3], const double plane[3], hk_joint *joint) {
  bool fine = true;
  for (int m = 0; m < 2; m++) {
    hk_subtract(joint->t[m], x + 3 * (size_t)node[m + 1], x + 3 * (size_t)node[m]);
    if (plane) hk_add_scaled(joint->t[m], -hk_dot(plane, joint->t[m]), plane);
    double square = hk_dot(joint->t[m], joint->t[m]);
    fine = fine && square >= DBL_MIN;
    joint->l[m] = sqrt(square);
  }
  return fine;
}

/* The axis of the turn and its angle; false: the angle has no direction. */
static bool turn(const double plane[3], bool straight, hk_joint *joint) {
  double sine[3], cosine = hk_dot(joint->t[0], joint->t[1]);
  hk_cross(sine, joint->t[0], joint->t[1]);
  if (plane) {
    hk_copy(joint->b, plane);
    joint->angle = atan2(hk_dot(plane, sine), cosine);
    return true;
  }
  double size = hk_length(sine);
  joint->angle = atan2(size, cosine);
  joint->sine = size;
  joint->cosine = cosine;
  if (size > 0)
    for (int c = 0; c < 3; c++) joint->b[c] = sine[c] / size;
  else if (straight && cosine > 0)
    any_across(joint->t[0], joint->b);
  return size > 0 || (straight && cosine > 0);
}

void hk_joint_measure(const double *x, const uint32_t node[3], const double plane[3], bool straight, hk_joint *joint) {
  *joint = (hk_joint){.plane = plane};
  if (!edges(x, node, plane, joint)) {
    memset(joint->t, 0, sizeof joint->t);
    return;
  }
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < 3; c++) joint->t[m][c] /= joint->l[m];
  if (!turn(plane, straight, joint)) return;
  hk_cross(joint->across[0], joint->t[0], joint->b);
  hk_cross(joint->across[1], joint->b, joint->t[1]);
}

/* ---- second derivatives ----
 *
 * In coordinates (t_m, a_m, b)/l_m of each edge the matrix is one of t and a, and one of b, between the edges. */

typedef struct local {
  double tt[2][2], ta[2][2], aa[2][2], bb[2][2]; /* N m; ta[m][n]: of t_m with a_n */
} local;

static bool has_direction(const hk_joint *joint) { return hk_dot(joint->b, joint->b) > 0 && joint->l[0] > 0; }

static void assemble(const hk_joint *joint, const local *q, hk_joint_blocks blocks) {
  memset(blocks, 0, sizeof(hk_joint_blocks));
  if (!has_direction(joint)) return;
  for (int m = 0; m < 2; m++)
    for (int n = m; n < 2; n++) {
      const double *t = joint->t[m], *a = joint->across[m], *s = joint->t[n], *e = joint->across[n], *b = joint->b;
      double scale = 1 / (joint->l[m] * joint->l[n]), of_t[3], of_a[3], of_b[3];
      for (int c = 0; c < 3; c++) {
        of_t[c] = scale * (q->tt[m][n] * s[c] + q->ta[m][n] * e[c]);
        of_a[c] = scale * (q->ta[n][m] * s[c] + q->aa[m][n] * e[c]);
        of_b[c] = scale * q->bb[m][n] * b[c];
      }
      for (int p = 0; p < 9; p++)
        blocks[m][n][p] = t[p / 3] * of_t[p % 3] + a[p / 3] * of_a[p % 3] + b[p / 3] * of_b[p % 3];
    }
  for (int p = 0; p < 9; p++) blocks[1][0][p] = blocks[0][1][p % 3 * 3 + p / 3];
}

/* The part of z H that leaves the plane, as the eigenvalues of (1, 1) and (1, -1): z (cot -+ 1/sin). */
static void leaving(const hk_joint *joint, double k, double z, double *same, double *opposite) {
  double s = joint->sine, c = joint->cosine, half = c > 0 ? s / (1 + c) : s > 0 ? (1 - c) / s : 0; /* tan(angle/2) */
  *same = joint->plane ? 0 : -z * half;
  *opposite = joint->plane ? 0 : s > 0 ? z / half : 2 * k;
}

static void set_leaving(local *q, double same, double opposite) {
  q->bb[0][0] = q->bb[1][1] = (same + opposite) / 2;
  q->bb[0][1] = q->bb[1][0] = (same - opposite) / 2;
}

void hk_joint_stiffness(const hk_joint *joint, double k, double z, hk_joint_blocks blocks) {
  local q = {.aa = {{k, k}, {k, k}}, .ta = {{-z, 0}, {0, -z}}};
  double same, opposite;
  leaving(joint, k, z, &same, &opposite);
  set_leaving(&q, same, opposite);
  assemble(joint, &q, blocks);
}

/* In the plane: of equal changes of both edges [[0, w], [w, 2 k]], of opposite ones [[0, w], [w, 0]] with w = -z; the
 * positive eigenvalues are p = k + sqrt(k^2 + w^2), of (w, p), and |w|, of (1, sign w). */
void hk_joint_definite(const hk_joint *joint, double k, double z, hk_joint_blocks blocks) {
  double w = -z, p = k + sqrt(k * k + w * w), norm = w * w + p * p, same, opposite;
  double s = norm > 0 ? p / norm : 0, tt = s * w * w, ta = s * w * p, aa = s * p * p, o = fabs(w) / 2;
  local q = {{{(tt + o) / 2, (tt - o) / 2}, {(tt - o) / 2, (tt + o) / 2}},
             {{(ta + w / 2) / 2, (ta - w / 2) / 2}, {(ta - w / 2) / 2, (ta + w / 2) / 2}},
             {{(aa + o) / 2, (aa - o) / 2}, {(aa - o) / 2, (aa + o) / 2}},
             {{0}}};
  leaving(joint, k, z, &same, &opposite);
  set_leaving(&q, fmax(0, same), fmax(0, opposite));
  assemble(joint, &q, blocks);
}

void hk_joint_turning(const hk_joint *joint, double c, const double du[2][3], hk_joint_blocks blocks) {
  local q = {.ta = {{-1, 0}, {0, -1}}};
  double same = 0, opposite = 0, Hu[2][3] = {{0}};
  hk_joint_blocks H;
  if (!has_direction(joint)) return;
  if (joint->sine > 0) leaving(joint, 0, 1, &same, &opposite);
  set_leaving(&q, same, opposite);
  assemble(joint, &q, H);
  for (int b = 0; b < 4; b++)
    for (int e = 0; e < 9; e++) Hu[b / 2][e / 3] += H[b / 2][b % 2][e] * du[b % 2][e % 3];
  for (int b = 0; b < 4; b++)
    for (int e = 0; e < 9; e++)
      blocks[b / 2][b % 2][e] += c * joint->across[b / 2][e / 3] / joint->l[b / 2] * Hu[b % 2][e % 3];
}

/* (p_1 + p_2)^2 <= 2 (p_1^2 + p_2^2), 2 t_m a_m <= t_m^2 + a_m^2, and the larger eigenvalue of what leaves the plane.
 */
void hk_joint_bound(const hk_joint *joint, double k, double z, bool whole, double along[2], double across[2]) {
  double same, opposite, bending = (whole ? 2 * k : 0) + fabs(z);
  bool there = has_direction(joint);
  leaving(joint, k, z, &same, &opposite);
  for (int m = 0; m < 2; m++) {
    double square = joint->l[m] * joint->l[m];
    along[m] = there ? fabs(z) / square : 0;
    across[m] = there ? fmax(bending, fmax(same, opposite)) / square : 0;
  }
}
