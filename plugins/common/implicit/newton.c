/* See newton.h. Invariant of the iteration: R is the filtered residual at the X of the stage, so every direction is
 * computed from the last evaluation, and an iteration costs one evaluation. */
#include "plugins/common/implicit/newton.h"
#include "plugins/common/implicit/carry_pins.h"
#include "plugins/common/implicit/safe_move.h"
#include "plugins/common/integrate/step_control.h"
#include "plugins/common/linear/block_product.h"

#include <float.h>
#include <string.h>

enum { BACKTRACKS = 10, DOUBTFUL = 8, DEFINITE_FOR = 8, LONGEST = 5 };

/* Iterations for the channels at one v: where particles exchange a quantity, the blocks leave a linear rate of up to
 * 0.87 (h k = 3/2 in a chain), which reaches a millionth. */
enum { PATIENCE = 100 };

static const double slow = 0.2, rounding = 16 * DBL_EPSILON, forcing = 0.1, drop = 1e-3;

/* In contact an inexact direction is shortened where it meets a surface, and the next one costs a search for pairs: 20
 * x 20 on a ball, 36 steps of a frame, take 552 iterations and 344 factorisations with this, 616 and 256 without. */
static const double forcing_in_contact = 0.01;

typedef struct work {
  hk_newton *w;
  hk_system *s;
  const hk_stage *stage;
  size_t m; /* 3n */
  double *a, *R, *dv, *v_old, *p, *q, *z, *r;
  unsigned flags; /* flags of the solver */
  bool by_size;   /* the line search requires |R| to decrease; otherwise it judges p.R */
  bool fresh;     /* the factors are those of the present iterate */
  bool settled;   /* the channels solve their equation at the present v */
  bool doubtful;  /* steps were shortened: the solution may be another one than that beside the start */
  hk_matrix A;
} work;

double hk_newton_limit(hk_newton *w, const hk_system *s, const double *v) {
  double now = hk_rms_moving(s, v);
  if (now > w->speed) w->speed = now;
  return w->tolerance * w->speed;
}

void hk_newton_forget(hk_newton *w) {
  w->factor_g = 0;
  w->definite = 0;
  w->krylov = w->chord = (hk_shortcut){0};
  hk_channels_forget(&w->channels);
}

hk_status hk_newton_create(void *self, const hk_host *host, const hk_view *view) {
  return hk_channels_open(&((hk_newton *)self)->channels, host, view);
}

void hk_newton_destroy(void *self, const hk_host *host) {
  (void)host;
  hk_channels_close(&((hk_newton *)self)->channels);
}

hk_status hk_newton_topology(void *self, const hk_view *view) { return hk_newton_create(self, view->host, view); }

static work begin(hk_newton *w, hk_system *s, const hk_stage *stage) {
  size_t m = 3 * s->n;
  double *at = w->memory;
  work k = {.w = w, .s = s, .stage = stage, .m = m, .a = at};
  at += s->size; /* the first array: a and dy */
  k.R = at, k.dv = at + m, at += s->size;
  k.v_old = at, k.p = at + m, at += s->size;
  k.q = at, k.z = at + m, at += s->size;
  k.r = at;
  return k;
}

static void set_positions(const work *k) {
  const double *restrict base = k->stage->base;
  double *restrict X = k->stage->X, g = k->stage->g;
  for (size_t e = 0; e < k->m; e++) X[e] = base[e] + g * X[k->m + e];
}

/* Improves y by the rates of the last evaluation. `moved`: v is another one than at the last call. */
static hk_status set_channels(work *k, bool moved) {
  return hk_channels_improve(&k->w->channels, k->s, k->stage, k->a + k->m, k->w->tolerance, moved, &k->settled);
}

/* R = M (v - v* - g a) at v; sets x of the stage as well. */
static hk_status residual(work *k) {
  const hk_stage *stage = k->stage;
  hk_system *s = k->s;
  double *X = stage->X, *v = X + k->m, g = stage->g;
  set_positions(k);
  hk_status status = s->accelerations(s, stage->t, X, v, X + 2 * k->m, k->a, k->a + k->m);
  if (status != HK_OK) return status;
  for (size_t i = 0; i < s->n; i++)
    for (size_t e = 3 * i; e < 3 * i + 3; e++)
      k->R[e] = s->model->mass[i] * (v[e] - stage->base[k->m + e] - g * k->a[e]);
  s->filter(s, k->R);
  return HK_OK;
}

static hk_status assemble(work *k) {
  hk_matrix K, D;
  double g = k->stage->g;
  unsigned want = k->flags & HK_SOLVES_UNSYMMETRIC ? 0 : HK_WANT_SYMMETRIC;
  if (k->w->definite > 0) want |= HK_WANT_DEFINITE;
  hk_status status = k->s->linear->jacobian(k->s, k->stage->t, k->stage->X, want, &K, &D);
  return status == HK_OK ? k->s->linear->combine(k->s, 1, g, g * g, &k->A) : status;
}

static hk_status solve(work *k, const double *b, double *x) {
  hk_solve_info info = {.tolerance = k->flags & HK_ITERATIVE ? forcing : 0};
  return k->s->linear->solve(k->s, b, x, &info);
}

static void negate(double *to, const double *from, size_t count) {
  for (size_t e = 0; e < count; e++) to[e] = -from[e];
}

static hk_status chord_direction(work *k) {
  negate(k->p, k->R, k->m);
  return solve(k, k->p, k->dv);
}

static hk_status factorize_and_solve(work *k) {
  hk_status status = k->s->linear->factorize(k->s, &k->A);
  k->w->factor_g = 0;
  if (status != HK_OK) return status;
  k->w->factor_g = k->stage->g;
  k->w->rate = 0;
  k->fresh = true;
  if (k->w->definite > 0) k->w->definite--;
  return chord_direction(k);
}

/* Conjugate gradients on A dv = -R with the present factors as preconditioner. False: convergence is too slow, or A is
 * not positive definite; dv is then invalid. */
static bool krylov(work *k) {
  size_t m = k->m;
  double *r = k->r, *p = k->p, *q = k->q, *z = k->z;
  negate(r, k->R, m);
  memset(k->dv, 0, m * sizeof *k->dv);
  double rz = 0, first = 0, part = k->s->contact ? forcing_in_contact : forcing;
  for (int i = 0; i <= k->w->krylov_most; i++) {
    if (k->s->linear->solve(k->s, r, z, NULL) != HK_OK) return false;
    k->s->filter(k->s, z);
    double next = hk_inner_product(r, z, m);
    if (!(next >= 0)) return false;
    if (i == 0) first = next;
    if (next <= part * part * first) return true;
    for (size_t e = 0; e < m; e++) p[e] = i == 0 ? z[e] : z[e] + next / rz * p[e];
    rz = next;
    hk_block_product(k->s->host, &k->A, p, q);
    double curvature = hk_inner_product(p, q, m);
    if (!(curvature > 0)) return false;
    double alpha = rz / curvature;
    for (size_t e = 0; e < m; e++) {
      k->dv[e] += alpha * p[e];
      r[e] -= alpha * q[e];
    }
  }
  return false;
}

/* Whether a shortcut is to be tried now: after every further failure in a row it is omitted for twice as long. */
static bool pays(hk_shortcut *c) {
  if (c->wait == 0) return true;
  c->wait--;
  return false;
}

static void judge(hk_shortcut *c, bool good) {
  c->failures = good ? 0 : c->failures < LONGEST ? c->failures + 1 : LONGEST;
  c->wait = good ? 0 : (1 << c->failures) - 1;
}

/* The Newton direction from the matrix of the present iterate. */
static hk_status newton_direction(work *k) {
  bool stale = k->w->factor_g > 0 && k->w->reuse && !k->fresh && !k->by_size && !(k->flags & HK_ITERATIVE);
  hk_status status = assemble(k);
  if (status != HK_OK) return status;
  if (stale && pays(&k->w->krylov)) {
    bool solved = krylov(k);
    judge(&k->w->krylov, solved);
    if (solved && k->w->definite > 0) k->w->definite--;
    if (solved) return HK_OK;
  }
  status = factorize_and_solve(k);
  if (status != HK_NOT_CONVERGED || k->w->definite > 0) return status;
  k->w->definite = DEFINITE_FOR;
  status = assemble(k);
  return status == HK_OK ? factorize_and_solve(k) : status;
}

static void advance(const work *k, double alpha) {
  double *v = k->stage->X + k->m;
  for (size_t e = 0; e < k->m; e++) v[e] = k->v_old[e] + alpha * k->dv[e];
}

/* Whether a step is too long: p.R is positive and above 0.9 of its initial size, or |R| has not decreased. */
static bool overshoots(const work *k, double slope, double size) {
  if (k->by_size) return !(hk_inner_product(k->R, k->R, k->m) <= size);
  return !(hk_inner_product(k->dv, k->R, k->m) <= -0.9 * slope);
}

/* The safe fraction of dv; 1 in scenes without contact. */
static hk_status safe_part(work *k, double *part) {
  *part = 1;
  if (!k->s->contact) return HK_OK;
  for (size_t e = 0; e < k->m; e++) k->q[e] = k->stage->g * k->dv[e];
  return hk_safe_part(k->s, k->stage->t, k->stage->X, k->q, k->z, part);
}

/* Evaluates the incremental potential at the start of a line search, where the stage minimises one. */
static hk_status begin_descent(work *k, double slope, hk_descent *d) {
  *d = (hk_descent){.known = hk_stage_minimises(k->s), .slope = slope};
  return d->known ? hk_stage_potential(k->s, k->stage, &d->start) : HK_OK;
}

static hk_status judge_step(work *k, const hk_descent *d, double alpha, double size, bool *good) {
  double value = 0;
  *good = !overshoots(k, d->slope, size);
  if (!d->known) return HK_OK;
  hk_status status = hk_stage_potential(k->s, k->stage, &value);
  *good = hk_descent_falls(d, value, alpha, *good);
  return status;
}

/* Searches along dv from v_old for a step that is not too long; R is then that of the new v. HK_NOT_CONVERGED: there is
 * none. */
static hk_status search(work *k, double *taken) {
  double slope = hk_inner_product(k->dv, k->R, k->m), size = hk_inner_product(k->R, k->R, k->m), alpha = 1;
  bool descends = slope < 0 || k->by_size, good = false;
  hk_descent descent;
  hk_status status = safe_part(k, &alpha);
  if (status == HK_OK) status = begin_descent(k, slope, &descent);
  if (status != HK_OK) return status;
  if (descent.known) descends = slope < 0;
  for (int i = 0; i < BACKTRACKS && descends; i++, alpha /= 2) {
    advance(k, alpha);
    status = residual(k);
    *taken = alpha;
    if (status == HK_NOT_FINITE) continue;
    if (status == HK_OK) status = judge_step(k, &descent, alpha, size, &good);
    if (status != HK_OK || good) return status;
  }
  return HK_NOT_CONVERGED;
}

static hk_status gave_up(const work *k, double size, double limit) {
  return k->s->host->fail(k->s->host, HK_NOT_CONVERGED,
                          "Newton's iteration stands at a change of %.3g m/s after %lld iterations, where %.3g m/s is "
                          "asked: the step may be too long for the forces",
                          size, (long long)k->w->iterations, limit);
}

/* Observed convergence of the iteration. */
typedef struct pace {
  double last; /* size of the last change; 0: not comparable */
  double rate; /* rate of convergence; 1 until it has been observed */
  bool chord;  /* uses the factors of an earlier iterate */
} pace;

/* The factors of an earlier stage are tried first when they have converged well, or have not been tried yet. */
static pace start_pace(const work *k) {
  const hk_newton *w = k->w;
  bool same = w->factor_g > 0 && fabs(w->factor_g - k->stage->g) <= 1e-9 * k->stage->g;
  bool chord = same && w->reuse && !(k->flags & HK_ITERATIVE) && pays(&k->w->chord);
  return (pace){0, chord && w->rate > 0 ? fmax(w->rate, slow) : 1, chord};
}

/* sqrt(dv.A dv / 3M) for A dv = -R, M being the moving mass: like |dv|, but a change that stretches springs counts by
 * the energy it adds to them. */
static double energy_norm(const work *k) {
  double mass = 0;
  for (size_t i = 0; i < k->s->n; i++) mass += k->s->model->inverse_mass[i] > 0 ? k->s->model->mass[i] : 0;
  return mass > 0 ? sqrt(fabs(hk_inner_product(k->dv, k->R, k->m)) / (3 * mass)) : 0;
}

static hk_status next_direction(work *k, pace *p, double *size) {
  hk_status status = p->chord ? chord_direction(k) : newton_direction(k);
  if (status != HK_OK) return status;
  k->s->filter(k->s, k->dv);
  *size = k->by_size ? hk_rms_free(k->s, k->dv) : energy_norm(k);
  if (p->last > 0) p->rate = fmax(0.3 * p->rate, *size / p->last);
  if (p->last > 0 && p->chord) k->w->rate = p->rate;
  return isnan(*size) ? HK_NOT_FINITE : HK_OK;
}

/* The line search failed: starts again from the same v, with the matrix of this v, and after that with blocks projected
 * to positive semi-definite. */
static hk_status fall_back(work *k, pace *p, double size, double limit) {
  if (k->fresh && k->w->definite > 0) return gave_up(k, size, limit);
  if (k->fresh) k->w->definite = DEFINITE_FOR;
  k->w->factor_g = 0;
  k->fresh = false;
  k->doubtful = true;
  *p = (pace){0, 1, false};
  memcpy(k->stage->X + k->m, k->v_old, k->m * sizeof *k->v_old);
  return residual(k);
}

/* Solves the channels' equation at the present v. R then belongs to a y that differs by less than is allowed. */
static hk_status solve_channels(work *k) {
  hk_status status = HK_OK;
  for (int i = 0; i < PATIENCE && status == HK_OK && !k->settled; i++) {
    status = residual(k);
    if (status == HK_OK) status = set_channels(k, false);
  }
  if (status == HK_OK && k->settled) return HK_OK;
  if (status != HK_OK && status != HK_NOT_CONVERGED) return status;
  return k->s->host->fail(
      k->s->host, HK_NOT_CONVERGED,
      "the iteration for the channels does not converge at t = %.17g s: the step may be too long for "
      "their rates",
      k->stage->t);
}

static hk_status iterate(work *k) {
  const hk_stage *stage = k->stage;
  double floor = rounding * (hk_rms_free(k->s, stage->X) / stage->g + hk_rms_moving(k->s, stage->X + k->m));
  double limit = stage->limit, size = 0;
  pace p = start_pace(k);
  for (int64_t i = 0; i < k->w->iterations; i++) {
    hk_status status = solve_channels(k);
    if (status == HK_OK) status = next_direction(k, &p, &size);
    if (status != HK_OK) return status;
    if (i == 0 && stage->fixed) limit = fmin(limit, fmax(drop, k->w->tolerance) * size);
    memcpy(k->v_old, stage->X + k->m, k->m * sizeof *k->v_old);
    bool close = size * fmin(1, p.rate) <= limit || hk_rms_free(k->s, k->dv) <= floor;
    double alpha = 1;
    if (close) {
      status = safe_part(k, &alpha);
      advance(k, alpha);
      set_positions(k);
      return status;
    }
    status = search(k, &alpha);
    if (status == HK_NOT_CONVERGED) {
      if (p.chord) judge(&k->w->chord, false);
      status = fall_back(k, &p, size, limit);
      if (status != HK_OK) return status;
      continue;
    }
    if (status == HK_OK) status = set_channels(k, true);
    if (status != HK_OK) return status;
    k->doubtful |= alpha < 1 || i >= DOUBTFUL;
    bool full = alpha == 1, was = p.chord, slows = p.last > 0 && size > slow * p.last;
    if (was && (slows || !full)) judge(&k->w->chord, false);
    if (was && p.last > 0 && !slows && full) judge(&k->w->chord, true);
    p.chord = k->w->reuse && full && !slows && (was || (k->fresh && pays(&k->w->chord))) && !(k->flags & HK_ITERATIVE);
    p.last = full ? size : 0;
    if (!full) p.rate = 1;
    k->fresh = false;
  }
  return gave_up(k, size, limit);
}

/* A solution behind a barrier, above the state in which nothing moves, is given up for the one beside that: implicit
 * steps that are long beside buckling have several, and can go to and fro between them for ever. In a scene with
 * contact every search descends on the incremental potential, and no state may be tried that contact was not told of.
 */
static hk_status require_minimum(work *k) {
  const double *power = k->a + k->m + (k->s->size - 2 * k->m - 1);
  bool above = false;
  for (int tries = 0;; tries++) {
    hk_status status = hk_stage_above_rest(k->s, k->stage, *power, k->q, &above);
    if (status != HK_OK || !above) return status;
    if (tries)
      return k->s->host->fail(k->s->host, HK_NOT_CONVERGED, "the step is too long: Newton's iteration ends above rest");
    memcpy(k->stage->X + k->m, k->q, k->m * sizeof *k->q);
    k->w->factor_g = 0;
    status = residual(k);
    if (status == HK_OK) status = set_channels(k, true);
    if (status == HK_OK) status = iterate(k);
    if (status != HK_OK) return status;
  }
}

static hk_status start_safely(work *k) {
  bool safe = true;
  hk_status status = hk_safe_start(k->s, k->stage, k->q, k->z, &safe);
  if (status != HK_OK || safe) return status;
  k->w->factor_g = 0;
  return hk_carry_pins(k->s, k->stage, k->a, k->R);
}

hk_status hk_newton_solve(hk_newton *w, hk_system *s, const hk_stage *stage) {
  work k = begin(w, s, stage);
  hk_status status = s->linear->solver_flags(s, &k.flags);
  if (status == HK_OK && s->contact) status = start_safely(&k);
  if (status == HK_OK) status = residual(&k);
  if (status == HK_OK) status = set_channels(&k, true);
  k.by_size = k.flags & HK_SOLVES_UNSYMMETRIC || hk_system_equations(s) > 0;
  if (status == HK_OK) status = iterate(&k);
  if (status == HK_OK && k.doubtful && !k.by_size && !s->contact) status = require_minimum(&k);
  if (status == HK_NOT_CONVERGED) hk_newton_forget(w);
  return status;
}
