/* The methods of rivals.c, and the ladders of settings on which they are tried. */
#ifndef HK_BENCH_RIVAL_LADDERS_H
#define HK_BENCH_RIVAL_LADDERS_H

#include "core/numerics/step_choice/step_choice.h"
#include "tests/bench/rivals.h"

enum { RUNGS = 40 };
static const double target[TARGETS] = {1e-3, 1e-5, 1e-7};

/* ---- the methods ---- */

/* Within a side those that promise most come first, so that the others are given up soon. Not among them: SUNDIALS'
 * methods of order 6 and 8, and implicit Runge-Kutta, for which BDF stands. */
#define HOOKE_STEPS(plugin, first)                                                                                     \
  { plugin, HOOKE, run_hooke, first, plugin, NULL, 0, 0, false }
#define PLAIN_STEPS(side)                                                                                              \
  { "", side, run_plain, 0.6, NULL, NULL, 0, 0, false }
#define ERK_STEPS(side, name, table, first, shared)                                                                    \
  { name ", fixed steps", side, run_sundials, first, NULL, erkstep, table, 0, shared }
#define ERK_TOL(side, name, table, shared)                                                                             \
  { name ", atol 1e-6 rtol", side, run_sundials, 10, NULL, erkstep, table, 1e-6, shared }
#define CVODE_TOL(side, name, table, atol, shared)                                                                     \
  { name ", atol " #atol " rtol", side, run_sundials, 10, NULL, cvode, table, atol, shared }
#define SUNDIALS_SIDE(side, shared)                                                                                    \
  ERK_STEPS(side, "Zonneveld 4", ARKODE_ZONNEVELD_5_3_4, 0.5, shared),                                                 \
      ERK_STEPS(side, "Knoth-Wolke 3", ARKODE_KNOTH_WOLKE_3_3, 0.6, shared),                                           \
      ERK_STEPS(side, "Bogacki-Shampine 3", ARKODE_BOGACKI_SHAMPINE_4_2_3, 0.6, shared),                               \
      ERK_STEPS(side, "Cash-Karp 5", ARKODE_CASH_KARP_6_4_5, 0.5, shared),                                             \
      ERK_STEPS(side, "Fehlberg 5", ARKODE_FEHLBERG_6_4_5, 0.4, shared),                                               \
      ERK_STEPS(side, "Dormand-Prince 5", ARKODE_DORMAND_PRINCE_7_4_5, 0.55, shared),                                  \
      ERK_STEPS(side, "Kennedy-Carpenter 4", ARKODE_ARK436L2SA_ERK_6_3_4, 0.6, shared),                                \
      ERK_STEPS(side, "Heun 2", ARKODE_HEUN_EULER_2_1_2, 1, shared),                                                   \
      ERK_TOL(side, "Zonneveld 4", ARKODE_ZONNEVELD_5_3_4, shared),                                                    \
      ERK_TOL(side, "Bogacki-Shampine 3", ARKODE_BOGACKI_SHAMPINE_4_2_3, shared),                                      \
      ERK_TOL(side, "Cash-Karp 5", ARKODE_CASH_KARP_6_4_5, shared),                                                    \
      ERK_TOL(side, "Dormand-Prince 5", ARKODE_DORMAND_PRINCE_7_4_5, shared),                                          \
                                                                                                                       \
      CVODE_TOL(side, "CVODE, Adams", CV_ADAMS, 1e-6, shared),                                                         \
      CVODE_TOL(side, "CVODE, BDF, GMRES", CV_BDF, 1e-3, shared)

static const method methods[] = {
    HOOKE_STEPS("stoermer_wide4", 0.9),
    HOOKE_STEPS("stoermer_wide3", 0.9),
    HOOKE_STEPS("stoermer_wide2", 0.8),
    HOOKE_STEPS("leapfrog", 0.8),
    HOOKE_STEPS("symplectic_euler", 0.8),
    HOOKE_STEPS("stoermer", 1.4),
    HOOKE_STEPS("stoermer5", 2),
    HOOKE_STEPS("blanes_moan", 0.25),
    HOOKE_STEPS("rk4", 0.6),
    {"dopri5, tol", HOOKE, run_hooke, 1e3, "dopri5", NULL, 0, 1, false},
    PLAIN_STEPS(PLAIN_LEAPFROG),
    PLAIN_STEPS(PLAIN_RK4),
    SUNDIALS_SIDE(SUNDIALS_PLAIN, false),
    SUNDIALS_SIDE(SUNDIALS_HOOKE, true),
};
enum { METHODS = sizeof methods / sizeof *methods };

/* ---- ladders ---- */

typedef struct rung {
  double setting;
  outcome out;
} rung;

/* What just reaches a target. */
typedef struct aim {
  double setting;
  outcome out;  /* as interpolated; seconds are INFINITY if the target was not reached */
  bool settled; /* `out` is that of a run */
} aim;

typedef struct ladder {
  const method *m;
  size_t count;
  rung rung[RUNGS];
  aim aim[TARGETS];
} ladder;

static void measure(const method *m, const problem *q, double setting, outcome *out) {
  double *x = memory(3 * q->p.n, sizeof *x);
  *out = (outcome){.error = 0};
  m->run(m, q, setting, out, x);
  if (out->error == 0) out->error = rms(x, q->reference, q->p.n);
  if (!(out->error < 1)) out->error = INFINITY;
  free(x);
}

static double next_setting(const method *m, const rung *last) {
  if (m->atol > 0) return last->setting * sqrt(10);
  return ceil(last->setting * (last->out.error > target[0] ? 1.06 : 1.5));
}

/* What reaches the target: the rung below it; or between two rungs that are both within the largest target, where the
 * error falls as a power of the setting. */
static void interpolate(ladder *l, int k) {
  aim *best = &l->aim[k];
  *best = (aim){.out.seconds = INFINITY};
  for (size_t r = 0; r < l->count; r++) {
    const rung *fine = &l->rung[r], *coarse = r ? fine - 1 : NULL;
    if (fine->out.error > target[k] || fine->out.seconds >= best->out.seconds) continue;
    double part = 0;
    if (coarse && coarse->out.error <= target[0] && coarse->out.error > target[k])
      part = 0.97 * log(target[k] / fine->out.error) / log(coarse->out.error / fine->out.error);
    *best = (aim){fine->setting, fine->out, true};
    if (part <= 0) continue;
    best->setting *= pow(coarse->setting / fine->setting, part);
    best->out.seconds *= pow(coarse->out.seconds / fine->out.seconds, part);
    best->settled = false;
  }
}

/* Where the interpolation promised too much, the next finer rung stands for it. */
static void settle(const problem *q, ladder *l, int k) {
  aim *a = &l->aim[k];
  if (a->settled) return;
  measure(l->m, q, a->setting, &a->out);
  for (size_t r = 0; r < l->count && a->out.error > target[k]; r++)
    if (l->rung[r].setting > a->setting && l->rung[r].out.error <= target[k])
      *a = (aim){l->rung[r].setting, l->rung[r].out, true};
  a->settled = true;
}

/* Whether finer rungs, which cost more, can still win: for a target that is not reached yet, no run of the side was
 * faster by a tenth. */
static bool worth_going_on(const rung *r, const double best[TARGETS]) {
  for (int k = 0; k < TARGETS; k++)
    if (r->out.error > target[k] && best[k] > 0.9 * r->out.seconds) return true;
  return false;
}

/* Nor is a rung taken that would be given up. */
static bool too_long(const rung *r, double next, const problem *q, side s) {
  return r->out.error <= target[0] && r->out.seconds * next / r->setting > longest(q, s);
}

static void climb(ladder *l, double setting, problem *q) {
  double *best = q->best[l->m->side];
  for (l->count = 0; l->count < RUNGS; setting = next_setting(l->m, &l->rung[l->count - 1])) {
    if (l->count && l->m->atol == 0 && too_long(&l->rung[l->count - 1], setting, q, l->m->side)) break;
    rung *r = &l->rung[l->count++];
    r->setting = setting;
    measure(l->m, q, setting, &r->out);
    for (int k = 0; k < TARGETS; k++)
      if (r->out.error <= target[k]) best[k] = fmin(best[k], r->out.seconds);
    if (!worth_going_on(r, best)) break;
  }
  for (int k = 0; k < TARGETS; k++) interpolate(l, k);
}

/* The smaller curtain tells which methods need not be tried on the larger one: those that were never within 1.6 times
 * their side's best. */
static bool hopeless(const ladder *smaller, size_t l) {
  bool hopeless = true;
  if (!smaller[l].m) return true;
  for (int k = 0; k < TARGETS; k++) {
    double best = INFINITY;
    for (size_t o = 0; o < METHODS; o++)
      if (smaller[o].m && methods[o].side == methods[l].side) best = fmin(best, smaller[o].aim[k].out.seconds);
    hopeless &= !(smaller[l].aim[k].out.seconds <= 1.6 * best) || isinf(best);
  }
  return hopeless;
}

static double first_setting(const method *m, const problem *q) {
  return m->atol > 0 ? m->first : ceil(m->first * q->end / q->p.limit);
}

/* hooke knows the largest stable step of its own methods. */
static double below_limit(const method *m, const problem *q) {
  test_engine e;
  open_reference(&e, q->N, true, q->end);
  test_plugin(&e, HK_INTEGRATOR, m->plugin);
  test_run(&e);
  double steps = q->end / e.run->step->dt_limit;
  test_engine_close(&e);
  return ceil(0.9 * steps);
}

/* Frequencies grow with N: from below the fewest stable steps, by those of the smaller curtain. The larger one is
 * damped more, for which Runge-Kutta methods are stable with steps up to a third longer. */
static double lowest(const ladder *smaller, const problem *before, const problem *q) {
  double more = 0.75 * q->N / before->N * q->end / before->end;
  size_t r = 0;
  while (r + 1 < smaller->count && smaller->rung[r].out.error > target[0]) r++;
  return smaller->rung[r].setting * (smaller->m->atol > 0 ? 1 : more);
}

/* SUNDIALS' method of the same name on the plain forces; of other sides the method itself. */
static const method *on_side(const method *m, side s) {
  for (size_t l = 0; m->side != s && l < METHODS; l++)
    if (methods[l].side == s && strcmp(methods[l].name, m->name) == 0) return &methods[l];
  return m;
}

/* The ladders of a size, those of the one before being known (NULL: it is the first). */
static void climb_all(ladder *all, const ladder *smaller, const problem *before, problem *q) {
  for (size_t l = 0; l < METHODS; l++) {
    const method *m = &methods[l];
    bool out = m->side == SUNDIALS_PLAIN || (smaller && hopeless(smaller, l));
    all[l] = (ladder){.m = out ? NULL : m};
    if (out) continue;
    bool known = m->side == HOOKE && m->atol == 0;
    climb(&all[l], known ? below_limit(m, q) : smaller ? lowest(&smaller[l], before, q) : first_setting(m, q), q);
  }
}

#endif
