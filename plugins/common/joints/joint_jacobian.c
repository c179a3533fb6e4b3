/* The blocks of joints, the formulas of joint.c. With T_m = t_m/l_m, A_m = a_m/l_m and B_m = b/l_m the matrix between
 * the edges m and n is
 *     T_m (tt T_n + ta A_n)^T + A_m (ta T_n + aa A_n)^T + bb B_m B_n^T,
 * whose five numbers are one set for m = n and another for m != n. Joints in space are gathered, computed in loops that
 * compilers turn into vectors, and scattered in order; those in a plane, those that are straight or folded, and
 * Jacobians that are not symmetric go one by one through joint.c. Symmetric and definite blocks hold the direction of
 * the damping: how it turns is not symmetric, and where a joint is nearly straight it has no bound. The wide path and
 * the narrow one do the same operations, so their results are bitwise equal. */
#include "plugins/common/joints/joint_jacobian.h"
#include "plugins/common/joints/joint_angle.h"

#include <float.h>

enum { BLOCK = 32 };

typedef struct block {
  double e[2][3][BLOCK];        /* edges, m */
  double k[BLOCK], rest[BLOCK]; /* of the joints */
  double K[3][9][BLOCK];        /* between the edges: 1 with 1, 1 with 2, 2 with 2 */
  double A[2][3][BLOCK];        /* gradients of the angle with respect to the edges */
  double sine[BLOCK];           /* 0: the angle has no direction */
} block;

typedef struct task {
  const hk_joint_layout *layout;
  const hk_view *view;
  const double *plane;
  const hk_blocks *into;
  bool definite, turns, one_by_one;
  void (*compute)(block *, bool definite);
} task;

/* ---- one joint ---- */

void hk_joint_evaluate(const hk_joint_layout *s, const hk_view *view, const double plane[3], size_t e,
                       hk_joint_state *now) {
  const uint32_t *node = s->node[e];
  hk_joint_measure(view->x, node, plane, s->rest[e] == 0, &now->joint);
  now->k = s->k[e];
  now->c = s->c[e];
  now->z = now->moment = now->k * hk_joint_off(now->joint.angle, s->rest[e]);
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < 3; c++) {
      now->du[m][c] = view->v[3 * (size_t)node[m + 1] + c] - view->v[3 * (size_t)node[m] + c];
      if (now->joint.l[m] > 0) now->z += now->c * now->joint.across[m][c] / now->joint.l[m] * now->du[m][c];
    }
}

/* To the blocks of the particles: e_1 = x_j - x_i, e_2 = x_k - x_j. */
static void add_stiffness(const size_t *slot, hk_joint_blocks A, double *into) {
  double *K[9];
  for (int b = 0; b < 9; b++) K[b] = into + 9 * slot[b];
  for (int q = 0; q < 9; q++) {
    double ii = A[0][0][q], ij = A[0][1][q], ji = A[1][0][q], jj = A[1][1][q];
    K[0][q] += ii, K[1][q] += ij - ii, K[2][q] -= ij;
    K[3][q] += ji - ii, K[4][q] += ii - ij - ji + jj, K[5][q] += ij - jj;
    K[6][q] -= ji, K[7][q] += ji - jj, K[8][q] += jj;
  }
}

/* c g g^T, g the gradient of the angle; g_m are those with respect to the edges. */
static void add_damping(const size_t *slot, const double g1[3], const double g2[3], double c, double *into) {
  double g[3][3];
  for (int a = 0; a < 3; a++) g[0][a] = -g1[a], g[1][a] = g1[a] - g2[a], g[2][a] = g2[a];
  for (int b = 0; b < 9; b++) {
    double *D = into + 9 * slot[b];
    const double *at = g[b / 3], *by = g[b % 3];
    for (int q = 0; q < 9; q++) D[q] += c * at[q / 3] * by[q % 3];
  }
}

static void add_joint(const task *t, size_t e) {
  const size_t *slot = t->into->slot + 9 * (size_t)t->layout->element[e];
  hk_joint_blocks A;
  hk_joint_state now;
  double g[2][3] = {{0}};
  hk_joint_evaluate(t->layout, t->view, t->plane, e, &now);
  if (t->definite)
    hk_joint_definite(&now.joint, now.k, now.moment, A);
  else
    hk_joint_stiffness(&now.joint, now.k, t->turns ? now.z : now.moment, A);
  if (t->turns && now.c > 0) hk_joint_turning(&now.joint, now.c, (const double(*)[3])now.du, A);
  add_stiffness(slot, A, t->into->K);
  for (int m = 0; m < 2; m++)
    for (int c = 0; c < 3 && now.joint.l[m] > 0; c++) g[m][c] = now.joint.across[m][c] / now.joint.l[m];
  if (now.c > 0) add_damping(slot, g[0], g[1], now.c, t->into->D);
}

/* ---- many ---- */

/* The numbers of the matrix, for m = n (0) and m != n (1): exact, or as in hk_joint_definite. */
typedef struct numbers {
  double tt[2], ta[2], aa[2], bb[2];
} numbers;

HK_INLINE numbers exact(double k, double z, double half) {
  double same = -z * half, opposite = z / half;
  return (numbers){{0, 0}, {-z, 0}, {k, k}, {(same + opposite) / 2, (same - opposite) / 2}};
}

HK_INLINE numbers definite(double k, double z, double half) {
  double w = -z, p = k + sqrt(k * k + w * w), norm = w * w + p * p, o = (w < 0 ? -w : w) / 2;
  double s = norm > 0 ? p / norm : 0, tt = s * w * w, ta = s * w * p, aa = s * p * p;
  double same = -z * half, opposite = z / half;
  same = same > 0 ? same : 0;
  opposite = opposite > 0 ? opposite : 0;
  return (numbers){{(tt + o) / 2, (tt - o) / 2},
                   {(ta + w / 2) / 2, (ta - w / 2) / 2},
                   {(aa + o) / 2, (aa - o) / 2},
                   {(same + opposite) / 2, (same - opposite) / 2}};
}

/* Long, but as several functions it would not become vectors. */
HK_INLINE void compute(block *q, bool is_definite) {
  for (int r = 0; r < BLOCK; r++) {
    double T[2][3], A[2][3], B[2][3], t[2][3], b[3], scale[2];
    bool fine = true;
    for (int m = 0; m < 2; m++) {
      double x = q->e[m][0][r], y = q->e[m][1][r], z = q->e[m][2][r], square = x * x + y * y + z * z;
      bool long_enough = square >= DBL_MIN;
      fine = fine && long_enough;
      scale[m] = 1 / sqrt(long_enough ? square : 1);
      t[m][0] = x * scale[m], t[m][1] = y * scale[m], t[m][2] = z * scale[m];
    }
    b[0] = t[0][1] * t[1][2] - t[0][2] * t[1][1];
    b[1] = t[0][2] * t[1][0] - t[0][0] * t[1][2];
    b[2] = t[0][0] * t[1][1] - t[0][1] * t[1][0];
    double sine = sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]), along = 1 / (sine > 0 ? sine : 1);
    double cosine = t[0][0] * t[1][0] + t[0][1] * t[1][1] + t[0][2] * t[1][2];
    sine = fine ? sine : 0;
    for (int c = 0; c < 3; c++) b[c] *= along;
    for (int c = 0; c < 3; c++) {
      int d = (c + 1) % 3, f = (c + 2) % 3;
      A[0][c] = scale[0] * (t[0][d] * b[f] - t[0][f] * b[d]);
      A[1][c] = scale[1] * (b[d] * t[1][f] - b[f] * t[1][d]);
      for (int m = 0; m < 2; m++) T[m][c] = scale[m] * t[m][c], B[m][c] = scale[m] * b[c];
    }
    double off = hk_joint_angle(sine, cosine) - q->rest[r], z = q->k[r] * off;
    double near = sine / (cosine > 0 ? 1 + cosine : 1), far = (1 - cosine) / (sine > 0 ? sine : 1);
    double half = cosine > 0 ? near : far; /* tan(angle/2) */
    half = sine > 0 ? half : 1;
    numbers s = is_definite ? definite(q->k[r], z, half) : exact(q->k[r], z, half);
    for (int p = 0; p < 3; p++) {
      int m = p / 2, n = (p + 1) / 2, other = m != n;
      for (int c = 0; c < 3; c++) {
        double of_t = s.tt[other] * T[n][c] + s.ta[other] * A[n][c];
        double of_a = s.ta[other] * T[n][c] + s.aa[other] * A[n][c], of_b = s.bb[other] * B[n][c];
        for (int a = 0; a < 3; a++) q->K[p][3 * a + c][r] = T[m][a] * of_t + A[m][a] * of_a + B[m][a] * of_b;
      }
    }
    for (int m = 0; m < 2; m++)
      for (int c = 0; c < 3; c++) q->A[m][c][r] = A[m][c];
    q->sine[r] = sine;
  }
}

HK_INLINE void compute_kind(block *q, bool is_definite) {
  if (is_definite)
    compute(q, true);
  else
    compute(q, false);
}

HK_VERSIONS(static void, compute_many, (block * q, bool is_definite), compute_kind(q, is_definite))

static void gather(const task *t, size_t begin, size_t count, double into[2][3][BLOCK]) {
  const double *from = t->view->x;
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *node = t->layout->node[begin + (r < count ? r : 0)];
    const double *i = from + 3 * (size_t)node[0], *j = from + 3 * (size_t)node[1], *k = from + 3 * (size_t)node[2];
    for (int c = 0; c < 3; c++) into[0][c][r] = j[c] - i[c], into[1][c][r] = k[c] - j[c];
  }
}

static void take(const double *from, size_t begin, size_t count, double into[BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) into[r] = from[begin + (r < count ? r : 0)];
}

static void scatter(const task *t, const block *q, size_t r, size_t e) {
  const size_t *slot = t->into->slot + 9 * (size_t)t->layout->element[e];
  hk_joint_blocks A;
  double g[2][3];
  for (int p = 0; p < 9; p++) {
    A[0][0][p] = q->K[0][p][r];
    A[0][1][p] = A[1][0][p % 3 * 3 + p / 3] = q->K[1][p][r];
    A[1][1][p] = q->K[2][p][r];
  }
  add_stiffness(slot, A, t->into->K);
  if (!(t->layout->c[e] > 0)) return;
  for (int c = 0; c < 3; c++) g[0][c] = q->A[0][c][r], g[1][c] = q->A[1][c][r];
  add_damping(slot, g[0], g[1], t->layout->c[e], t->into->D);
}

static void one_block(const task *t, size_t begin, size_t count) {
  const hk_joint_layout *s = t->layout;
  block q;
  gather(t, begin, count, q.e);
  take(s->k, begin, count, q.k);
  take(s->rest, begin, count, q.rest);
  t->compute(&q, t->definite);
  for (size_t r = 0; r < count; r++) {
    if (q.sine[r] > 0)
      scatter(t, &q, r, begin + r);
    else
      add_joint(t, begin + r);
  }
}

static void add_part(const void *context, size_t part) {
  const task *t = context;
  const size_t *first = t->layout->sums.lists.first + part;
  for (size_t e = first[0]; e < first[1] && t->one_by_one; e++) add_joint(t, e);
  for (size_t e = first[0]; e < first[1] && !t->one_by_one; e += BLOCK)
    one_block(t, e, first[1] - e < BLOCK ? first[1] - e : BLOCK);
}

void hk_joint_jacobian(const hk_joint_layout *s, const hk_view *view, const double plane[3], const hk_blocks *into) {
  bool is_definite = into->want & HK_WANT_DEFINITE, turns = !is_definite && !(into->want & HK_WANT_SYMMETRIC);
  task t = {s,
            view,
            plane,
            into,
            is_definite,
            turns,
            plane || (turns && s->damped),
            HK_WIDEST(view->host->lanes, compute_many)};
  if (s->count == 0) return;
  hk_parts_each(view->host, &s->sums.lists.partition, s->sums.lists.first, add_part, &t);
}
