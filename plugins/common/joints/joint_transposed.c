/* Products of joints for adjoints, in blocks as the forces have them (joint_kernel.c). With off = angle - rest, g_m its
 * gradient by the edges, H its Hessian, w and du the changes of the edges by u and their rates, turn = g.w and
 *     z = k off + c g.du,
 * u.F = -z turn has the derivatives
 *     by x  -(k turn g + H (z w + c turn du)),    by v  -c turn g,
 *     by k  -off turn,    by c  -(g.du) turn,    by the angle at rest  k turn.
 * By joint.c, with y_m a change of the edges, g_m = a_m/l_m and the axis b
 *     (H y)_m = -(t_m (a_m.y_m) + a_m (t_m.y_m))/l_m^2 + b (cot(angle) b.y_m/l_m^2 - b.y_n/(l_1 l_2 sin(angle))),
 * in a plane without the terms of b. Where an angle in space has no direction joint.c says what holds. */
#include "plugins/common/joints/joint_transposed.h"
#include "plugins/common/joints/joint.h"
#include "plugins/common/joints/joint_angle.h"

#include "core/plugin/widest.h"
#include "plugins/kit/vector3.h"

#include <float.h>

enum { BLOCK = 64 };

typedef struct block {
  double e[2][3][BLOCK], w[2][3][BLOCK], v[2][3][BLOCK]; /* edges, m; their changes by u; their rates, m/s */
  double k[BLOCK], c[BLOCK], rest[BLOCK];
  double x_to[2][3][BLOCK], v_to[2][3][BLOCK]; /* by the edges */
  double by_k[BLOCK], by_c[BLOCK], by_rest[BLOCK];
  double sine[BLOCK]; /* 0: no direction */
} block;

HK_INLINE double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

HK_INLINE void cross(const double a[3], const double b[3], double to[3]) {
  to[0] = a[1] * b[2] - a[2] * b[1], to[1] = a[2] * b[0] - a[0] * b[2], to[2] = a[0] * b[1] - a[1] * b[0];
}

HK_INLINE void load(const double from[2][3][BLOCK], int r, double to[2][3]) {
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < 3; c++) to[m][c] = from[m][c][r];
}

/* With e in the plane where there is one, b unit, a_m l_m in `across` and 1/l_m^2 in `by`: (H y)_m. */
HK_INLINE void hessian_product(const double e[2][3], const double across[2][3], const double b[3], const double by[2],
                               double cot, double by_sine, const double y[2][3], double to[2][3]) {
  double out[2] = {dot(b, y[0]), dot(b, y[1])};
  for (int m = 0; m < 2; m++) {
    double of_t = -dot(across[m], y[m]) * by[m] * by[m], of_a = -dot(e[m], y[m]) * by[m] * by[m];
    double of_b = cot * out[m] * by[m] - by_sine * out[1 - m];
    for (int c = 0; c < 3; c++) to[m][c] = of_t * e[m][c] + of_a * across[m][c] + of_b * b[c];
  }
}

HK_INLINE void compute(block *q, const double *plane, bool damped) {
  const double pi = 3.14159265358979323846;
  for (int r = 0; r < BLOCK; r++) {
    double e[2][3], w[2][3], v[2][3] = {{0}}, b[3], across[2][3], g[2][3], y[2][3], Hy[2][3], sine, rate = 0;
    load((const double(*)[3][BLOCK])q->e, r, e);
    load((const double(*)[3][BLOCK])q->w, r, w);
    if (damped) load((const double(*)[3][BLOCK])q->v, r, v);
    if (plane) {
      for (int m = 0; m < 2; m++) {
        double off = dot(e[m], plane);
        for (int c = 0; c < 3; c++) e[m][c] -= off * plane[c];
      }
      cross(e[0], e[1], b);
      sine = dot(plane, b);
      for (int c = 0; c < 3; c++) b[c] = plane[c];
    } else {
      cross(e[0], e[1], b);
      sine = sqrt(dot(b, b));
      double part = 1 / (sine > 0 ? sine : 1);
      for (int c = 0; c < 3; c++) b[c] *= part;
    }
    double cosine = dot(e[0], e[1]), ll[2] = {dot(e[0], e[0]), dot(e[1], e[1])};
    bool fine = ll[0] >= DBL_MIN && ll[1] >= DBL_MIN;
    const double by[2] = {fine ? 1 / ll[0] : 0, fine ? 1 / ll[1] : 0};
    double by_sine = plane ? 0 : fine && sine > 0 ? 1 / sine : 0;
    double off = hk_joint_angle(fine ? sine : 0, fine ? cosine : 1) - q->rest[r];
    if (plane) off = off > pi ? off - 2 * pi : off < -pi ? off + 2 * pi : off;
    cross(e[0], b, across[0]);
    cross(b, e[1], across[1]);
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) g[m][c] = across[m][c] * by[m];
    double k = q->k[r], turn = dot(g[0], w[0]) + dot(g[1], w[1]), z = k * off, drag = 0;
    if (damped) {
      rate = dot(g[0], v[0]) + dot(g[1], v[1]);
      z += q->c[r] * rate, drag = q->c[r] * turn;
    }
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) y[m][c] = z * w[m][c] + drag * v[m][c];
    hessian_product((const double(*)[3])e, (const double(*)[3])across, b, by, cosine * by_sine, by_sine,
                    (const double(*)[3])y, Hy);
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) {
        q->x_to[m][c][r] = -(k * turn * g[m][c] + Hy[m][c]);
        q->v_to[m][c][r] = -drag * g[m][c];
      }
    q->by_k[r] = -off * turn, q->by_c[r] = -rate * turn, q->by_rest[r] = k * turn;
    q->sine[r] = plane ? 1 : sine;
  }
}

HK_INLINE void compute_kind(block *q, const double *plane, bool damped) {
  if (plane && damped)
    compute(q, plane, true);
  else if (plane)
    compute(q, plane, false);
  else if (damped)
    compute(q, NULL, true);
  else
    compute(q, NULL, false);
}

HK_VERSIONS(static void, compute_many, (block * q, const double *plane, bool damped), compute_kind(q, plane, damped))

/* A joint without a direction. */
static void straight(const hk_elements *a, const double *x, size_t k, block *q, size_t r) {
  double stiffness = a->stiffness.value[k], c = a->damping.value[k], turn = 0, rate = 0;
  double w[2][3], du[2][3], g[2][3], by_x[2][3] = {{0}};
  hk_joint joint;
  hk_joint_blocks K;
  hk_joint_measure(x, hk_tuple(&a->node, k), NULL, a->rest.value[k] == 0, &joint);
  load((const double(*)[3][BLOCK])q->w, (int)r, w);
  load((const double(*)[3][BLOCK])q->v, (int)r, du);
  for (int m = 0; m < 2; m++) {
    for (int d = 0; d < 3; d++) g[m][d] = joint.l[m] > 0 ? joint.across[m][d] / joint.l[m] : 0;
    turn += hk_dot(g[m], w[m]);
    rate += hk_dot(g[m], du[m]);
  }
  double off = hk_joint_off(joint.angle, a->rest.value[k]);
  hk_joint_stiffness(&joint, stiffness, stiffness * off + c * rate, K);
  if (c != 0) hk_joint_turning(&joint, c, (const double(*)[3])du, K);
  for (int b = 0; b < 4; b++)
    for (int e = 0; e < 9; e++) by_x[b % 2][e % 3] -= K[b / 2][b % 2][e] * w[b / 2][e / 3];
  for (int m = 0; m < 2; m++)
    for (int d = 0; d < 3; d++) q->x_to[m][d][r] = by_x[m][d], q->v_to[m][d][r] = -c * turn * g[m][d];
  q->by_k[r] = -off * turn, q->by_c[r] = -rate * turn, q->by_rest[r] = stiffness * turn;
}

/* The differences of the joints from `begin` on, of one array; lanes beyond get those of the first. */
static void gather(const hk_tuples *node, const double *from, size_t begin, size_t count, double into[2][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *member = hk_tuple(node, begin + (r < count ? r : 0));
    const double *i = from + 3 * (size_t)member[0], *j = from + 3 * (size_t)member[1],
                 *k = from + 3 * (size_t)member[2];
    for (int c = 0; c < 3; c++) into[0][c][r] = j[c] - i[c], into[1][c][r] = k[c] - j[c];
  }
}

static void scatter(const hk_tuples *node, const double by[2][3][BLOCK], size_t begin, size_t count, double *to) {
  for (size_t r = 0; r < count; r++) {
    const uint32_t *member = hk_tuple(node, begin + r);
    double *i = to + 3 * (size_t)member[0], *j = to + 3 * (size_t)member[1], *k = to + 3 * (size_t)member[2];
    for (int c = 0; c < 3; c++) {
      i[c] -= by[0][c][r];
      j[c] += by[0][c][r] - by[1][c][r];
      k[c] += by[1][c][r];
    }
  }
}

static bool take(const hk_elements *a, size_t begin, size_t count, block *q) {
  bool damped = false;
  for (size_t r = 0; r < BLOCK; r++) {
    size_t k = begin + (r < count ? r : 0);
    q->k[r] = a->stiffness.value[k], q->c[r] = a->damping.value[k], q->rest[r] = a->rest.value[k];
    damped = damped || q->c[r] != 0;
  }
  return damped;
}

void hk_joint_transposed(const hk_elements *a, const hk_view *view, const double plane[3], const double *u,
                         double *by_x, double *by_v, hk_joint_slopes *slopes, void *context) {
  block q;
  for (size_t k = 0; k < a->node.count; k += BLOCK) {
    size_t count = a->node.count - k < BLOCK ? a->node.count - k : BLOCK;
    bool damped = take(a, k, count, &q) || slopes;
    gather(&a->node, view->x, k, count, q.e);
    gather(&a->node, u, k, count, q.w);
    gather(&a->node, view->v, k, count, q.v);
    HK_WIDEST(view->host->lanes, compute_many)(&q, plane, damped);
    for (size_t r = 0; r < count; r++)
      if (q.sine[r] == 0) straight(a, view->x, k + r, &q, r);
    scatter(&a->node, (const double(*)[3][BLOCK])q.x_to, k, count, by_x);
    if (damped) scatter(&a->node, (const double(*)[3][BLOCK])q.v_to, k, count, by_v);
    for (size_t r = 0; r < count && slopes; r++) slopes(context, q.by_k[r], q.by_c[r], q.by_rest[r]);
  }
}
