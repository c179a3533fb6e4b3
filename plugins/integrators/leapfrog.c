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
  double power;   /* W, of the forces at the start of the step */
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

/* kg m^2/s^4: the sum of m a^2 over the free particles. */
static double weigh(const hk_model *model, const double *a) {
  double sum = 0;
  for (size_t i = 0; i < model->n; i++)
    if (model->inverse_mass[i] > 0)
      sum += model->mass[i] * (a[3 * i] * a[3 * i] + a[3 * i + 1] * a[3 * i + 1] + a[3 * i + 2] * a[3 * i + 2]);
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

/* W, of pins and forces in the middle of the step from `spare` to `end`: at the mean of both positions, with their
 * difference over h as velocity. Writes over `spare`, and over the slope that is not the newest. */
static hk_status power_in_the_middle(leapfrog *m, hk_system *s, const double *end, double h, double *watt) {
  size_t v = 3 * s->n;
  double *x = s->spare, *middle = x + v, *dy = x + 2 * v;
  for (size_t e = 0; e < v; e++) {
    middle[e] = (end[e] - x[e]) / h;
    x[e] = (x[e] + end[e]) / 2;
  }
  hk_status status = s->accelerations(s, s->t - h / 2, x, middle, s->X + 2 * v, slope_of(m, s, m->newest + 1), dy);
  *watt = dy[s->size - 2 * v - 1];
  return status;
}

/* For forces that are linear, steps keep H - h^2/8 sum of m a^2 exactly, of which a corrector changes both terms (H =
 * kinetic + potential energy: multiply v' - v = h/2 (a + a') by v' + v = 2 (x' - x)/h + h/2 (a' - a)). In the same
 * identity the work of damping is its sum with the velocity in the middle, (x' - x)/h; the sum of the ends' powers P
 * and P' has h/2 (P + P') - h P(middle) too much, of the order of h^3 a step unless a corrector takes back what the
 * velocity has gained in every step, as contact does that bears a load. */
static hk_status account(void *self, const void *method, hk_system *s, const double *end, double h, hk_corrected *out) {
  leapfrog *m = self;
  size_t rest = s->size - 6 * s->n;
  double *dy = rates_of(m, s), kept = weigh(s->model, slope_of(m, s, m->newest)), at_end = dy[rest - 1], middle = 0;
  (void)method;
  if (s->constraint && s->constraint->holonomic) return HK_OK; /* the slope is that of RATTLE's next step */
  hk_status status = prime(m, s);
  if (status != HK_OK) return status;
  const double *a = slope_of(m, s, m->newest);
  kept = h * h / 8 * (kept - weigh(s->model, a) + borne_more(s, slope_of(m, s, m->newest + 1), a, end));
  double after = dy[rest - 1];
  if (m->power != 0 || at_end != 0 || after != 0) status = power_in_the_middle(m, s, end, h, &middle);
  m->primed = status == HK_OK;
  out->work = kept + h * (middle - (m->power + at_end) / 2);
  out->correction = kept + h * (middle - (m->power + after) / 2);
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
  m->power = dy[s->size - y - 1];
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
