/* Stiff forces are integrated implicitly, the others explicitly: ARS(2,2,2), order 2, L-stable in the implicit part.
 * With g = 1 - sqrt(2)/2 and d = 1 - 1/(2g), E the explicit and I the implicit part (which includes dx/dt = v),
 *     X2 = X + h g E(X) + h g I(X2),   X' = X + h (d E(X) + (1 - d) E(X2)) + h ((1 - g) I(X2) + g I(X')).
 * Both stages have the same matrix, that of the implicit part. The implicit forces are those that `implicit` names; by
 * default, those that depend on positions and provide a symmetric Jacobian: springs, not wind or drag. Channels are
 * explicit. Ascher, Ruuth and Spiteri 1997, Applied Numerical Mathematics 25, section 2.6. The partition in space of
 * Boxerman and Ascher 2004 is not implemented.
 *
 * Better than bdf2 where wind or drag, without a symmetric Jacobian, would cost every step an unsymmetric solution;
 * with springs alone it takes 138 evaluations where bdf2 takes 101 (linear_bdf2.c).
 */
#include "plugins/common/implicit/dirk.h"

#include <string.h>

enum { BASE = 0, STATE = 1, EXPLICIT = 2, EXPLICIT_2 = 3, IMPLICIT = 4, STATES = 5 };

typedef struct imex {
  hk_newton newton;
  const char *names;
  double *memory;
} imex;

static const double g_ = 0.29289321881345248, d_ = -0.70710678118654752;

static const hk_param params[] = {
    HK_NEWTON_PARAMS(imex, 1e-6, "algebraic error of a step's velocities, relative to the largest RMS speed so far", 30,
                     "of Newton's method in a stage, at most; then the step is halved"),
    {"implicit", "", "labels of the forces to take implicitly, with spaces between", .string = HK_AT(imex, names)},
    {0},
};

static const hk_field fields[] = {
    {"newton_speed", .number = HK_AT(imex, newton.speed)},
    {"memory", .state = HK_AT(imex, memory), .width = STATES, .flags = HK_SCRATCH},
    {"newton", .state = HK_AT(imex, newton.memory), .width = HK_NEWTON_STATES, .flags = HK_SCRATCH},
    {0},
};

/* The factor of the implicit part, applied to the whole oscillator. The stable step of the method is that of the
 * explicit forces alone, which the linear oscillator does not determine. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  static const hk_dirk_tableau implicit = {
      .stages = 2,
      .c = {0.29289321881345248, 1},
      .a = {{0.29289321881345248}, {0.70710678118654752, 0.29289321881345248}},
      .b = {0.70710678118654752, 0.29289321881345248},
  };
  return hb == 0 ? hk_dirk_growth(NULL, &implicit, hw, hg, 0) : NAN;
}

static bool named(const char *names, const char *label) {
  size_t length = strlen(label);
  for (const char *at = strstr(names, label); at; at = strstr(at + 1, label))
    if ((at == names || at[-1] == ' ') && (at[length] == 0 || at[length] == ' ')) return true;
  return false;
}

static bool is_stiff(const imex *m, const hk_force_info *force) {
  if (m->names) return named(m->names, force->label);
  return force->jacobian && force->flags & HK_DEPENDS_ON_X &&
         force->flags & (HK_SYMMETRIC_JACOBIAN | HK_OFFERS_SYMMETRIC);
}

static hk_status check_forces(const imex *m, hk_system *s) {
  for (size_t k = 0; k < s->split->forces; k++)
    if (is_stiff(m, &s->split->force[k]) && !s->split->force[k].jacobian)
      return s->host->fail(s->host, HK_BAD_PARAM, "implicit: force '%s' has no Jacobian", s->split->force[k].label);
  return HK_OK;
}

static void take(const imex *m, hk_system *s, bool implicit) {
  for (size_t k = 0; k < s->split->forces; k++) s->split->takes[k] = is_stiff(m, &s->split->force[k]) == implicit;
  s->split->takes_channels = !implicit;
}

static double *vector(const imex *m, const hk_system *s, int which) { return m->memory + (size_t)which * s->size; }

/* The slope of the explicit part; its entries for x are 0. */
static hk_status explicit_slope(const imex *m, hk_system *s, double t, double *X, double *slope) {
  size_t v = 3 * s->n;
  take(m, s, false);
  memset(slope, 0, v * sizeof *slope);
  return s->accelerations(s, t, X, X + v, X + 2 * v, slope + v, slope + 2 * v);
}

static void add(double *restrict to, const double *restrict k, size_t count, double w) {
  for (size_t e = 0; e < count; e++) to[e] += w * k[e];
}

static hk_status solve(imex *m, hk_system *s, double t, double g) {
  double *base = vector(m, s, BASE), *X = vector(m, s, STATE);
  memcpy(X, base, s->size * sizeof *X);
  take(m, s, true);
  hk_stage stage = {t, g, hk_newton_limit(&m->newton, s, X + 3 * s->n), base, X, true, 0};
  return hk_newton_solve(&m->newton, s, &stage);
}

/* With constraints, J a + c = 0, the multipliers of each part cancel the contribution of its forces to J a. The
 * multipliers for c, which depends on the motion alone, belong to the implicit part; their contribution, the slope
 * without any force, is therefore subtracted from the explicit slope here. */
static hk_status leave_motion(const imex *m, hk_system *s, double t, double *X, double *slope) {
  size_t v = 3 * s->n;
  double *none = vector(m, s, IMPLICIT);
  if (hk_system_equations(s) == 0) return HK_OK;
  for (size_t k = 0; k < s->split->forces; k++) s->split->takes[k] = false;
  s->split->takes_channels = false;
  hk_status status = s->accelerations(s, t, X, X + v, X + 2 * v, none + v, none + 2 * v);
  for (size_t e = v; e < s->size; e++) slope[e] -= none[e];
  return status;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  imex *m = self;
  double *base = vector(m, s, BASE), *X = vector(m, s, STATE), *E = vector(m, s, EXPLICIT),
         *E2 = vector(m, s, EXPLICIT_2), *I = vector(m, s, IMPLICIT), g = g_ * h;
  (void)method, (void)t_stop, (void)out;
  hk_status status = check_forces(m, s);
  if (status == HK_OK) status = explicit_slope(m, s, s->t, s->X, E);
  if (status == HK_OK) status = leave_motion(m, s, s->t, s->X, E);
  if (status != HK_OK) return status;
  memcpy(base, s->X, s->size * sizeof *base);
  add(base, E, s->size, g);
  status = solve(m, s, s->t + g, g);
  if (status == HK_OK) status = explicit_slope(m, s, s->t + g, X, E2);
  if (status == HK_OK) status = leave_motion(m, s, s->t + g, X, E2);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < s->size; e++) I[e] = (X[e] - base[e]) / g;
  memcpy(base, s->X, s->size * sizeof *base);
  add(base, E, s->size, h * d_);
  add(base, E2, s->size, h * (1 - d_));
  add(base, I, s->size, h * (1 - g_));
  status = solve(m, s, s->t + h, g);
  if (status != HK_OK) return status;
  memcpy(s->X, X, s->size * sizeof *X);
  hk_newton_limit(&m->newton, s, s->X + 3 * s->n);
  return HK_OK;
}

static void reset(void *self, hk_reason why) {
  if (why != HK_STEP_CHANGED) hk_newton_forget(&((imex *)self)->newton);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 2,
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_SPLITS_FORCES,
                                         .step = step,
                                         .reset = reset,
                                         .growth = growth};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "imex",
    .summary = "stiff forces implicitly, the rest explicitly, ARS(2,2,2); order 2, L-stable for the stiff ones",
    .reference = "Ascher, Ruuth and Spiteri 1997, Applied Numerical Mathematics 25, section 2.6",
    .instance_size = sizeof(imex),
    .params = params,
    .fields = fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
