/* See dirk.h. A step that fails leaves X unchanged: stages are computed in scratch memory and copied after success. */
#include "plugins/common/implicit/dirk.h"
#include "plugins/kit/integrate/growth_factor.h"
#include "plugins/common/implicit/safe_move.h"

#include <complex.h>
#include <float.h>
#include <string.h>

static const double safety = 0.9, least = 0.2, most = 5, algebraic = 0.02, keep = 1.3;

/* Bank and others 1985, as a Runge-Kutta method: Hosea and Shampine 1996, Applied Numerical Mathematics 20. The
 * embedded method is of order 3. */
const hk_dirk_tableau hk_tr_bdf2 = {
    .stages = 3,
    .c = {0, 0.58578643762690495, 1},
    .a = {{0},
          {0.29289321881345248, 0.29289321881345248},
          {0.35355339059327376, 0.35355339059327376, 0.29289321881345248}},
    .b = {0.35355339059327376, 0.35355339059327376, 0.29289321881345248},
    .error = {0.35355339059327376 - 0.21548220313557542, 0.35355339059327376 - 0.68688672392660714,
              0.29289321881345248 - 0.09763107293781749},
    .error_order = 2,
};

/* x is A A. */
#define G 0.29289321881345248
#define W 0.35355339059327376
const hk_stages_facet hk_tr_bdf2_stages = {.size = sizeof hk_tr_bdf2_stages,
                                           .count = 3,
                                           .carries = true,
                                           .c = {0, 2 * G, 1},
                                           .x = {{0}, {G * G, G *G}, {2 * W * G, 2 * W *G, G *G}},
                                           .v = {{0}, {G, G}, {W, W, G}},
                                           .x_end = {2 * W * G, 2 * W *G, G *G},
                                           .v_end = {W, W, G}};

const hk_param hk_dirk_params[] = {
    HK_NEWTON_PARAMS(hk_dirk, 1e-6, "algebraic error of a step's velocities, relative to the largest RMS speed so far",
                     100, "of Newton's method in a stage, at most; then the step is halved"),
    {0},
};

const hk_param hk_dirk_adaptive_params[] = {
    HK_NEWTON_PARAMS(hk_dirk, 1e-3,
                     "algebraic error of a step's velocities, relative to the largest RMS speed so far; less where tol "
                     "asks for less",
                     12, "of Newton's method in a stage, at most; then the step is made shorter"),
    {0},
};

const hk_field hk_dirk_fields[] = {
    {"primed", .integer = HK_AT(hk_dirk, primed)},
    {"started", .integer = HK_AT(hk_dirk, started)},
    {"wait", .integer = HK_AT(hk_dirk, wait)},
    {"proposal", .number = HK_AT(hk_dirk, proposal)},
    {"last_error", .number = HK_AT(hk_dirk, last_error)},
    {"newton_speed", .number = HK_AT(hk_dirk, newton.speed)},
    {"speed", .number = HK_AT(hk_dirk, scales.speed)},
    {"acceleration", .number = HK_AT(hk_dirk, scales.acceleration)},
    {"slope", .state = HK_AT(hk_dirk, slope), .width = 1},
    {"stages", .state = HK_AT(hk_dirk, k), .width = HK_DIRK_STATES, .flags = HK_SCRATCH},
    {"newton", .state = HK_AT(hk_dirk, newton.memory), .width = HK_NEWTON_STATES, .flags = HK_SCRATCH},
    {0},
};

static void add(double *restrict to, const double *restrict k, size_t count, double w) {
  if (w == 0) return;
  for (size_t e = 0; e < count; e++) to[e] += w * k[e];
}

static double *slope_of(const hk_dirk *m, const hk_system *s, int i) { return m->k + (size_t)i * s->size; }

/* The initial guess of a stage: v := v* + g a, with a from the latest known slope. */
static void guess(const hk_system *s, double g, const double *a, const double *base, double *X) {
  size_t v = 3 * s->n;
  memcpy(X, base, s->size * sizeof *X);
  if (a) add(X + v, a + v, v, g);
}

static void take_slope(const hk_system *s, double g, const double *base, const double *X, double *k) {
  size_t v = 3 * s->n;
  memcpy(k, X + v, v * sizeof *k);
  for (size_t e = v; e < s->size; e++) k[e] = (X[e] - base[e]) / g;
}

static hk_status first_slope(hk_dirk *m, hk_system *s, double *k) {
  size_t v = 3 * s->n;
  if (!m->primed) return s->rates(s, s->t, s->X, k);
  memcpy(k, s->X + v, v * sizeof *k);
  memcpy(k + v, m->slope + v, (s->size - v) * sizeof *k);
  return HK_OK;
}

static bool stiffly_accurate(const hk_dirk_tableau *T) {
  for (int j = 0; j < T->stages; j++)
    if (T->b[j] != T->a[T->stages - 1][j]) return false;
  return true;
}

hk_status hk_dirk_stages(hk_dirk *m, const hk_dirk_tableau *T, hk_system *s, double h, double limit, double **X_new) {
  double *base = slope_of(m, s, T->stages), *X = slope_of(m, s, T->stages + 1);
  const double *known = m->primed ? m->slope : NULL;
  for (int i = 0; i < T->stages; i++) {
    double *k = slope_of(m, s, i), g = h * T->a[i][i];
    hk_status status = HK_OK;
    if (g == 0)
      status = first_slope(m, s, k);
    else {
      memcpy(base, s->X, s->size * sizeof *base);
      for (int j = 0; j < i; j++) add(base, slope_of(m, s, j), s->size, h * T->a[i][j]);
      guess(s, g, known, base, X);
      hk_stage stage = {s->t + T->c[i] * h, g, limit, base, X, limit < 0, 0};
      if (limit >= 0) stage.channels = fmin(algebraic * s->tol, m->newton.tolerance);
      if (limit < 0) stage.limit = hk_newton_limit(&m->newton, s, X + 3 * s->n);
      status = hk_newton_solve(&m->newton, s, &stage);
      if (status == HK_OK) take_slope(s, g, base, X, k);
    }
    if (status != HK_OK) return status;
    known = k;
  }
  *X_new = X;
  if (stiffly_accurate(T)) return HK_OK;
  memcpy(base, X, s->size * sizeof *X);
  memcpy(X, s->X, s->size * sizeof *X);
  for (int j = 0; j < T->stages; j++) add(X, slope_of(m, s, j), s->size, h * T->b[j]);
  if (!s->contact) return HK_OK;
  return hk_safe_end(s, s->t + h, base, X, m->newton.memory, m->newton.memory + 3 * s->n);
}

static void accept(hk_dirk *m, const hk_dirk_tableau *T, hk_system *s, const double *X) {
  memcpy(s->X, X, s->size * sizeof *X);
  memcpy(m->slope, slope_of(m, s, T->stages - 1), s->size * sizeof *X);
  m->primed = 1;
}

hk_status hk_dirk_step(void *self, const void *T, hk_system *s, double t_stop, double h, hk_step *out) {
  hk_dirk *m = self;
  double *X = NULL;
  (void)t_stop, (void)out;
  hk_status status = hk_dirk_stages(m, T, s, h, -1, &X);
  if (status != HK_OK) return status;
  accept(m, T, s, X);
  hk_newton_limit(&m->newton, s, s->X + 3 * s->n);
  return HK_OK;
}

/* x = (M + g D + g^2 K)^-1 M b with the present factors; b is overwritten. */
static hk_status smooth_out(hk_system *s, double *b, double *x) {
  for (size_t i = 0; i < s->n; i++)
    for (size_t e = 3 * i; e < 3 * i + 3; e++) b[e] *= s->model->mass[i];
  s->filter(s, b);
  hk_status status = s->linear->solve(s, b, x, NULL);
  if (status == HK_OK) s->filter(s, x);
  return status;
}

/* The error estimate h sum e_i k_i, multiplied by (M + g D + g^2 K)^-1 M, and for the
 * channels by (I - g dy'/dy)^-1, so that its stiff components are damped as by
 * the method itself (Hosea and Shampine 1996, section 3). */
static hk_status estimate(hk_dirk *m, const hk_dirk_tableau *T, hk_system *s, double h, const double *X,
                          double *error) {
  double *E = slope_of(m, s, T->stages), *smooth = slope_of(m, s, 0);
  size_t v = 3 * s->n;
  memset(E, 0, s->size * sizeof *E);
  for (int j = 1; j < T->stages; j++) { /* weights sum to 0: with k_j - k_0 steady motion has no error */
    const double *restrict k = slope_of(m, s, j), *restrict first = slope_of(m, s, 0);
    for (size_t e = 0; e < s->size; e++) E[e] += h * T->error[j] * (k[e] - first[e]);
  }
  hk_status status = smooth_out(s, E, smooth);
  if (status == HK_OK) status = smooth_out(s, E + v, smooth + v);
  if (status != HK_OK) return status;
  hk_channels_solve(&m->newton.channels, E + 2 * v, smooth + 2 * v);
  smooth[s->size - 1] = 0;
  *error = hk_scales_error(&m->scales, s, h, X, slope_of(m, s, T->stages - 1) + v, smooth) / s->tol;
  return HK_OK;
}

/* The algebraic error allowed in a stage: small compared with the error tolerance in x and in v. */
static double limit_of(const hk_dirk *m, const hk_system *s, double g, double h) {
  double L = hk_scales_extent(&m->scales, s, s->X);
  double V = fmax(hk_scales_speed(&m->scales, L, h), h * m->scales.acceleration);
  double asked = algebraic * s->tol * fmin(L / g, V);
  return fmin(asked, m->newton.tolerance * V);
}

static hk_status begin_step(hk_dirk *m, const hk_dirk_tableau *T, hk_system *s, double span, double *h) {
  size_t v = 3 * s->n;
  hk_status status = HK_OK;
  double *a = slope_of(m, s, 0);
  if (!m->primed) {
    status = s->rates(s, s->t, s->X, a);
    if (status != HK_OK) return status;
    memcpy(m->slope, a, s->size * sizeof *a);
    m->primed = 1;
  }
  hk_scales_notice(&m->scales, s, s->X + v, m->slope + v);
  if (!(*h > 0) || *h > span) *h = span;
  if (m->started) return HK_OK;
  status = hk_scales_foresee(&m->scales, s, span, slope_of(m, s, 1), slope_of(m, s, 2));
  if (status != HK_OK) return status;
  double V, rate = hk_scales_rate(&m->scales, hk_scales_extent(&m->scales, s, s->X), &V);
  rate = fmax(rate, hk_channel_rate(s, s->X + 2 * v, m->slope + 2 * v));
  if (rate > 0) *h = fmin(*h, pow(0.01 * s->tol, 1.0 / (T->error_order + 1)) / rate);
  return HK_OK;
}

/* Divides the time to t_stop into equal steps, so that the factors remain valid from one to the next, and again after a
 * frame of the same length. */
static double equal_steps(double span, double h) {
  double pieces = ceil(span / h * (1 - 1e-9));
  return pieces > 1 && pieces < 1e15 ? span / pieces : fmin(h, span);
}

static double change_of(const hk_dirk *m, const hk_dirk_tableau *T, double error) {
  double order = T->error_order + 1, change = safety * pow(fmax(error, 1e-10), -1 / order);
  if (m->started && m->last_error > 0)
    change = fmin(change, change * pow(m->last_error / fmax(error, 1e-10), 0.4 / order));
  change = fmin(most, fmax(least, change));
  return change >= 1 && change < keep ? 1 : change; /* a slightly longer step is not worth a new factorization */
}

/* Accepts the step to X and proposes the next; `wanted` exceeds h when h was shortened to end at t_stop. */
static void take(hk_dirk *m, const hk_dirk_tableau *T, hk_system *s, const double *X, double h, double wanted,
                 bool retried, double error, hk_step *out) {
  double next = h * change_of(m, T, error);
  if (retried)
    next = fmin(next, h);
  else if (h < wanted)
    next = fmax(next, fmin(wanted, most * h));
  accept(m, T, s, X);
  hk_scales_notice(&m->scales, s, s->X + 3 * s->n, m->slope + 3 * s->n);
  m->started = 1;
  m->last_error = fmax(error, 1e-4);
  m->proposal = next;
  *out = (hk_step){h, next, error};
}

/* Computes a step of h into X; its error is infinite when the stages do not converge or are not finite. */
static hk_status attempt(hk_dirk *m, const hk_dirk_tableau *T, hk_system *s, double h, double **X, double *error) {
  double g = h * T->a[T->stages - 1][T->stages - 1];
  *error = INFINITY;
  hk_status status = hk_dirk_stages(m, T, s, h, limit_of(m, s, g, h), X);
  if (status == HK_OK) status = estimate(m, T, s, h, *X, error);
  return status == HK_NOT_CONVERGED || status == HK_NOT_FINITE ? HK_OK : status;
}

hk_status hk_dirk_adaptive_step(void *self, const void *T, hk_system *s, double t_stop, double h, hk_step *out) {
  hk_dirk *m = self;
  double span = t_stop - s->t, error, *X = NULL;
  hk_status status = begin_step(m, T, s, span, &h);
  if (status != HK_OK) return status;
  double wanted = m->started && m->proposal > h ? m->proposal : h;
  h = equal_steps(span, h);
  for (bool retried = false;; retried = true) {
    status = attempt(m, T, s, h, &X, &error);
    if (status != HK_OK) return status;
    double shorter = h * (error < INFINITY ? fmax(least, fmin(0.9, change_of(m, T, error))) : 0.25);
    bool jump = !(error <= 1) && !(shorter > hk_shortest_step(s, span)) && hk_jump_met(&m->wait, error);
    if (error <= 1 || jump) {
      take(m, T, s, X, h, wanted, retried, fmin(error, 1), out);
      if (jump)
        *out = (hk_step){h, m->proposal = h, NAN};
      else
        hk_jump_passed(&m->wait);
      return HK_OK;
    }
    h = shorter;
    if (h > hk_shortest_step(s, span)) continue;
    if (!isfinite(error)) return HK_NOT_FINITE; /* the host finds the particle and the force */
    return s->host->fail(s->host, HK_NOT_CONVERGED,
                         "no step from t = %.17g s meets the tolerance %g: tried down to %g s; give a larger tol, or "
                         "look for a force that jumps",
                         s->t, s->tol, h);
  }
}

void hk_dirk_reset(void *self, hk_reason why) {
  hk_dirk *m = self;
  if (why == HK_STEP_CHANGED) return;
  if (why != HK_CHECKPOINT) m->primed = 0;
  hk_newton_forget(&m->newton);
}

static double stability(const hk_dirk_tableau *T, double complex z) {
  double complex Y[HK_DIRK_STAGES], R = 1;
  for (int i = 0; i < T->stages; i++) {
    Y[i] = 1;
    for (int j = 0; j < i; j++) Y[i] += z * T->a[i][j] * Y[j];
    Y[i] /= 1 - z * T->a[i][i];
    R += z * T->b[i] * Y[i];
  }
  return cabs(R);
}

double hk_dirk_growth(const void *self, const void *T, double hw, double hg, double hb) {
  (void)self;
  double complex z[2];
  hk_oscillator_roots(hw, hg + hb * I, z);
  return fmax(stability(T, z[0]), stability(T, z[1]));
}
