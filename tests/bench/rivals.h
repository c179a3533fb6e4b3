/* The sides of the comparison in rivals.c: one run of hooke, of a plain C program, of SUNDIALS, each with a method at a
 * setting. */
#ifndef HK_BENCH_RIVALS_H
#define HK_BENCH_RIVALS_H

#include "plugins/common/sundials/sundials.h"
#include "plugins/common/sundials/sundials_vector.h"
#include "tests/bench/plain.h"

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <sunlinsol/sunlinsol_spgmr.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
#define ERK(name) ARKode##name
#else
#define ERK(name) ERKStep##name
#endif

enum { TARGETS = 3, PATIENCE = 10 }; /* PATIENCE: runs that take so many times as long as hooke's are given up */

typedef enum side { HOOKE, PLAIN_LEAPFROG, PLAIN_RK4, SUNDIALS_PLAIN, SUNDIALS_HOOKE, SIDES } side;
typedef struct outcome {
  double error, seconds; /* m; INFINITY: it failed */
  size_t evaluations;
} outcome;

typedef struct problem {
  uint32_t N;
  double end; /* s */
  plain p;
  double *reference, uncertain; /* n x 3; m */
  double best[SIDES][TARGETS];  /* s, the cheapest run of a side that reached the target */
} problem;

typedef struct program program; /* what SUNDIALS advances */
typedef struct method method;
struct method {
  const char *name;
  side side;
  void (*run)(const method *, const problem *, double setting, outcome *out, double *x);
  double first;       /* the coarsest rung: steps by those of leapfrog at its limit; with tolerances 1/rtol */
  const char *plugin; /* hooke's */
  bool (*solve)(const method *, double setting, program *, double *seconds); /* SUNDIALS' */
  int table;
  double atol; /* of steps chosen by tolerance, as a part of rtol; 0: fixed steps */
  bool shared; /* vectors with the arithmetic of hooke's plugins */
};

/* s: a run that takes longer cannot be the best for any target, whoever else disturbs it, or is beyond PATIENCE. */
static double longest(const problem *q, side s) {
  double ours = 0, hooke = 0;
  for (int k = 0; k < TARGETS; k++) {
    ours = fmax(ours, 1.5 * q->best[s][k]);
    hooke = fmax(hooke, PATIENCE * q->best[HOOKE][k]);
  }
  return s == HOOKE ? ours : fmin(ours, hooke);
}

/* Unstable steps, or others have won. */
static bool gives_up(double x, double at) { return !(fabs(x) < 1e3) || own() > at; }

/* ---- hooke ---- */

static void run_hooke(const method *m, const problem *q, double setting, outcome *out, double *x) {
  test_engine e;
  open_reference(&e, q->N, true, q->end);
  test_plugin(&e, HK_INTEGRATOR, m->plugin);
  if (m->atol > 0)
    e.options.tol = 1 / setting;
  else
    e.options.dt = q->end / setting;
  test_run(&e);
  double begin = own();
  hk_status status = hk_run_advance(e.run, q->end, &e.error);
  out->seconds = own() - begin;
  out->evaluations = e.run->dynamics.count.evaluations;
  out->error = status == HK_OK ? 0 : INFINITY;
  memcpy(x, e.run->state.X, 3 * q->p.n * sizeof *x);
  test_engine_close(&e);
}

/* ---- plain C ---- */

/* Velocity Verlet; what depends on the velocity sees v + h a. */
static bool plain_leapfrog(const plain *p, double end, size_t steps, double give_up, double *x, double *v,
                           double *work) {
  size_t size = 3 * p->n;
  double h = end / (double)steps, *a = work, *seen = work + size, *b = work + 2 * size;
  plain_accelerations(p, x, v, a);
  for (size_t s = 0; s < steps; s++) {
    if (gives_up(x[size / 2], give_up)) return false;
    for (size_t e = 0; e < size; e++) {
      x[e] += h * (v[e] + h / 2 * a[e]);
      seen[e] = v[e] + h * a[e];
    }
    plain_accelerations(p, x, seen, b);
    for (size_t e = 0; e < size; e++) v[e] += h / 2 * (a[e] + b[e]);
    double *swap = a;
    a = b, b = swap;
  }
  return true;
}

static bool plain_rk4(const plain *p, double end, size_t steps, double give_up, double *X, double *work) {
  static const double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  size_t half = 3 * p->n, size = 2 * half;
  double h = end / (double)steps, *k = work, *Y = work + size, *sum = work + 2 * size;
  for (size_t s = 0; s < steps; s++) {
    if (gives_up(X[half / 2], give_up)) return false;
    memcpy(sum, X, size * sizeof *sum);
    for (int l = 0; l < 4; l++) {
      const double *at = l ? Y : X, hn = h * node[l], hw = h * weight[l];
      for (size_t e = 0; l && e < size; e++) Y[e] = X[e] + hn * k[e];
      memcpy(k, at + half, half * sizeof *k);
      plain_accelerations(p, at, at + half, k + half);
      for (size_t e = 0; e < size; e++) sum[e] += hw * k[e];
    }
    memcpy(X, sum, size * sizeof *X);
  }
  return true;
}

static void run_plain(const method *m, const problem *q, double setting, outcome *out, double *x) {
  size_t size = 6 * q->p.n, steps = (size_t)ceil(setting);
  double *X = memory(4 * size, sizeof *X), begin = own(), give_up = begin + longest(q, m->side);
  memcpy(X, q->p.start, size * sizeof *X);
  bool fine = m->side == PLAIN_LEAPFROG ? plain_leapfrog(&q->p, q->end, steps, give_up, X, X + size / 2, X + size)
                                        : plain_rk4(&q->p, q->end, steps, give_up, X, X + size);
  *out = (outcome){fine ? 0 : INFINITY, own() - begin, m->side == PLAIN_LEAPFROG ? steps + 1 : 4 * steps};
  memcpy(x, X, size / 2 * sizeof *x);
  free(X);
}

/* ---- SUNDIALS ---- */

struct program {
  const plain *p;
  hk_system *s;        /* hooke's forces; NULL: plain */
  double end, give_up; /* s; of the thread's own time */
  size_t evaluations;
  SUNContext context;
  N_Vector X;
};

static int rates(double t, N_Vector X, N_Vector dX, void *user) {
  program *r = user;
  double *x = NV_DATA_S(X), *dx = NV_DATA_S(dX), none = 0, work;
  size_t half = 3 * r->p->n;
  r->evaluations++;
  if (gives_up(x[half / 2], r->give_up)) return -1;
  memcpy(dx, x + half, half * sizeof *dx);
  if (r->s) return r->s->accelerations(r->s, t, x, x + half, &none, dx + half, &work) != HK_OK;
  plain_accelerations(r->p, x, x + half, dx + half);
  return 0;
}

static void must(int flag) {
  if (flag >= 0) return;
  fprintf(stderr, "SUNDIALS refuses a setting: %d\n", flag);
  exit(1);
}

/* Runs that fail are expected beyond the stability limit, and told by their outcome. */
static SUNContext quiet_context(void) {
  SUNContext context = NULL;
#if SUNDIALS_VERSION_MAJOR < 7
  must(SUNContext_Create(NULL, &context));
#else
  must(SUNContext_Create(SUN_COMM_NULL, &context));
  must(SUNContext_ClearErrHandlers(context));
#endif
  return context;
}

static bool erkstep(const method *m, double setting, program *r, double *seconds) {
  double t = 0;
  void *memory = ERKStepCreate(rates, 0, r->X, r->context);
#if SUNDIALS_VERSION_MAJOR < 7
  must(ERKStepSetErrFile(memory, NULL));
#endif
  must(ERKStepSetTableNum(memory, (ARKODE_ERKTableID)m->table));
  must(ERK(SetUserData)(memory, r));
  must(ERK(SetMaxNumSteps)(memory, 1000000));
  must(ERK(SetStopTime)(memory, r->end));
  if (m->atol > 0)
    must(ERK(SStolerances)(memory, 1 / setting, m->atol / setting));
  else
    must(ERK(SetFixedStep)(memory, r->end / setting));
  double begin = own();
  int flag = ERK(Evolve)(memory, r->end, r->X, &t, ARK_NORMAL);
  *seconds = own() - begin;
  ERK(Free)(&memory);
  return flag >= 0;
}

static bool cvode(const method *m, double setting, program *r, double *seconds) {
  double t = 0;
  bool adams = m->table == CV_ADAMS;
  void *memory = CVodeCreate(m->table, r->context);
  SUNNonlinearSolver nonlinear = adams ? SUNNonlinSol_FixedPoint(r->X, 0, r->context) : NULL;
  SUNLinearSolver linear = adams ? NULL : SUNLinSol_SPGMR(r->X, SUN_PREC_NONE, 20, r->context);
  must(CVodeInit(memory, rates, 0, r->X));
#if SUNDIALS_VERSION_MAJOR < 7
  must(CVodeSetErrFile(memory, NULL));
#endif
  must(CVodeSetUserData(memory, r));
  must(CVodeSStolerances(memory, 1 / setting, m->atol / setting));
  must(CVodeSetMaxNumSteps(memory, 1000000));
  must(CVodeSetStopTime(memory, r->end));
  if (nonlinear) must(CVodeSetNonlinearSolver(memory, nonlinear));
  if (linear) must(CVodeSetLinearSolver(memory, linear, NULL));
  double begin = own();
  int flag = CVode(memory, r->end, r->X, &t, CV_NORMAL);
  *seconds = own() - begin;
  CVodeFree(&memory);
  if (nonlinear) SUNNonlinSolFree(nonlinear);
  if (linear) SUNLinSolFree(linear);
  return flag >= 0;
}

static void run_sundials(const method *m, const problem *q, double setting, outcome *out, double *x) {
  test_engine e;
  program r = {.p = &q->p, .end = q->end, .context = quiet_context()};
  size_t size = 6 * q->p.n;
  bool hooke = m->side == SUNDIALS_HOOKE;
  if (hooke) {
    open_reference(&e, q->N, true, q->end);
    test_run(&e);
    r.s = &e.run->dynamics.system;
  }
  double *X = memory(size, sizeof *X);
  memcpy(X, q->p.start, size * sizeof *X);
  r.X = m->shared ? hk_sundials_vector(size, X, r.context) : N_VMake_Serial((sunindextype)size, X, r.context);
  r.give_up = own() + longest(q, m->side);
  out->error = m->solve(m, setting, &r, &out->seconds) ? 0 : INFINITY;
  out->evaluations = r.evaluations;
  memcpy(x, X, size / 2 * sizeof *x);
  N_VDestroy(r.X);
  SUNContext_Free(&r.context);
  free(X);
  if (hooke) test_engine_close(&e);
}

#endif
