/* One step of RATTLE, from X at t to `next` at t_next, in a scene whose constraints are all equalities. With F/m
 * without constraint forces and W the inverse masses, v_m = v + h/2 (F/m + W J^T l),  x' = x + h v_m,  g(x') = 0,   J
 * at x, v' = v_m + h/2 (F'/m + W J'^T l'),  J' v' = 0,                J' at x', symplectic, reversible and of order 2
 * (Andersen 1983; Leimkuhler and Skeel 1994). As its positions and velocities are both on the constraints, steps of any
 * lengths, also backwards in time, may follow each other: symmetric compositions of it have the order that they have
 * without constraints (Reich 1996, SIAM J. Numer. Anal. 33; Hairer, Lubich and Wanner, Geometric Numerical Integration,
 * II.4 and VII.1.4).
 *
 * Positions may be kept as sums x + low, low being what rounding has taken of them (Kahan 1965; Hairer, Lubich and
 * Wanner, VIII.5): the constraints are solved for x, and x' + low' = x + low + h v_m holds beyond rounding, so that
 * errors of x do not turn into impulses along J. Without it the energy of a top of 4 particles drifts seven
 * times as fast, by -3e-18 of itself a step (tests/bench/top.c).
 *
 * The slope that is kept, a' = 2 (v' - v_m)/h, has the constraint forces in it, so that the next step begins near its
 * end; velocity-dependent forces see 2 v_m - v. Channels and work y are predicted and averaged. */
#ifndef HK_KIT_RATTLE_H
#define HK_KIT_RATTLE_H

#include "core/plugin.h"

/* x_next = x + h v_middle, v_middle = v + h/2 a. */
static inline void hk_rattle_drift(double *restrict x_next, double *restrict v_middle, const double *restrict x,
                                   const double *restrict v, const double *restrict a, size_t count, double h) {
  double half = h / 2;
  for (size_t e = 0; e < count; e++) {
    v_middle[e] = v[e] + half * a[e];
    x_next[e] = x[e] + h * v_middle[e];
  }
}

/* The same of x + low. */
static inline void hk_rattle_drift_whole(double *restrict x_next, double *restrict v_middle, const double *restrict x,
                                         const double *restrict v, const double *restrict a, const double *restrict low,
                                         size_t count, double h) {
  double half = h / 2;
  for (size_t e = 0; e < count; e++) {
    v_middle[e] = v[e] + half * a[e];
    x_next[e] = x[e] + (h * v_middle[e] + low[e]);
  }
}

/* low = x + low + h v_middle - x_next, for particles that move freely; others are where the host puts them. */
static inline void hk_rattle_keep_low(double *restrict low, const double *restrict x_next,
                                      const double *restrict v_middle, const double *restrict x,
                                      const double *restrict inverse_mass, size_t n, double h) {
  for (size_t e = 0; e < 3 * n; e++)
    low[e] = inverse_mass[e / 3] > 0 ? ((x[e] - x_next[e]) + h * v_middle[e]) + low[e] : 0;
}

/* v = the end's velocity, extrapolated, becomes that with the forces at the end; `a` keeps the one in the middle. */
static inline void hk_rattle_kick(double *restrict v, const double *restrict before, double *restrict a, size_t count,
                                  double by) {
  for (size_t e = 0; e < count; e++) {
    double middle = 0.5 * (before[e] + v[e]);
    v[e] = middle + by * a[e];
    a[e] = middle;
  }
}

/* Of h s, not 0, of either sign, with s->constraint->takes_constraints false. a (n x 3) and dy (size - 6n) are the
 * slopes at X, with or without constraint forces, and become those at `next`. X and next are shaped as s->X, and do not
 * overlap. low: n x 3, m, 0 at first, becomes that at `next`; NULL: positions are rounded in every step. After a
 * failure a, dy, low and next are of no use. */
static inline hk_status hk_rattle_step_whole(hk_system *s, double t, double *X, double t_next, double h, double *next,
                                             double *a, double *dy, double *low) {
  size_t v = 3 * s->n, y = 6 * s->n, rest = s->size - y;
  double work = 0, given = 0;
  if (low)
    hk_rattle_drift_whole(next, next + v, X, X + v, a, low, v, h);
  else
    hk_rattle_drift(next, next + v, X, X + v, a, v, h);
  /* `shake` is all that hosts of contract 3.0 have. */
  hk_status status = t == s->t ? s->constraint->shake(s, t_next, X, h, next, next + v, &work)
                               : s->constraint->shake_from(s, t, X, t_next, h, next, next + v, &work);
  if (status != HK_OK) return status;
  if (low) hk_rattle_keep_low(low, next, next + v, X, s->model->inverse_mass, s->n, h);
  for (size_t e = 0; e < rest; e++) next[y + e] = X[y + e] + h * dy[e];
  for (size_t e = 0; e < v; e++) next[v + e] += next[v + e] - X[v + e]; /* from the middle of the step to its end */
  status = s->accelerations(s, t_next, next, next + v, next + y, a, dy);
  if (status != HK_OK) return status;
  hk_rattle_kick(next + v, X + v, a, v, h / 2);
  status = s->constraint->rattle(s, t_next, next, h, next + v, &given);
  if (status != HK_OK) return status;
  dy[rest - 1] += 2 / h * given; /* the power of constraint forces, as `a` has the forces */
  for (size_t e = 0; e < v; e++) a[e] = 2 / h * (next[v + e] - a[e]);
  for (size_t e = 0; e < rest; e++) next[y + e] = 0.5 * (X[y + e] + next[y + e]) + h / 2 * dy[e];
  next[s->size - 1] += work;
  return HK_OK;
}

static inline hk_status hk_rattle_step(hk_system *s, double t, double *X, double t_next, double h, double *next,
                                       double *a, double *dy) {
  return hk_rattle_step_whole(s, t, X, t_next, h, next, a, dy, NULL);
}

#endif
