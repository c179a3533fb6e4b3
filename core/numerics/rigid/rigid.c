/* RATTLE's two corrections for free rigid groups: two to four particles that keep all distances between each other and
 * have no other equation. With the equations as (|d_e|^2 - L_e^2)/2 = 0, whose gradients are the differences d_e, the
 * matrix A = J W J^T has the entries sum +- w d_e.d_f, and the products of differences are
 *     (x_i - x_j).(x_k - x_l) = (L_il^2 + L_jk^2 - L_ik^2 - L_jl^2)/2,
 * so that A does not change as the group turns: it is factorized once. Positions are corrected by Newton's iteration
 * with that matrix, whose error falls by a factor of the order of the angle of a step in each round, velocities by one
 * solution.
 *
 * HK_RIGID_BUNDLE groups of one size lie side by side in the lanes of a bundle. A lane that has converged stays as it
 * is, so that a group moves as it would alone, to the same bits for vectors of any width. */
#include "core/numerics/rigid/rigid.h"

#include "core/plugin/widest.h"

#include <float.h>
#include <math.h>

enum { B = HK_RIGID_BUNDLE, ROUNDS = 24 };

/* A number of each lane; a truth of each, all bits or none. */
typedef double lanes __attribute__((vector_size(8 * HK_RIGID_BUNDLE), aligned(8), may_alias));
typedef int64_t truths __attribute__((vector_size(8 * HK_RIGID_BUNDLE), aligned(8), may_alias));

/* As those of constraint_projection.c: g left, relative to the largest coordinate. */
static const double rounding = 4 * DBL_EPSILON, position_tolerance = 1e-12, stagnant = 0.25;

static const uint8_t pair_of[6][2] = {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}};

HK_INLINE const lanes *row(const double *of) { return (const lanes *)of; }

HK_INLINE void load(const hk_rigid_bundle *b, int k, const double *from, lanes to[4][3]) {
  for (int i = 0; i < k; i++)
    for (int l = 0; l < B; l++)
      for (int c = 0; c < 3; c++) to[i][c][l] = from[3 * (size_t)b->particle[i][l] + (size_t)c];
}

HK_INLINE void store(const hk_rigid_bundle *b, int k, lanes from[4][3], double *to) {
  for (int l = 0; l < b->used; l++)
    for (int i = 0; i < k; i++)
      for (int c = 0; c < 3; c++) to[3 * (size_t)b->particle[i][l] + (size_t)c] = from[i][c][l];
}

HK_INLINE void differences(int e, lanes x[4][3], lanes d[6][3]) {
  for (int p = 0; p < e; p++)
    for (int c = 0; c < 3; c++) d[p][c] = x[pair_of[p][0]][c] - x[pair_of[p][1]][c];
}

/* *to becomes a where it is not above b or both, otherwise b: NaN counts as the largest. */
HK_INLINE void take_larger(lanes *to, lanes *by) {
  truths fits = *by <= *to;
  *to = (lanes)(((truths)*to & fits) | ((truths)*by & ~fits));
}

HK_INLINE void magnitude(lanes *a) { *a = (lanes)((truths)*a & INT64_MAX); }

/* r := A^-1 r, with A = F F^T, of whose rows the diagonal is stored as its reciprocal. */
HK_INLINE void solve(const hk_rigid_bundle *b, int e, lanes r[6]) {
  for (int p = 0; p < e; p++) {
    for (int q = 0; q < p; q++) r[p] -= *row(b->factor[HK_RIGID_AT(p, q)]) * r[q];
    r[p] *= *row(b->factor[HK_RIGID_AT(p, p)]);
  }
  for (int p = e - 1; p >= 0; p--) {
    for (int q = p + 1; q < e; q++) r[p] -= *row(b->factor[HK_RIGID_AT(q, p)]) * r[q];
    r[p] *= *row(b->factor[HK_RIGID_AT(p, p)]);
  }
}

/* x += W J^T r */
HK_INLINE void move(const hk_rigid_bundle *b, int e, lanes d[6][3], lanes r[6], lanes x[4][3]) {
  for (int p = 0; p < e; p++)
    for (int c = 0; c < 3; c++) {
      lanes along = d[p][c] * r[p];
      x[pair_of[p][0]][c] += *row(b->weight[pair_of[p][0]]) * along;
      x[pair_of[p][1]][c] -= *row(b->weight[pair_of[p][1]]) * along;
    }
}

/* r = (L^2 - |d|^2)/2, and of each lane the largest |g| = |r|/L. */
HK_INLINE void find_violation(const hk_rigid_bundle *b, int e, lanes x[4][3], lanes r[6], lanes *left) {
  lanes d[6][3];
  differences(e, x, d);
  for (int p = 0; p < e; p++) {
    r[p] = (*row(b->square[p]) - (d[p][0] * d[p][0] + d[p][1] * d[p][1] + d[p][2] * d[p][2])) * 0.5;
    lanes g = r[p] * *row(b->per_length[p]);
    magnitude(&g);
    if (p)
      take_larger(left, &g);
    else
      *left = g;
  }
}

HK_INLINE void find_size(int k, lanes x[4][3], lanes *size) {
  *size = x[0][0];
  magnitude(size);
  for (int i = 0; i < 3 * k; i++) {
    lanes a = x[i / 3][i % 3];
    magnitude(&a);
    take_larger(size, &a);
  }
}

HK_INLINE bool any_of(const truths *t) {
  int64_t any = 0;
  for (int l = 0; l < B; l++) any |= (*t)[l];
  return any != 0;
}

/* Newton's rounds from y along `d`; `all` becomes their sum. False: a lane has not converged. */
HK_INLINE bool correct(const hk_rigid_bundle *b, int k, int e, lanes d[6][3], lanes y[4][3], lanes all[6]) {
  lanes r[6], left, last = {0}, size;
  truths active = ~(truths){0};
  find_size(k, y, &size);
  for (int p = 0; p < e; p++) all[p] = (lanes){0};
  for (int round = 0; round < ROUNDS; round++) {
    find_violation(b, e, y, r, &left);
    truths met = left <= rounding * size;
    if (round) met |= (left <= position_tolerance * size) & (left > stagnant * last);
    active &= ~met;
    if (!any_of(&active)) return true;
    last = left;
    solve(b, e, r);
    for (int p = 0; p < e; p++) {
      r[p] = (lanes)((truths)r[p] & active);
      all[p] += r[p];
    }
    move(b, e, d, r, y);
  }
  return false;
}

HK_INLINE bool shake(const hk_rigid_bundle *b, int k, int e, const double *from, double h, double *x, double *v) {
  lanes y[4][3], d[6][3], all[6];
  load(b, k, from, y);
  differences(e, y, d);
  load(b, k, x, y);
  if (!correct(b, k, e, d, y, all)) return false;
  store(b, k, y, x);
  load(b, k, v, y);
  for (int p = 0; p < e; p++) all[p] *= 1 / h;
  move(b, e, d, all, y);
  store(b, k, y, v);
  return true;
}

/* One round from y along the differences at `from`; `all` grows by it. The largest |g| before it. */
HK_INLINE double round_of(const hk_rigid_bundle *b, int k, int e, const double *from, double *x, double *all) {
  lanes y[4][3], d[6][3], r[6], left;
  double most = 0;
  load(b, k, from, y);
  differences(e, y, d);
  load(b, k, x, y);
  find_violation(b, e, y, r, &left);
  for (int l = 0; l < B; l++)
    if (!(left[l] <= most) && !isnan(most)) most = left[l];
  solve(b, e, r);
  for (int p = 0; p < e; p++) *(lanes *)(all + p * B) += r[p];
  move(b, e, d, r, y);
  store(b, k, y, x);
  return most;
}

HK_INLINE void push(const hk_rigid_bundle *b, int k, int e, const double *from, const double *all, double by,
                    double *v) {
  lanes y[4][3], d[6][3], r[6];
  load(b, k, from, y);
  differences(e, y, d);
  for (int p = 0; p < e; p++) r[p] = *row(all + p * B) * by;
  load(b, k, v, y);
  move(b, e, d, r, y);
  store(b, k, y, v);
}

HK_INLINE void rattle(const hk_rigid_bundle *b, int k, int e, const double *x, double by, double *v, double *lambda) {
  lanes y[4][3], d[6][3], w[6][3], r[6];
  load(b, k, x, y);
  differences(e, y, d);
  load(b, k, v, y);
  differences(e, y, w);
  for (int p = 0; p < e; p++) r[p] = -(d[p][0] * w[p][0] + d[p][1] * w[p][1] + d[p][2] * w[p][2]);
  solve(b, e, r);
  move(b, e, d, r, y);
  store(b, k, y, v);
  for (int p = 0; p < e; p++)
    for (int l = 0; l < b->used; l++) lambda[b->equation[p][l]] = -by * r[p][l] / b->per_length[p][l];
}

#define HK_EACH_SIZE(call, ...)                                                                                        \
  b->size == 4 ? call(b, 4, 6, __VA_ARGS__) : b->size == 3 ? call(b, 3, 3, __VA_ARGS__) : call(b, 2, 1, __VA_ARGS__)

HK_VERSIONS(static bool, shake_any, (const hk_rigid_bundle *b, const double *from, double h, double *x, double *v),
            return HK_EACH_SIZE(shake, from, h, x, v))

HK_VERSIONS(static void, rattle_any, (const hk_rigid_bundle *b, const double *x, double by, double *v, double *lambda),
            HK_EACH_SIZE(rattle, x, by, v, lambda))

HK_VERSIONS(static double, round_any, (const hk_rigid_bundle *b, const double *from, double *x, double *all),
            return HK_EACH_SIZE(round_of, from, x, all))

HK_VERSIONS(static void, push_any,
            (const hk_rigid_bundle *b, const double *from, const double *all, double by, double *v),
            HK_EACH_SIZE(push, from, all, by, v))

double hk_rigid_bundle_round(int width, const hk_rigid_bundle *b, const double *from, double *x, double *all) {
  return HK_WIDEST(width, round_any)(b, from, x, all);
}

void hk_rigid_bundle_push(int width, const hk_rigid_bundle *b, const double *from, const double *all, double by,
                          double *v) {
  HK_WIDEST(width, push_any)(b, from, all, by, v);
}

bool hk_rigid_bundle_shake(int width, const hk_rigid_bundle *b, const double *from, double h, double *x, double *v) {
  return HK_WIDEST(width, shake_any)(b, from, h, x, v);
}

void hk_rigid_bundle_rattle(int width, const hk_rigid_bundle *b, const double *x, double by, double *v,
                            double *lambda) {
  HK_WIDEST(width, rattle_any)(b, x, by, v, lambda);
}

bool hk_rigid_bundle_factorize(hk_rigid_bundle *b, int lane, const double square[4][4]) {
  int e = b->size * (b->size - 1) / 2;
  for (int p = 0; p < e; p++)
    for (int q = 0; q <= p; q++) {
      const uint8_t *i = pair_of[p], *j = pair_of[q];
      double product = (square[i[0]][j[1]] + square[i[1]][j[0]] - square[i[0]][j[0]] - square[i[1]][j[1]]) / 2, sum = 0;
      for (int s = 0; s < 2; s++)
        for (int t = 0; t < 2; t++)
          if (i[s] == j[t]) sum += (s == t ? 1 : -1) * b->weight[i[s]][lane] * product;
      double own = sum;
      for (int m = 0; m < q; m++) sum -= b->factor[HK_RIGID_AT(p, m)][lane] * b->factor[HK_RIGID_AT(q, m)][lane];
      if (p == q && !(sum > 1e-9 * own)) return false; /* flat, or no such body */
      b->factor[HK_RIGID_AT(p, q)][lane] = p == q ? 1 / sqrt(sum) : sum * b->factor[HK_RIGID_AT(q, q)][lane];
    }
  for (int p = 0; p < e; p++) {
    b->square[p][lane] = square[pair_of[p][0]][pair_of[p][1]];
    b->per_length[p][lane] = 1 / sqrt(b->square[p][lane]);
  }
  return true;
}
