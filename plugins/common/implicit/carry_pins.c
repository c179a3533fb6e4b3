/* See carry_pins.h. With z the way that scripted particles have left and y the change of their velocities, the residual
 * R = M (v - v*) - g F of the others vanishes, to first order, for
 *     (M + g D + g^2 K) dv = -R - g (K z + D y).
 * Invariant: stage->X has no overlap and has the scripted particles where they are at the time t. */
#include "plugins/common/implicit/carry_pins.h"
#include "plugins/common/implicit/safe_move.h"
#include "plugins/common/linear/block_product.h"

#include <string.h>

/* Moves at most, and halvings of one: a way takes as many moves as layers have to give way one after the other, and a
 * path is a straight line but for the square of its length. */
enum { MOVES = 64, SHORTENINGS = 8 };

typedef struct way {
  hk_system *s;
  const hk_stage *stage;
  size_t m;
  double t; /* until which the scripted particles have come */
  double *a, *R, *dv, *z, *y;
  double *p, *q; /* products; the displacement, and scratch */
  double *to;    /* 2 m: positions and velocities after the move */
} way;

static way begin(hk_system *s, const hk_stage *stage, double *slopes, double *memory) {
  size_t m = 3 * s->n;
  way w = {.s = s, .stage = stage, .m = m, .t = s->t, .a = slopes};
  double **at[] = {&w.R, &w.dv, &w.z, &w.y, &w.p, &w.q, &w.to};
  for (size_t k = 0; k < sizeof at / sizeof *at; k++) *at[k] = memory + k * m;
  memcpy(stage->X, s->X, m * sizeof *stage->X);
  for (size_t e = 0; e < m; e++) stage->X[m + e] = (s->X[e] - stage->base[e]) / stage->g;
  s->impose(s, s->t, stage->X, stage->X + m);
  return w;
}

static bool is_scripted(const way *w, size_t e) { return !(w->s->model->inverse_mass[e / 3] > 0); }

/* z and y: from now to the stage's time. */
static void rest_of_way(way *w) {
  const double *X = w->stage->X;
  memcpy(w->to, X, 2 * w->m * sizeof *X);
  w->s->impose(w->s, w->stage->t, w->to, w->to + w->m);
  for (size_t e = 0; e < w->m; e++) {
    w->z[e] = is_scripted(w, e) ? w->to[e] - X[e] : 0;
    w->y[e] = is_scripted(w, e) ? w->to[w->m + e] - X[w->m + e] : 0;
  }
}

static hk_status residual(way *w) {
  hk_system *s = w->s;
  const hk_stage *stage = w->stage;
  double *v = stage->X + w->m;
  hk_status status = s->accelerations(s, w->t, stage->X, v, v + w->m, w->a, w->a + w->m);
  for (size_t e = 0; e < w->m && status == HK_OK; e++)
    w->R[e] = s->model->mass[e / 3] * (v[e] - stage->base[w->m + e] - stage->g * w->a[e]);
  return status;
}

static hk_status direction(way *w) {
  hk_system *s = w->s;
  hk_matrix K, D, A;
  double g = w->stage->g;
  unsigned flags, want = HK_WANT_DEFINITE;
  hk_status status = s->linear->solver_flags(s, &flags);
  if (status == HK_OK) status = residual(w);
  if (status != HK_OK) return status;
  if (!(flags & HK_SOLVES_UNSYMMETRIC)) want |= HK_WANT_SYMMETRIC;
  status = s->linear->jacobian(s, w->t, w->stage->X, want, &K, &D);
  if (status != HK_OK) return status;
  hk_block_product(s->host, &K, w->z, w->p);
  hk_block_product(s->host, &D, w->y, w->q);
  for (size_t e = 0; e < w->m; e++) w->R[e] = -w->R[e] - g * (w->p[e] + w->q[e]);
  s->filter(s, w->R);
  status = s->linear->combine(s, 1, g, g * g, &A);
  if (status == HK_OK) status = s->linear->factorize(s, &A);
  if (status == HK_OK) status = s->linear->solve(s, w->R, w->dv, NULL);
  if (status == HK_OK) s->filter(s, w->dv);
  return status;
}

/* Tries the part alpha of the move; *part: the safe part of that. */
static hk_status try_move(way *w, double alpha, double *part) {
  const double *X = w->stage->X;
  double g = w->stage->g, t = alpha < 1 ? w->t + alpha * (w->stage->t - w->t) : w->stage->t;
  for (size_t e = 0; e < w->m; e++) {
    w->to[w->m + e] = X[w->m + e] + alpha * w->dv[e];
    w->to[e] = X[e] + g * alpha * w->dv[e];
  }
  w->s->impose(w->s, t, w->to, w->to + w->m);
  for (size_t e = 0; e < w->m; e++) w->p[e] = w->to[e] - X[e];
  return hk_safe_part(w->s, t, X, w->p, w->q, part);
}

/* The longest of some safe parts of the move is taken. *alpha: that part; 0: none. */
static hk_status move(way *w, double *alpha) {
  double part = 1;
  *alpha = 1;
  for (int k = 0; k < SHORTENINGS; k++) {
    hk_status status = try_move(w, *alpha, &part);
    if (status != HK_OK) return status;
    if (part >= 1) {
      memcpy(w->stage->X, w->to, 2 * w->m * sizeof *w->to);
      w->t = *alpha < 1 ? w->t + *alpha * (w->stage->t - w->t) : w->stage->t;
      return HK_OK;
    }
    *alpha *= 0.9 * part; /* the part is that of a straight line, which the path leaves a little */
  }
  *alpha = 0;
  return HK_OK;
}

static hk_status blocked(const way *w) {
  return w->s->host->fail(w->s->host, HK_NOT_CONVERGED,
                          "scripted particles move into contact at t = %.17g s, and what is in their way cannot give "
                          "way: the step is too long, or there is no room",
                          w->t);
}

hk_status hk_carry_pins(hk_system *s, const hk_stage *stage, double *slopes, double *memory) {
  way w = begin(s, stage, slopes, memory);
  double alpha = 0, zero = 0;
  for (int k = 0; k < MOVES; k++) {
    rest_of_way(&w);
    memset(w.p, 0, w.m * sizeof *w.p);
    hk_status status = k == 0 ? hk_safe_part(s, w.t, stage->X, w.p, w.q, &zero) : HK_OK;
    if (status == HK_OK) status = direction(&w);
    if (status == HK_OK) status = move(&w, &alpha);
    if (status != HK_OK) return status;
    if (alpha == 0) return blocked(&w);
    if (w.t == stage->t) return HK_OK;
  }
  return blocked(&w);
}
