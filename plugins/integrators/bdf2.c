/* Backward differences of order 2, X' = 4/3 X - 1/3 X_before + 2/3 h f(t + h, X'): L-stable, one stage per step. The
 * first step, and the first one after a change that invalidates the history (another h, events, births), is a step of
 * TR-BDF2, which also has order 2. Choi and Ko 2002 used it for cloth with one Newton iteration per step.
 *
 * After an impact the history has the velocities from before it, and extrapolating them makes energy; so does the
 * explicit stage of a first step that starts within the reach of a barrier. In a scene with contact a step that gains
 * energy is repeated with backward Euler, which has no history.
 *
 * Beside linear_bdf2 it solves the equations of a step, so that forces may be of any kind; beside implicit_trapezoid it
 * damps what it does not resolve, in 101 evaluations where that takes 116 (times in linear_bdf2.c).
 */
#include "plugins/common/implicit/dirk.h"
#include "plugins/kit/integrate/growth_factor.h"

#include <math.h>
#include <string.h>

typedef struct bdf2 {
  hk_dirk start; /* first member: hk_dirk_params */
  int64_t known; /* whether `before` is the state at t - h */
  double h;
  double *before;
} bdf2;

static const hk_field fields[] = {
    {"primed", .integer = HK_AT(bdf2, start.primed)},
    {"newton_speed", .number = HK_AT(bdf2, start.newton.speed)},
    {"slope", .state = HK_AT(bdf2, start.slope), .width = 1},
    {"known", .integer = HK_AT(bdf2, known)},
    {"h", .number = HK_AT(bdf2, h)},
    {"before", .state = HK_AT(bdf2, before), .width = 1},
    {"stages", .state = HK_AT(bdf2, start.k), .width = 5, .flags = HK_SCRATCH},
    {"newton", .state = HK_AT(bdf2, start.newton.memory), .width = HK_NEWTON_STATES, .flags = HK_SCRATCH},
    {0},
};

static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  return hb == 0 ? hk_bdf2_growth(hw, hg) : NAN;
}

static void reset(void *self, hk_reason why) {
  bdf2 *m = self;
  if (why != HK_CHECKPOINT) m->known = 0;
  hk_dirk_reset(&m->start, why);
}

/* Solves the stage X' = base + g f(t + h, X'), from the velocities in X. */
static hk_status solve(bdf2 *m, hk_system *s, double h, double g, const double *base, double *X) {
  size_t v = 3 * s->n;
  hk_stage stage = {s->t + h, g, hk_newton_limit(&m->start.newton, s, X + v), base, X, true, 0};
  hk_status status = hk_newton_solve(&m->start.newton, s, &stage);
  if (status != HK_OK) return status;
  memcpy(m->start.slope, X + v, v * sizeof *X);
  for (size_t e = v; e < s->size; e++) m->start.slope[e] = (X[e] - base[e]) / g;
  m->start.primed = 1;
  return HK_OK;
}

static hk_status advance(bdf2 *m, hk_system *s, double h, double *base, double *X) {
  size_t v = 3 * s->n;
  double g = 2 * h / 3;
  for (size_t e = 0; e < s->size; e++) X[e] = base[e] = s->X[e] + (s->X[e] - m->before[e]) / 3;
  for (size_t e = v; e < 2 * v; e++) X[e] += g * m->start.slope[e];
  return solve(m, s, h, g, base, X);
}

/* Backward Euler. */
static hk_status restart(bdf2 *m, hk_system *s, double h, double *base, double *X) {
  memcpy(base, s->X, s->size * sizeof *X);
  memcpy(X, s->X, s->size * sizeof *X);
  return solve(m, s, h, h, base, X);
}

static hk_status start(bdf2 *m, hk_system *s, double h, double **X) {
  hk_status status = hk_dirk_stages(&m->start, &hk_tr_bdf2, s, h, -1, X);
  if (status != HK_OK) return status;
  memcpy(m->start.slope, m->start.k + 2 * s->size, s->size * sizeof **X);
  m->start.primed = 1;
  return HK_OK;
}

/* J, without what was done on the scene. *kinetic: the part of it. */
static hk_status energy_of(hk_system *s, double t, const double *X, double *kinetic, double *whole) {
  double potential;
  hk_status status = s->contact->energy(s, t, X, kinetic, &potential);
  *whole = *kinetic + potential - X[s->size - 1];
  return status;
}

/* Whether the step to X gained more energy than the algebraic error of v makes, or a thousandth of v. */
static hk_status gains(const bdf2 *m, hk_system *s, double h, const double *X, bool *gained) {
  double kinetic[2], whole[2], part = 2 * fmax(m->start.newton.tolerance, 1e-3);
  hk_status status = energy_of(s, s->t, s->X, &kinetic[0], &whole[0]);
  if (status == HK_OK) status = energy_of(s, s->t + h, X, &kinetic[1], &whole[1]);
  *gained = whole[1] - whole[0] > part * fmax(kinetic[0], kinetic[1]);
  return status;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  bdf2 *m = self;
  double *base = m->start.k, *X = base + s->size;
  bool gained = false;
  (void)method, (void)t_stop, (void)out;
  hk_status status = m->known && h == m->h ? advance(m, s, h, base, X) : start(m, s, h, &X);
  if (status == HK_OK && s->contact) status = gains(m, s, h, X, &gained);
  if (status == HK_OK && gained) status = restart(m, s, h, base, X = base + s->size);
  if (status != HK_OK) return status;
  memcpy(m->before, s->X, s->size * sizeof *X);
  memcpy(s->X, X, s->size * sizeof *X);
  hk_newton_limit(&m->start.newton, s, s->X + 3 * s->n);
  m->known = 1;
  m->h = h;
  return HK_OK;
}

static const hk_integrator integrator = {
    .size = sizeof(hk_integrator),
    .order = 2,
    .stages = 1,
    .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN,
    .step = step,
    .reset = reset,
    .growth = growth,
    .facets = HK_FACETS(HK_STAGES_FACET(.count = 1, .c = {1}, .x = {{4. / 9}}, .v = {{2. / 3}}, .x_end = {4. / 9},
                                        .v_end = {2. / 3}, .back = 1. / 3, .start = &hk_tr_bdf2_stages))};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "bdf2",
    .summary = "backward differences, X' = 4/3 X - 1/3 X_before + 2/3 h f(X'); order 2, L-stable, one stage a step",
    .reference = "Hairer, Norsett and Wanner, Solving ODEs I, III.1; Choi and Ko 2002, Stable but responsive cloth",
    .instance_size = sizeof(bdf2),
    .params = hk_dirk_params,
    .fields = fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
