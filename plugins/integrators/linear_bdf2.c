/* Backward differences of order 2 with one linearisation and one linear solve a step, for stiff springs. With the ratio
 * q of this step to the last, g = h (1 + q)/(1 + 2 q) and X* = X + q^2/(1 + 2 q) (X - X_before), the step is
 *     X' = X* + g f(t + h, X'),   f linearised at v^ = v, x^ = x* + g v:
 *     (M + g D + g^2 K) (v' - v^) = -M (v^ - v* - g a(x^, v^)),   x' = x* + g v'.
 *
 * The guess v^ = v is of order 2 in x and carries no differences of velocities, in which the fast modes are noise: with
 * any extrapolation of v, stiff springs are compressed at the guess, and steps have to be several times shorter. What
 * is left of the guess bends the paths, by which a stiff spring at x^ is strained far more than it ever is in the
 * motion. So K takes for the springs' tensions those that the last step's linearisation foretold (hk_blocks): it is the
 * difference between one Newton iteration and all of them. Curtain of 32 x 32, k = 1e6 N/m, 0.5 s, steps of 2
 * ms: 9.3e-3 m with the tensions at x^, 1.7e-3 m with those foretold, 1.7e-3 m iterated to convergence; at 1e8 N/m and
 * 1 ms 1.1e-2 and 8e-4 m. Without the unsymmetric terms of K the error is the same to three digits, so solvers for
 * symmetric matrices do; with blocks projected to positive semi-definite it is 2 to 4 times larger, so they are taken
 * only where the factorization of the step's own matrix has failed, and what they leave out is corrected once. (Curtain
 * of 64 x 64, 1e8 N/m, tol from 0.9e-3 to 1.1e-3: 7.4 to 13.9 mm; projected for 8 steps after a failure, 12.5 to 16.5
 * mm in a sixth less time; never corrected, 139 mm. Projected for one step after a failure, 48 x 48, 0.3 s at 1e8 N/m:
 * 215 factorizations instead of 346 and 5.8 mm instead of 2.6 at tol 1e-3, 138 and 5.2 instead of 204 and 3.7 at
 * 0.9e-3. A factorization that fails costs little, as it ends at its first bad pivot, which solvers look for where the
 * last one was: by supernodal, 64 squared, 3.3 ms where a whole one takes 23 to 31. Of whole ones 1.2 a step are made
 * at 1e7 N/m and 1.1 at 1e8, beside 0.7 and 0.9 that fail, 0.25 s in 70 and 76 steps. The correction takes the blocks
 * of the step's own matrix as they were, without unsymmetric terms: with them, by a further Jacobian, 30 runs of 24 and
 * 32 squared at 1e7 and 1e8 N/m took 1 % fewer steps, a twelfth more time for each, and were off by 6.2 instead of 5.9
 * mm in the mean.)
 *
 * The error is that of the predictor by X, X_before and f(X), whose distance from the corrector is (2 + 3 q)/(1 + q)
 * times the corrector's error. It is that of positions and channels. In the limit of stiff springs velocities are of
 * index 2: their errors count h times (Hairer, Lubich and Roche 1989, Lecture Notes in Mathematics 1409), which is how
 * the positions have them. Measured by themselves they do not fall with h until the fast modes are resolved, and steps
 * collapse in vain, and jumps of their lengths stir the fast modes up: the curtain of 64 x 64, 1e7 N/m, took 439 steps
 * for 5.6e-3 m and its energy was off by 0.34, and takes 148 for 5.0e-3 m with 0.007. The coefficients are those of the
 * variable step, which at most doubles (zero-stability ends at 1 + sqrt 2). The first step, and the first one after a
 * change that voids the history, is one of TR-BDF2, and so is every step in a scene with contact, whose forces one
 * linearisation does not hold apart. Channels' equations are solved at the guess and at the end.
 *
 * Tried and left: the error of positions multiplied by (M + g D + g^2 K)^-1 M (fewer steps are repeated, but the error
 * for a number of factorizations is the same); extrapolated guesses (with the tensions at x^ they diverge at 2 ms, with
 * those foretold they change nothing up to 2 ms and fail at 4); further corrections by the same matrix (they diverge,
 * as the stiff directions turn with the guess); gradients through the negative curvature of the exact matrix (steps
 * half as long for the same tol, and up to 1000 iterations on 64 x 64).
 * Hairer, Norsett and Wanner, Solving ODEs I, III.5; Choi and Ko 2002, one linearisation; Tournier and others 2015,
 * tensions from the step before.
 *
 * Cloth of 8 x 8 particles with k = 1e6 N/m to 1e-3 m takes it a quarter of the time of bdf2, the next of those here:
 * 1.7 ms, bdf2 6.5, implicit_trapezoid and imex 8.0, implicit_midpoint 9.4, tr_bdf2 17, esdirk4 and backward_euler 19
 * (hooke bench scripts/scenes/stiff_cloth.lua N=8 k=1e6 --until 0.15 --target 1e-3).
 */
#include "plugins/common/implicit/dirk.h"
#include "plugins/common/linear/block_product.h"
#include "plugins/kit/integrate/growth_factor.h"

#include <float.h>
#include <string.h>

enum { PATIENCE = 100 };

static const double safety = 0.9, least = 0.2, most = 2, keep = 1.3, algebraic = 0.02;
static const double rounding = 16 * DBL_EPSILON; /* of a coordinate: what its differences are off by is no error */

typedef struct linear_bdf2 {
  hk_dirk start; /* first member: the parameters and most fields are its own */
  double residual;
  /* fields */
  int64_t known;      /* whether `before` is the state at t - h */
  int64_t linear;     /* whether the last step was linear, with `linearised` */
  double h;           /* s, of the last step */
  double *before;     /* the state before it */
  double *linearised; /* the guess of its linearisation */
  bool told;          /* of the steps in contact */
  hk_linear_step how; /* the last step was taken */
  /* The step's own matrix where it was not definite: the blocks, of which there is memory for `room`. */
  double *own;
  size_t room;
} linear_bdf2;

static const hk_param params[] = {
    HK_NEWTON_PARAMS(hk_dirk, 1e-3, "of steps by TR-BDF2: algebraic error of velocities, relative to the largest speed",
                     12, "of steps by TR-BDF2: iterations of Newton's method in a stage, at most"),
    {"residual", "", "residual of the linear system that will do an iterative solver, relative to the right-hand side",
     .number = HK_AT(linear_bdf2, residual), .initial = {1e-2}, .limits = HK_ABOVE_TO(0, 1)},
    {0},
};

static const hk_field fields[] = {
    {"primed", .integer = HK_AT(linear_bdf2, start.primed)},
    {"started", .integer = HK_AT(linear_bdf2, start.started)},
    {"wait", .integer = HK_AT(linear_bdf2, start.wait)},
    {"proposal", .number = HK_AT(linear_bdf2, start.proposal)},
    {"last_error", .number = HK_AT(linear_bdf2, start.last_error)},
    {"newton_speed", .number = HK_AT(linear_bdf2, start.newton.speed)},
    {"speed", .number = HK_AT(linear_bdf2, start.scales.speed)},
    {"acceleration", .number = HK_AT(linear_bdf2, start.scales.acceleration)},
    {"slope", .state = HK_AT(linear_bdf2, start.slope), .width = 1},
    {"known", .integer = HK_AT(linear_bdf2, known)},
    {"linear", .integer = HK_AT(linear_bdf2, linear)},
    {"h", .number = HK_AT(linear_bdf2, h)},
    {"before", .state = HK_AT(linear_bdf2, before), .width = 1},
    {"linearised", .state = HK_AT(linear_bdf2, linearised), .width = 1},
    {"stages", .state = HK_AT(linear_bdf2, start.k), .width = HK_DIRK_STATES, .flags = HK_SCRATCH},
    {"newton", .state = HK_AT(linear_bdf2, start.newton.memory), .width = HK_NEWTON_STATES, .flags = HK_SCRATCH},
    {0},
};

/* As bdf2's: of a linear equation one linearisation is exact. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  return hb == 0 ? hk_bdf2_growth(hw, hg) : NAN;
}

static void reset(void *self, hk_reason why) {
  linear_bdf2 *m = self;
  if (why == HK_STEP_CHANGED) return;
  if (why != HK_CHECKPOINT) m->known = m->linear = 0;
  hk_dirk_reset(&m->start, why);
}

/* A step that is tried: scratch, shaped as X but for R and dv (n x 3); `a` with dy behind it. */
typedef struct trial {
  double q, g;
  double *base, *X, *predicted, *guess, *E, *a, *R, *dv, *refined;
} trial;

static trial begin(const linear_bdf2 *m, const hk_system *s, double h) {
  size_t z = s->size, v = 3 * s->n;
  double *k = m->start.k, *more = m->start.newton.memory, q = h / m->h;
  return (trial){q,
                 h * (1 + q) / (1 + 2 * q),
                 k,
                 k + z,
                 k + 2 * z,
                 k + 3 * z,
                 k + 4 * z,
                 more,
                 more + z,
                 more + 2 * z,
                 more + 2 * z + v};
}

/* X*, the predictor, and the guess of the stage. */
static void predict(const linear_bdf2 *m, const hk_system *s, double h, const trial *w) {
  const double *X = s->X, *before = m->before, *f = m->start.slope;
  size_t v = 3 * s->n;
  double qq = w->q * w->q, back = qq / (1 + 2 * w->q);
  for (size_t e = 0; e < s->size; e++) {
    double rate = e < v ? X[v + e] : f[e];
    w->base[e] = X[e] + back * (X[e] - before[e]);
    w->predicted[e] = X[e] + h * rate + qq * (before[e] - X[e] + m->h * rate);
    w->X[e] = e < 2 * v ? X[e] : w->predicted[e];
  }
}

/* R = -M (v - v* - g a) at v; sets x of the stage as well. */
static hk_status residual(hk_system *s, double t, const trial *w) {
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) w->X[e] = w->base[e] + w->g * w->X[v + e];
  hk_status status = s->accelerations(s, t, w->X, w->X + v, w->X + 2 * v, w->a, w->a + v);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < v; e++) w->R[e] = -s->model->mass[e / 3] * (w->X[v + e] - w->base[v + e] - w->g * w->a[e]);
  s->filter(s, w->R);
  return HK_OK;
}

/* The residual at the guess, where the channels solve their equation. */
static hk_status evaluate(linear_bdf2 *m, hk_system *s, double t, const trial *w) {
  hk_newton *newton = &m->start.newton;
  const hk_stage stage = {t, w->g, 0, w->base, w->X, false, fmin(algebraic * s->tol, newton->tolerance)};
  bool settled = false;
  for (int i = 0; i < PATIENCE && !settled; i++) {
    hk_status status = residual(s, t, w);
    double *dy = w->a + 3 * s->n;
    if (status == HK_OK)
      status = hk_channels_improve(&newton->channels, s, &stage, dy, newton->tolerance, i == 0, &settled);
    if (status != HK_OK) return status;
  }
  return settled ? HK_OK : HK_NOT_CONVERGED;
}

static void give_linearisation(const linear_bdf2 *m, hk_system *s) {
  s->linear->linearised = m->linear ? m->linearised : NULL;
  s->linear->reached = m->linear ? s->X : NULL;
}

static hk_status linearise(linear_bdf2 *m, hk_system *s, double t, const trial *w, unsigned want, hk_matrix *A) {
  hk_matrix K, D;
  *A = (hk_matrix){0};
  give_linearisation(m, s);
  hk_status status = s->linear->jacobian(s, t, w->X, want, &K, &D);
  s->linear->linearised = s->linear->reached = NULL;
  if (status == HK_OK) status = s->linear->combine(s, 1, w->g, w->g * w->g, A);
  return status == HK_OK ? s->linear->factorize(s, A) : status;
}

static hk_status solve(hk_system *s, const double *b, double *x, double tolerance) {
  hk_solve_info info = {.tolerance = tolerance};
  hk_status status = s->linear->solve(s, b, x, &info);
  if (status == HK_OK) s->filter(s, x);
  return status;
}

/* Copies A, whose memory the next combination takes. */
static hk_status keep_own(linear_bdf2 *m, hk_system *s, hk_matrix *A) {
  size_t count = A->block * A->block * A->row_start[A->rows];
  if (count > m->room) {
    s->host->release(s->host, m->own);
    m->own = s->host->allocate(s->host, count * sizeof *m->own);
    m->room = m->own ? count : 0;
    if (!m->own) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for a second matrix of %zu rows", A->rows);
  }
  memcpy(m->own, A->value, count * sizeof *m->own);
  A->value = m->own;
  return HK_OK;
}

/* Once more for what the projection of the blocks left out: dv += A^-1 (R - A' dv), with the step's own matrix A'. */
static hk_status refine(linear_bdf2 *m, hk_system *s, const trial *w, const hk_matrix *own) {
  size_t v = 3 * s->n;
  double *of_own = w->guess;
  hk_block_product(s->host, own, w->dv, of_own);
  for (size_t e = 0; e < v; e++) w->R[e] -= of_own[e];
  s->filter(s, w->R);
  hk_status status = solve(s, w->R, w->refined, m->residual);
  for (size_t e = 0; e < v; e++) w->dv[e] += w->refined[e];
  return status;
}

static hk_status correct(linear_bdf2 *m, hk_system *s, double t, const trial *w) {
  unsigned flags, want = 0;
  hk_matrix own, definite;
  hk_status status = s->linear->solver_flags(s, &flags);
  if (status != HK_OK) return status;
  if (!(flags & HK_SOLVES_UNSYMMETRIC)) want = HK_WANT_SYMMETRIC;
  memset(w->refined, 0, 3 * s->n * sizeof *w->refined);
  status = linearise(m, s, t, w, want, &own);
  if (status == HK_OK) status = solve(s, w->R, w->dv, m->residual);
  if (status != HK_NOT_CONVERGED || !own.value) return status;
  status = keep_own(m, s, &own);
  if (status == HK_OK) status = linearise(m, s, t, w, want | HK_WANT_DEFINITE, &definite);
  if (status == HK_OK) status = solve(s, w->R, w->dv, m->residual);
  return status == HK_OK ? refine(m, s, w, &own) : status;
}

/* The new state; channels that depend on v solve their equation there. */
static hk_status advance(linear_bdf2 *m, hk_system *s, double t, const trial *w) {
  size_t v = 3 * s->n;
  memcpy(w->guess, w->X, s->size * sizeof *w->X);
  for (size_t e = 0; e < v; e++) w->X[v + e] += w->dv[e];
  return evaluate(m, s, t, w);
}

/* The error of the positions and channels relative to the tolerance. */
static hk_status estimate(const linear_bdf2 *m, hk_system *s, double h, const trial *w, double *error) {
  size_t v = 3 * s->n;
  double part = (1 + w->q) / (2 + 3 * w->q), *E = w->E;
  for (size_t e = 0; e < s->size; e++) E[e] = part * (w->X[e] - w->predicted[e]);
  s->filter(s, E);
  for (size_t e = 0; e < v; e++) {
    double off = fabs(E[e]) - rounding * fabs(w->X[e]); /* NaN stays */
    E[e] = (off < 0 ? 0 : off) + w->g * fabs(w->refined[e]);
    E[v + e] = 0;
  }
  hk_channels_solve(&m->start.newton.channels, E + 2 * v, w->dv);
  memcpy(E + 2 * v, w->dv, (s->size - 2 * v - 1) * sizeof *E);
  *error = hk_scales_error(&m->start.scales, s, h, w->X, w->a, E) / s->tol;
  return HK_OK;
}

/* A step of h into w->X; its error is infinite where it fails. */
static hk_status attempt(linear_bdf2 *m, hk_system *s, double h, trial *w, double *error) {
  *error = INFINITY;
  *w = begin(m, s, h);
  predict(m, s, h, w);
  hk_status status = evaluate(m, s, s->t + h, w);
  if (status == HK_OK) status = correct(m, s, s->t + h, w);
  if (status == HK_OK) status = advance(m, s, s->t + h, w);
  if (status == HK_OK) status = estimate(m, s, h, w, error);
  if (isnan(*error)) *error = INFINITY;
  return status == HK_NOT_CONVERGED || status == HK_NOT_FINITE ? HK_OK : status;
}

static double change_of(double error) {
  double change = fmin(most, fmax(least, safety * pow(fmax(error, 1e-10), -1.0 / 3)));
  return change >= 1 && change < keep ? 1 : change; /* equal steps keep a direct solver's and the channels' factors */
}

static void take(linear_bdf2 *m, hk_system *s, double h, double wanted, bool retried, double error, const trial *w,
                 hk_step *out) {
  size_t v = 3 * s->n;
  double next = h * change_of(error);
  if (retried) next = fmin(next, h);
  if (!retried && h < wanted) next = fmax(next, wanted);
  memcpy(m->before, s->X, s->size * sizeof *s->X);
  memcpy(s->X, w->X, s->size * sizeof *s->X);
  memcpy(m->linearised, w->guess, s->size * sizeof *s->X);
  memcpy(m->start.slope, s->X + v, v * sizeof *s->X);
  for (size_t e = v; e < s->size; e++) m->start.slope[e] = (w->X[e] - w->base[e]) / w->g;
  hk_scales_notice(&m->start.scales, s, s->X + v, m->start.slope + v);
  m->linear = 1;
  m->how = HK_STEP_LINEAR;
  m->h = h;
  m->start.last_error = fmax(error, 1e-4);
  m->start.proposal = next;
  *out = (hk_step){h, next, error};
}

static void tell_of_contact(linear_bdf2 *m, const hk_system *s) {
  if (!s->contact || m->told) return;
  m->told = true;
  s->host->warn(s->host,
                "a force of contact is not followed by one linearisation: every step is one of TR-BDF2, with two "
                "stages and as short as tol asks for; --integrator bdf2 takes fixed steps, such as --dt of a "
                "frame, which cost a tenth and damp, or take the corrector contact in place of the force");
}

/* The first step, and every one in contact. */
static hk_status start(linear_bdf2 *m, hk_system *s, double t_stop, double h, hk_step *out) {
  tell_of_contact(m, s);
  m->how = m->start.primed ? HK_STEP_OF_START : HK_STEP_AFRESH;
  memcpy(m->linearised, s->X, s->size * sizeof *s->X);
  hk_status status = hk_dirk_adaptive_step(&m->start, &hk_tr_bdf2, s, t_stop, h, out);
  if (status != HK_OK) return status;
  memcpy(m->before, m->linearised, s->size * sizeof *s->X);
  m->linear = 0;
  m->known = !s->contact;
  m->h = out->h;
  return HK_OK;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  linear_bdf2 *m = self;
  double span = t_stop - s->t, error;
  if (!m->known || s->contact) return start(m, s, t_stop, h, out);
  double wanted = fmax(h, m->start.proposal);
  trial w;
  (void)method;
  h = fmin(fmin(h, span), most * m->h);
  h = span / fmax(1, ceil(span / h * (1 - 1e-9)));
  for (bool retried = false;; retried = true) {
    hk_status status = attempt(m, s, h, &w, &error);
    if (status != HK_OK) return status;
    if (error <= 1) {
      take(m, s, h, wanted, retried, error, &w, out);
      return HK_OK;
    }
    h *= error < INFINITY ? fmin(0.9, change_of(error)) : 0.25;
    /* what one linearisation does not follow, Newton may; and a jump of a force is passed there */
    double shortest = hk_shortest_step(s, span);
    if (h < 1e-3 * m->h || !(h > shortest)) return start(m, s, t_stop, fmax(h, shortest), out);
  }
}

static hk_linear_step how(const void *self) { return ((const linear_bdf2 *)self)->how; }

static void destroy(void *self, const hk_host *host) {
  linear_bdf2 *m = self;
  host->release(host, m->own);
  m->own = NULL;
  m->room = 0;
  hk_newton_destroy(&m->start.newton, host);
}

static const hk_adaptive_facet adaptive = {.size = sizeof adaptive, .tolerance = 1e-3};
static const hk_stages_facet stages = {.size = sizeof stages,
                                       .count = 1,
                                       .c = {1},
                                       .x = {{4. / 9}},
                                       .v = {{2. / 3}},
                                       .x_end = {4. / 9},
                                       .v_end = {2. / 3},
                                       .back = 1. / 3,
                                       .start = &hk_tr_bdf2_stages,
                                       .linear = how};
static const hk_facet facets[] = {{HK_ADAPTIVE_ID, &adaptive}, {HK_STAGES_ID, &stages}, {0}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 1,
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_ADAPTIVE,
                                         .step = step,
                                         .reset = reset,
                                         .growth = growth,
                                         .facets = facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "linear_bdf2",
    .summary = "backward differences with one linearisation a step; order 2, L-stable, chooses its steps; for stiff "
               "springs and errors that may be seen",
    .reference = "Choi and Ko 2002, Stable but responsive cloth; Hairer, Norsett and Wanner, Solving ODEs I, III.5",
    .instance_size = sizeof(linear_bdf2),
    .params = params,
    .fields = fields,
    .create = hk_newton_create,
    .destroy = destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
