/* Leapfrog, or velocity Verlet, with one evaluation per step:
 *     x' = x + h (v + h/2 a),  a' = a(x', v + h a),  v' = v + h/2 (a + a').
 * The acceleration at the end is used again in the next step. Forces that depend on the velocity are evaluated with the
 * predicted v + h a, which keeps order 2 (the lagged v + h/2 a would give order 1) and limits the step to h w <= 2
 * (sqrt(1 + 4 xi^2) - 2 xi), xi = g/(2w), with damping rate g; for pure drag, h g <= 1. Channels and work y are
 * predicted and averaged in the same way. Without velocity-dependent forces it is symplectic and reversible. The
 * velocity is predicted even then, at the cost of one store, because the power of a force depends on it. The new state
 * is built in separate memory; X changes only after its evaluation succeeded.
 *
 * With constraints that are all equalities it is RATTLE: with F/m without constraint forces,
 *     v_m = v + h/2 (F/m + W J^T l),  x' = x + h v_m,  g(x') = 0,   J at x,
 *     v' = v_m + h/2 (F'/m + W J'^T l'),  J' v' = 0,                J' at x',
 * still symplectic, reversible and of order 2 (Andersen 1983; Leimkuhler and Skeel 1994). The slope that is kept, a' =
 * 2 (v' - v_m)/h, has the constraint forces in it, so that the next step begins near its end; velocity-dependent forces
 * see 2 v_m - v. */
#include "plugins/common/integrate/leapfrog_growth.h"

#include "core/plugin.h"

#include <string.h>

typedef struct leapfrog {
  int64_t primed;  /* whether the current slope is that of X */
  int64_t current; /* which of the two slopes, 0 or 1 */
  double *slope;   /* two of (a, dy) */
  double *next;    /* shaped as X: the new x, predicted v and y */
} leapfrog;

static const hk_field fields[] = {
    {"primed", HK_FIELD_INTEGER, 1, offsetof(leapfrog, primed), 0},
    {"current", HK_FIELD_INTEGER, 1, offsetof(leapfrog, current), 0},
    {"slopes", HK_FIELD_STATE, 2, offsetof(leapfrog, slope), 0},
    {"next", HK_FIELD_STATE, 1, offsetof(leapfrog, next), HK_SCRATCH},
    {0},
};

static double amplification(const void *self, double hw, double hg) {
  (void)self;
  return hk_leapfrog_growth(hw, hg);
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  return hk_leapfrog_turning_growth(hw, hg, hb);
}

static void reset(void *self, hk_reason why) {
  (void)why;
  ((leapfrog *)self)->primed = 0;
}

static void predict(double *restrict x_next, double *restrict v_next, const double *restrict x,
                    const double *restrict v, const double *restrict a, size_t count, double h) {
  double half = h / 2;
  for (size_t e = 0; e < count; e++) {
    double kick = half * a[e], middle = v[e] + kick;
    x_next[e] = x[e] + h * middle;
    v_next[e] = middle + kick;
  }
}

/* x_next = x + h v_middle, v_middle = v + h/2 a. */
static void drift(double *restrict x_next, double *restrict v_middle, const double *restrict x,
                  const double *restrict v, const double *restrict a, size_t count, double h) {
  double half = h / 2;
  for (size_t e = 0; e < count; e++) {
    v_middle[e] = v[e] + half * a[e];
    x_next[e] = x[e] + h * v_middle[e];
  }
}

static void commit(double *restrict x, double *restrict v, const double *restrict x_next, const double *restrict a,
                   const double *restrict a_next, size_t count, double half) {
  for (size_t e = 0; e < count; e++) {
    x[e] = x_next[e];
    v[e] += half * (a[e] + a_next[e]);
  }
}

/* v = the velocity in the middle of the step, of which `middle` keeps a copy, is extrapolated to the end. */
static void extrapolate(double *restrict v, double *restrict middle, const double *restrict before, size_t count) {
  for (size_t e = 0; e < count; e++) {
    middle[e] = v[e];
    v[e] += v[e] - before[e];
  }
}

static void kick(double *restrict v, const double *restrict middle, const double *restrict a, size_t count, double by) {
  for (size_t e = 0; e < count; e++) v[e] = middle[e] + by * a[e];
}

/* The step in a scene with constraints: RATTLE. */
static hk_status held_step(leapfrog *m, hk_system *s, double t_next, double h) {
  size_t v = 3 * s->n, y = 6 * s->n, length = s->size - v;
  double *X = s->X, *next = m->next, *a = m->slope + (m->current ? length : 0),
         *a_next = m->slope + (m->current ? 0 : length), work = 0, given = 0;
  s->takes_constraints = false;
  hk_status status = m->primed ? HK_OK : s->accelerations(s, s->t, X, X + v, X + y, a, a + v);
  m->primed = 0; /* a becomes the velocity in the middle of the step */
  if (status != HK_OK) return status;
  drift(next, next + v, X, X + v, a, v, h);
  status = s->hold_positions(s, t_next, X, h, next, next + v, &work);
  if (status != HK_OK) return status;
  for (size_t e = y; e < s->size; e++) next[e] = X[e] + h * a[e - v];
  extrapolate(next + v, a, X + v, v);
  status = s->accelerations(s, t_next, next, next + v, next + y, a_next, a_next + v);
  kick(next + v, a, a_next, v, h / 2);
  if (status == HK_OK) status = s->hold_velocities(s, t_next, next, h, next + v, &given);
  if (status != HK_OK) return status;
  a_next[length - 1] += 2 / h * given; /* the power of constraint forces, as a_next has the forces */
  for (size_t e = 0; e < v; e++) a_next[e] = 2 / h * (next[v + e] - a[e]);
  memcpy(X, next, y * sizeof *X);
  for (size_t e = y; e < s->size; e++) X[e] += h / 2 * (a[e - v] + a_next[e - v]);
  X[s->size - 1] += work;
  m->current = !m->current;
  m->primed = 1;
  return HK_OK;
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  leapfrog *m = self;
  size_t v = 3 * s->n, y = 6 * s->n, length = s->size - v;
  double *X = s->X, *next = m->next, *a = m->slope + (m->current ? length : 0),
         *a_next = m->slope + (m->current ? 0 : length), t_next = fmin(t_stop, s->t + h);
  (void)out;
  if (s->holonomic) return held_step(m, s, t_next, h);
  hk_status status = m->primed ? HK_OK : s->accelerations(s, s->t, X, X + v, X + y, a, a + v);
  m->primed = status == HK_OK;
  if (status != HK_OK) return status;
  predict(next, next + v, X, X + v, a, v, h);
  for (size_t e = y; e < s->size; e++) next[e] = X[e] + h * a[e - v];
  status = s->accelerations(s, t_next, next, next + v, next + y, a_next, a_next + v);
  if (status != HK_OK) return status;
  commit(X, X + v, next, a, a_next, v, h / 2);
  for (size_t e = y; e < s->size; e++) X[e] += h / 2 * (a[e - v] + a_next[e - v]);
  m->current = !m->current;
  return HK_OK;
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 1,
                                         .flags = HK_SYMPLECTIC | HK_REVERSIBLE | HK_KEEPS_CONSTRAINTS,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = reset};

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
