/* Leapfrog, or velocity Verlet, with one evaluation per step:
 *     x' = x + h (v + h/2 a),  a' = a(x', v + h a),  v' = v + h/2 (a + a').
 * The acceleration at the end is used again in the next step. Forces that depend on the velocity are evaluated with the
 * predicted v + h a, which keeps order 2 (the lagged v + h/2 a would give order 1) and limits the step to h w <= 2
 * (sqrt(1 + 4 xi^2) - 2 xi), xi = g/(2w), with damping rate g; for pure drag, h g <= 1. Channels and work y are
 * predicted and averaged in the same way. Without velocity-dependent forces it is symplectic and reversible. The
 * velocity is predicted even then, because the power of a force depends on it; at the end h/2 (a' - a) is added to it.
 * The new state is built apart, block by block with the evaluation; X changes only after that has succeeded.
 *
 * With constraints that are all equalities it is RATTLE (plugins/kit/integrate/rattle.h), still symplectic, reversible
 * and of order 2. */
#include "plugins/kit/integrate/leap.h"
#include "plugins/kit/integrate/leapfrog_growth.h"
#include "plugins/kit/integrate/rattle.h"

#include "core/plugin.h"

#include <math.h>

typedef struct leapfrog {
  int64_t primed; /* whether the slope is that of X */
  int64_t newest; /* which of the two a it is */
  double *slope;  /* a twice, n x 3 each, and dy */
} leapfrog;

static const hk_field fields[] = {
    {"primed", .integer = HK_AT(leapfrog, primed)},
    {"newest", .integer = HK_AT(leapfrog, newest)},
    {"slope", .state = HK_AT(leapfrog, slope), .width = 1},
    {0},
};

static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  return hk_leapfrog_growth(hw, hg, hb);
}

static void reset(void *self, hk_reason why) {
  (void)why;
  ((leapfrog *)self)->primed = 0;
}

/* Channels and work: predicted, and then with the mean of both rates. */
static void predict_rest(double *restrict next, const double *restrict y, const double *restrict dy, size_t count,
                         double h) {
  for (size_t e = 0; e < count; e++) next[e] = y[e] + h * dy[e];
}

static void kick_rest(double *restrict next, const double *restrict y, const double *restrict dy, size_t count,
                      double h) {
  for (size_t e = 0; e < count; e++) next[e] = 0.5 * (y[e] + next[e]) + h / 2 * dy[e];
}

/* The two slopes a, and dy behind them. */
static double *slope_of(const leapfrog *m, const hk_system *s, int64_t which) {
  return m->slope + (which % 2 ? 3 * s->n : 0);
}

static double *rates_of(const leapfrog *m, const hk_system *s) { return m->slope + 6 * s->n; }

static hk_status prime(leapfrog *m, hk_system *s) {
  size_t v = 3 * s->n;
  double *a = slope_of(m, s, m->newest);
  hk_status status = m->primed ? HK_OK : s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, a, rates_of(m, s));
  m->primed = 0; /* until the end of the step, which writes over the rates */
  return status;
}

/* The sum of m a.b over the free particles. */
static double dot(const hk_model *model, const double *a, const double *b) {
  double sum = 0;
  for (size_t i = 0; i < model->n; i++)
    if (model->inverse_mass[i] > 0)
      sum += model->mass[i] * (a[3 * i] * b[3 * i] + a[3 * i + 1] * b[3 * i + 1] + a[3 * i + 2] * b[3 * i + 2]);
  return sum;
}

/* kg m^2/s^4: by how much the sum of m (a^2 - b^2) has changed from the start of the step, in `spare`, to its end;
 * a_from and a_to are those there. b is what a correction leaves of a: none where it takes back what the velocity has
 * gained in the step, and all where it is not against it. end: before the correction. */
static double borne_more(const hk_system *s, const double *a_from, const double *a_to, const double *end) {
  const double *before = s->spare + 3 * s->n, *free = end + 3 * s->n, *v = s->X + 3 * s->n;
  double sum = 0;
  for (size_t i = 0; i < s->n; i++) {
    double from = 0, to = 0, gained = 0, square = 0;
    if (!(s->model->inverse_mass[i] > 0)) continue;
    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
      double change = v[k] - free[k];
      from += a_from[k] * change;
      to += a_to[k] * change;
      gained -= (free[k] - before[k]) * change;
      square += change * change;
    }
    if (!(square > 0) || !(gained > 0)) continue;
    double left = fmax(0, 1 - square / gained);
    sum += s->model->mass[i] * (1 - left * left) * (to * to - from * from) / square;
  }
  return sum;
}

/* J along the straight way from `spare` to s->X at one speed, by the mean of both ends: of all forces on free
 * particles, and of pins and forces without a potential. Writes over the velocities in `spare`, and over a. */
static hk_status work_along(hk_system *s, double h, double *a, double *forces, double *rest) {
  size_t count = 3 * s->n;
  double *x = s->spare, *v = x + count, *dy = v + count;
  hk_status status = HK_OK;
  for (size_t e = 0; e < count; e++) v[e] = (s->X[e] - x[e]) / h;
  for (int k = 0; k < 2 && status == HK_OK; k++) {
    status = s->accelerations(s, k ? s->t : s->t - h, k ? s->X : x, v, s->X + 2 * count, a, dy);
    *forces += h / 2 * dot(s->model, a, v);
    *rest += h / 2 * dy[s->size - 2 * count - 1];
  }
  return status;
}

/* A free step gives kinetic energy beyond the mean force times its way by exactly h^2/8 times the change of the sum of
 * m a^2 (multiply v' - v = h/2 (a + a') by v' + v = 2 (x' - x)/h + h/2 (a' - a)), where the work of linear damping is
 * that at the mean velocity of the step. What is beyond that along the way that a correction leaves is its work, so
 * that the balance keeps the method's error along this way. What contact bears falls in each step and is put back: the
 * curvature of a force along that fall is no error of the motion. */
static hk_status account(void *self, const void *method, hk_system *s, const double *end, double h, hk_corrected *out) {
  leapfrog *m = self;
  size_t v = 3 * s->n;
  double *from = slope_of(m, s, m->newest + 1), counted = end[s->size - 1] - s->spare[s->size - 1];
  double gained = (dot(s->model, s->X + v, s->X + v) - dot(s->model, s->spare + v, s->spare + v)) / 2;
  double forces = 0, rest = 0;
  (void)method;
  out->work = NAN;
  if (s->constraint) return HK_OK; /* RATTLE's slope is that of the next step, and multipliers of cables jump in it */
  hk_status status = prime(m, s);
  if (status != HK_OK) return status;
  const double *to = slope_of(m, s, m->newest);
  double kept = dot(s->model, to, to) - dot(s->model, from, from) - borne_more(s, from, to, end);
  status = work_along(s, h, from, &forces, &rest);
  m->primed = status == HK_OK;
  out->correction = gained - forces - h * h / 8 * kept;
  out->work = out->correction + rest - counted;
  return status;
}

/* The step in a scene with constraints: RATTLE. */
static hk_status constrained_step(leapfrog *m, hk_system *s, double t_next, double h) {
  s->constraint->takes_constraints = false;
  hk_status status = prime(m, s);
  if (status == HK_OK)
    status = hk_rattle_step(s, s->t, s->X, t_next, h, s->spare, slope_of(m, s, m->newest), rates_of(m, s));
  if (status != HK_OK) return status;
  s->exchange(s);
  m->primed = 1;
  return HK_OK;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  leapfrog *m = self;
  size_t v = 3 * s->n, y = 6 * s->n;
  double *X = s->X, *next = s->spare, *dy = rates_of(m, s), t_next = fmin(t_stop, s->t + h);
  (void)method, (void)out;
  if (s->constraint && s->constraint->holonomic) return constrained_step(m, s, t_next, h);
  hk_status status = prime(m, s);
  if (status != HK_OK) return status;
  double *a_next = slope_of(m, s, m->newest + 1);
  hk_leap l = {X, X + v, slope_of(m, s, m->newest), next, next + v, a_next, h, s->host->lanes};
  predict_rest(next + y, X + y, dy, s->size - y, h);
  status = s->fused(s, t_next, next, next + v, next + y, a_next, dy, &(hk_fused){&l, hk_leap_predict, hk_leap_correct});
  if (status != HK_OK) return status;
  kick_rest(next + y, X + y, dy, s->size - y, h);
  s->exchange(s);
  m->primed = 1;
  m->newest = !m->newest;
  return HK_OK;
}

static hk_status tile(void *self, const void *method, hk_system *s, const double *t, double h, size_t *count) {
  leapfrog *m = self;
  size_t v = 3 * s->n, work = 6 * s->n;
  double *X = s->X, *next = s->spare, *power = rates_of(m, s);
  hk_leap leaps[HK_TILE_STEPS];
  hk_tile_step step[HK_TILE_STEPS];
  (void)method;
  hk_status status = prime(m, s);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < *count; k++) {
    double *a_next = slope_of(m, s, m->newest + (int64_t)k + 1);
    leaps[k] = (hk_leap){X, X + v, slope_of(m, s, m->newest + (int64_t)k), next, next + v, a_next, h, s->host->lanes};
    hk_fused fused = {&leaps[k], k ? hk_leap_predict_here : hk_leap_predict, hk_leap_correct};
    step[k] = (hk_tile_step){t[k], next, next + v, a_next, fused, 0};
  }
  status = s->tile(s, step, *count);
  if (status != HK_OK) return status;
  next[work] = X[work];
  for (size_t k = 0; k < *count; k++) {
    double before = next[work];
    predict_rest(next + work, &before, power, 1, h);
    *power = step[k].power;
    kick_rest(next + work, &before, power, 1, h);
  }
  m->primed = 1;
  m->newest = (m->newest + (int64_t)*count) % 2;
  return HK_OK;
}

static const hk_tile_facet tiles = {.size = sizeof tiles, .steps = tile};
static const hk_constrained_facet constrained = {.size = sizeof constrained, .keeps = true};
static const hk_corrected_facet corrected = {.size = sizeof corrected, .account = account};
static const hk_stages_facet stages = {.size = sizeof stages,
                                       .count = 2,
                                       .carries = true,
                                       .c = {0, 1},
                                       .x = {{0}, {0.5}},
                                       .v = {{0}, {1}},
                                       .x_end = {0.5},
                                       .v_end = {0.5, 0.5}};
static const hk_facet facets[] = {{HK_TILE_ID, &tiles},
                                  {HK_CONSTRAINED_ID, &constrained},
                                  {HK_CORRECTED_ID, &corrected},
                                  {HK_STAGES_ID, &stages},
                                  {0}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 1,
                                         .flags = HK_SYMPLECTIC | HK_REVERSIBLE | HK_USES_SPARE,
                                         .step = step,
                                         .reset = reset,
                                         .growth = growth,
                                         .facets = facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "leapfrog",
    .summary = "velocity Verlet, x' = x + h v + h^2/2 a, v' = v + h/2 (a + a'), forces at the end seeing v + h a; "
               "order 2, one evaluation a step",
    .reference =
        "Verlet 1967; Swope and others 1982; Hairer, Lubich and Wanner, Geometric Numerical Integration, I.1.4",
    .instance_size = sizeof(leapfrog),
    .fields = fields,
    .integrator = &integrator,
};
