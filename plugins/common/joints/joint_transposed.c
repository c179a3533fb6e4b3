/* Products of joints for adjoints and tangents, in blocks as the forces have them (joint_kernel.c). With off = angle -
 * rest, g_m its gradient by the edges, H its Hessian, w and du the changes of the edges by u and their rates, turn =
 * g.w and z = k off + c g.du, u.F = -z turn has the derivatives by x  -(k turn g + H (z w + c turn du)),    by v  -c
 * turn g, by k  -off turn,    by c  -(g.du) turn,    by the angle at rest  k turn. Forwards, along changes w of the
 * edges, dv of their rates, and dk, dc and dr of the numbers, F = -z g changes by
 *     -(dz g + z H w),    dz = k (turn - dr) + dk off + c (g.dv + du.H w) + dc g.du.
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
  double sine[BLOCK];                                     /* 0: no direction */
  double u[2][3][BLOCK], dk[BLOCK], dc[BLOCK], dr[BLOCK]; /* dv, and the changes of the numbers */
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

/* A joint of a block: its edges, in the plane where there is one, a_m l_m, the gradient, and the axis b. */
typedef struct lane {
  double e[2][3], across[2][3], g[2][3], b[3], by[2]; /* by: 1/l_m^2 */
  double cot, by_sine, sine, off;
} lane;

HK_INLINE lane measure(const block *q, const double *plane, int r) {
  const double pi = 3.14159265358979323846;
  lane l;
  load((const double(*)[3][BLOCK])q->e, r, l.e);
  if (plane) {
    for (int m = 0; m < 2; m++) {
      double off = dot(l.e[m], plane);
      for (int c = 0; c < 3; c++) l.e[m][c] -= off * plane[c];
    }
    cross(l.e[0], l.e[1], l.b);
    l.sine = dot(plane, l.b);
    for (int c = 0; c < 3; c++) l.b[c] = plane[c];
  } else {
    cross(l.e[0], l.e[1], l.b);
    l.sine = sqrt(dot(l.b, l.b));
    double part = 1 / (l.sine > 0 ? l.sine : 1);
    for (int c = 0; c < 3; c++) l.b[c] *= part;
  }
  double cosine = dot(l.e[0], l.e[1]), ll[2] = {dot(l.e[0], l.e[0]), dot(l.e[1], l.e[1])};
  bool fine = ll[0] >= DBL_MIN && ll[1] >= DBL_MIN;
  for (int m = 0; m < 2; m++) l.by[m] = fine ? 1 / ll[m] : 0;
  l.by_sine = plane ? 0 : fine && l.sine > 0 ? 1 / l.sine : 0;
  l.cot = cosine * l.by_sine;
  l.off = hk_joint_angle(fine ? l.sine : 0, fine ? cosine : 1) - q->rest[r];
  if (plane) l.off = l.off > pi ? l.off - 2 * pi : l.off < -pi ? l.off + 2 * pi : l.off;
  cross(l.e[0], l.b, l.across[0]);
  cross(l.b, l.e[1], l.across[1]);
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < 3; c++) l.g[m][c] = l.across[m][c] * l.by[m];
  return l;
}

HK_INLINE double along(const double g[2][3], const double y[2][3]) { return dot(g[0], y[0]) + dot(g[1], y[1]); }

HK_INLINE void bend_along(const lane *l, const double y[2][3], double to[2][3]) {
  hessian_product((const double(*)[3])l->e, (const double(*)[3])l->across, l->b, l->by, l->cot, l->by_sine, y, to);
}

HK_INLINE void compute(block *q, const double *plane, bool damped) {
  for (int r = 0; r < BLOCK; r++) {
    double w[2][3], v[2][3] = {{0}}, y[2][3], Hy[2][3], rate = 0;
    const lane l = measure(q, plane, r);
    load((const double(*)[3][BLOCK])q->w, r, w);
    if (damped) load((const double(*)[3][BLOCK])q->v, r, v);
    double k = q->k[r], turn = along(l.g, (const double(*)[3])w), z = k * l.off, drag = 0;
    if (damped) {
      rate = along(l.g, (const double(*)[3])v);
      z += q->c[r] * rate, drag = q->c[r] * turn;
    }
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) y[m][c] = z * w[m][c] + drag * v[m][c];
    bend_along(&l, (const double(*)[3])y, Hy);
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) {
        q->x_to[m][c][r] = -(k * turn * l.g[m][c] + Hy[m][c]);
        q->v_to[m][c][r] = -drag * l.g[m][c];
      }
    q->by_k[r] = -l.off * turn, q->by_c[r] = -rate * turn, q->by_rest[r] = k * turn;
    q->sine[r] = plane ? 1 : l.sine;
  }
}

/* The change of the force, by the edges, in x_to. */
HK_INLINE void change(block *q, const double *plane, bool damped) {
  for (int r = 0; r < BLOCK; r++) {
    double w[2][3], Hw[2][3], rate = 0;
    const lane l = measure(q, plane, r);
    load((const double(*)[3][BLOCK])q->w, r, w);
    bend_along(&l, (const double(*)[3])w, Hw);
    double k = q->k[r], z = k * l.off;
    double dz = k * (along(l.g, (const double(*)[3])w) - q->dr[r]) + q->dk[r] * l.off;
    if (damped) {
      double v[2][3], u[2][3];
      load((const double(*)[3][BLOCK])q->v, r, v);
      load((const double(*)[3][BLOCK])q->u, r, u);
      rate = along(l.g, (const double(*)[3])v);
      z += q->c[r] * rate;
      dz += q->c[r] * (along(l.g, (const double(*)[3])u) + along((const double(*)[3])Hw, (const double(*)[3])v)) +
            q->dc[r] * rate;
    }
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) q->x_to[m][c][r] = -(dz * l.g[m][c] + z * Hw[m][c]);
    q->sine[r] = plane ? 1 : l.sine;
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

HK_INLINE void change_kind(block *q, const double *plane, bool damped) {
  if (plane && damped)
    change(q, plane, true);
  else if (plane)
    change(q, plane, false);
  else if (damped)
    change(q, NULL, true);
  else
    change(q, NULL, false);
}

HK_VERSIONS(static void, compute_many, (block * q, const double *plane, bool damped), compute_kind(q, plane, damped))
HK_VERSIONS(static void, change_many, (block * q, const double *plane, bool damped), change_kind(q, plane, damped))

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

/* The change of the force of one. */
static void change_straight(const hk_elements *a, const double *x, size_t k, block *q, size_t r) {
  double stiffness = a->stiffness.value[k], c = a->damping.value[k], rate = 0, dz = 0;
  double w[2][3], du[2][3], g[2][3], to[2][3] = {{0}};
  hk_joint joint;
  hk_joint_blocks K;
  hk_joint_measure(x, hk_tuple(&a->node, k), NULL, a->rest.value[k] == 0, &joint);
  load((const double(*)[3][BLOCK])q->w, (int)r, w);
  load((const double(*)[3][BLOCK])q->v, (int)r, du);
  for (int m = 0; m < 2; m++)
    for (int d = 0; d < 3; d++) {
      g[m][d] = joint.l[m] > 0 ? joint.across[m][d] / joint.l[m] : 0;
      rate += g[m][d] * du[m][d];
      dz += c * g[m][d] * q->u[m][d][r];
    }
  double off = hk_joint_off(joint.angle, a->rest.value[k]);
  dz += q->dk[r] * off + q->dc[r] * rate - stiffness * q->dr[r];
  hk_joint_stiffness(&joint, stiffness, stiffness * off + c * rate, K);
  if (c != 0) hk_joint_turning(&joint, c, (const double(*)[3])du, K);
  for (int b = 0; b < 4; b++)
    for (int e = 0; e < 9; e++) to[b / 2][e / 3] -= K[b / 2][b % 2][e] * w[b % 2][e % 3];
  for (int m = 0; m < 2; m++)
    for (int d = 0; d < 3; d++) q->x_to[m][d][r] = to[m][d] - dz * g[m][d];
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

/* ---- along directions ---- */

/* The numbers of the joints that act among all of which there are changes: *next is the first one not passed. */
static void number(const hk_tuples *all, const hk_view *view, size_t count, size_t *next, size_t of[BLOCK]) {
  for (size_t r = 0; r < count; r++) {
    while (!hk_joint_acts(view, hk_tuple(all, *next))) ++*next;
    of[r] = (*next)++;
  }
}

static void take_changes(const hk_tangent *t, size_t row, const size_t *of, size_t count, double to[BLOCK]) {
  const double *from = t->parameter ? t->parameter[row] : NULL;
  for (size_t r = 0; r < count; r++) to[r] = from ? from[of[r]] : 0;
}

static bool any_damping(const hk_tangent *t, size_t count, size_t row) {
  bool any = false;
  for (size_t j = 0; j < count; j++) any = any || (t[j].parameter && t[j].parameter[row]);
  return any;
}

void hk_joint_along(const hk_elements *a, const hk_view *view, const double plane[3], const hk_tuples *all,
                    const hk_joint_rows *rows, const hk_tangent *directions, size_t count_directions) {
  block q = {.dk = {0}, .dc = {0}, .dr = {0}};
  size_t next = 0, of[BLOCK];
  bool creeps = any_damping(directions, count_directions, rows->c);
  for (size_t k = 0; k < a->node.count; k += BLOCK) {
    size_t count = a->node.count - k < BLOCK ? a->node.count - k : BLOCK;
    bool damped = take(a, k, count, &q) || creeps;
    number(all, view, count, &next, of);
    gather(&a->node, view->x, k, count, q.e);
    gather(&a->node, view->v, k, count, q.v);
    for (const hk_tangent *t = directions; t < directions + count_directions; t++) {
      gather(&a->node, t->x, k, count, q.w);
      gather(&a->node, t->v, k, count, q.u);
      take_changes(t, rows->k, of, count, q.dk);
      take_changes(t, rows->c, of, count, q.dc);
      take_changes(t, rows->rest, of, count, q.dr);
      HK_WIDEST(view->host->lanes, change_many)(&q, plane, damped);
      for (size_t r = 0; r < count; r++)
        if (q.sine[r] == 0) change_straight(a, view->x, k + r, &q, r);
      scatter(&a->node, (const double(*)[3][BLOCK])q.x_to, k, count, t->force);
    }
  }
}
