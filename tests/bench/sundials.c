/* What `cvode` and `arkode` cost as plugins beside programs written by hand on SUNDIALS, for the curtain of 32 x 32
 * particles over 0.5 s (0.05 s with GMRES) at the same tolerance: with hooke's forces and the plugins' vector
 * arithmetic, so that only the plumbing differs; with SUNDIALS' own vectors; and with a plain scalar loop for the
 * forces. Medians of repeats taken in turn. The sides have the same weights of errors, so steps and evaluations agree
 * up to rounding. */
#include "plugins/common/sundials/sundials.h"
#include "plugins/common/sundials/sundials_vector.h"
#include "tests/support/engine.h"

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_spgmr.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <time.h>

#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
#define ARK(name) ARKode##name
#else
#define ARK(name) ARKStep##name
#endif

enum { SIDE = 32, REPEATS = 5, SIDES = 4 };
static const double tol = 1e-5;

typedef enum method { ADAMS, BDF, RUNGE_KUTTA, METHODS } method;
static const double ends[METHODS] = {0.5, 0.05, 0.5}; /* s */
static const char *const method_name[METHODS] = {"cvode, adams", "cvode, bdf, gmres", "arkode, order 5"};
static const char *const side_name[SIDES] = {"plugin", "by hand, same vectors", "by hand", "by hand, plain forces"};
enum { PLUGIN, SAME_VECTORS, BY_HAND, PLAIN };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *list, size_t count) {
  qsort(list, count, sizeof *list, by_size);
  return list[count / 2];
}

/* ---- the scene ---- */

typedef struct spring {
  uint32_t i, j;
  double k, c, L;
} spring;

typedef struct curtain {
  test_engine e;
  size_t count;
  spring all[6 * SIDE * SIDE];
} curtain;

static void add_springs(curtain *c, const int (*offset)[2], double k, double damping) {
  static uint32_t edge[2 * SIDE * SIDE][2];
  size_t count = 0;
  for (int o = 0; o < 2; o++)
    for (int j = 0; j + offset[o][1] < SIDE; j++)
      for (int i = 0; i < SIDE; i++) {
        int other = i + offset[o][0];
        if (other < 0 || other >= SIDE) continue;
        edge[count][0] = (uint32_t)(j * SIDE + i + 1);
        edge[count++][1] = (uint32_t)((j + offset[o][1]) * SIDE + other + 1);
      }
  hk_plugin_spec *springs = test_plugin(&c->e, HK_FORCE, "springs");
  test_edges(&c->e, springs, (const uint32_t(*)[2])edge, count);
  test_number(&c->e, springs, "k", k);
  test_number(&c->e, springs, "damping", damping);
  for (size_t e = 0; e < count; e++) {
    const double *a = c->e.scene->position + 3 * (edge[e][0] - 1), *b = c->e.scene->position + 3 * (edge[e][1] - 1);
    c->all[c->count++] = (spring){edge[e][0] - 1, edge[e][1] - 1, k, damping, hypot(a[0] - b[0], a[1] - b[1])};
  }
}

static void choose(curtain *c, const char *plugin, const char *name, const char *value) {
  hk_plugin_spec *integrator = c->e.scene->plugin[HK_INTEGRATOR].item[0];
  const hk_param *p = hk_spec_param(integrator, name, &c->e.error);
  hk_value v = {.kind = HK_VALUE_STRING, .text = value};
  if (!p || hk_spec_set(integrator, p, &v, c->e.scene->n, &c->e.error) != HK_OK) {
    fprintf(stderr, "%s: %s\n", plugin, c->e.error.text);
    exit(1);
  }
}

/* Ready to advance; by hand it is the forces alone that are used. */
static void open_curtain(curtain *c, method which) {
  static const int structural[2][2] = {{1, 0}, {0, 1}}, shear[2][2] = {{1, 1}, {-1, 1}},
                   flexion[2][2] = {{2, 0}, {0, 2}};
  *c = (curtain){.count = 0};
  test_engine_open(&c->e);
  for (int k = 0; k < SIDE * SIDE; k++)
    test_particle(&c->e, k % SIDE / (SIDE - 1.0), k / SIDE / (SIDE - 1.0), 0, 0.15 / (SIDE * SIDE));
  for (uint32_t i = 0; i < SIDE; i++) test_pin(&c->e, HK_PIN_FIXED, SIDE * (SIDE - 1) + i + 1, NULL);
  test_plugin(&c->e, HK_FORCE, "gravity");
  test_number(&c->e, test_plugin(&c->e, HK_FORCE, "drag"), "rate", 0.02);
  add_springs(c, structural, 1000, 0.02);
  add_springs(c, shear, 300, 0.01);
  add_springs(c, flexion, 50, 0.005);
  const char *name = which == RUNGE_KUTTA ? "arkode" : "cvode";
  test_plugin(&c->e, HK_INTEGRATOR, name);
  if (which != RUNGE_KUTTA) choose(c, name, "method", which == ADAMS ? "adams" : "bdf");
  if (which == BDF) choose(c, name, "solver", "krylov");
  if (which == BDF) choose(c, name, "preconditioner", "none");
  c->e.options.tol = tol;
  c->e.scene->fps = 2;
  test_run(&c->e);
}

/* ---- by hand ---- */

typedef struct program {
  curtain *c;
  hk_system *s;
  bool plain;
  double end;
  size_t evaluations;
  SUNContext context;
  N_Vector X, tolerance;
} program;

static void scalar(const spring *s, size_t count, const double *restrict x, const double *restrict v,
                   double *restrict F) {
  for (size_t e = 0; e < count; e++) {
    size_t i = 3 * (size_t)s[e].i, j = 3 * (size_t)s[e].j;
    double dx = x[j] - x[i], dy = x[j + 1] - x[i + 1], dz = x[j + 2] - x[i + 2];
    double r = 1 / sqrt(dx * dx + dy * dy + dz * dz);
    double w = dx * (v[j] - v[i]) + dy * (v[j + 1] - v[i + 1]) + dz * (v[j + 2] - v[i + 2]);
    double f = (s[e].k * (1 / r - s[e].L) + s[e].c * w * r) * r;
    F[i] += f * dx, F[i + 1] += f * dy, F[i + 2] += f * dz;
    F[j] -= f * dx, F[j + 1] -= f * dy, F[j + 2] -= f * dz;
  }
}

static int rates(double t, N_Vector X, N_Vector dX, void *user) {
  program *p = user;
  const double *x = NV_DATA_S(X), *v = x + 3 * p->s->n, *w = p->s->model->inverse_mass;
  double *dx = NV_DATA_S(dX), *a = dx + 3 * p->s->n;
  p->evaluations++;
  if (!p->plain) return p->s->rates(p->s, t, NV_DATA_S(X), NV_DATA_S(dX)) != HK_OK;
  memcpy(dx, v, 3 * p->s->n * sizeof *dx);
  memset(a, 0, (3 * p->s->n + 1) * sizeof *a);
  scalar(p->c->all, p->c->count, x, v, a);
  for (size_t e = 0; e < 3 * p->s->n; e++)
    a[e] = w[e / 3] > 0 ? a[e] * w[e / 3] - 0.02 * v[e] - (e % 3 == 2 ? 9.81 : 0) : 0;
  return 0;
}

/* As the plugins have them, from rest: the cloth's RMS radius L, and sqrt(L A). */
static void set_tolerance(program *p) {
  size_t n = p->s->n;
  double *T = NV_DATA_S(p->tolerance), *a = T + 3 * n, square = 0, A = 0;
  rates(0, p->X, p->tolerance, p);
  p->evaluations = 0;
  for (size_t e = 0; e < 3 * n; e++) A += a[e] * a[e] / (3 * (double)n);
  for (size_t k = 0; k < SIDE; k++) square += 2 * pow((double)k / (SIDE - 1.0) - 0.5, 2) / (3.0 * SIDE);
  double L = sqrt(square), V = sqrt(L * sqrt(A));
  for (size_t e = 0; e < 3 * n; e++) T[e] = tol * L;
  for (size_t e = 0; e < 3 * n; e++) a[e] = tol * V;
  T[6 * n] = 1e100;
}

static void must(int flag) {
  if (flag >= 0) return;
  fprintf(stderr, "SUNDIALS: %d\n", flag);
  exit(1);
}

static void with_cvode(program *p, method which) {
  double t = 0;
  void *memory = CVodeCreate(which == ADAMS ? CV_ADAMS : CV_BDF, p->context);
  SUNNonlinearSolver nonlinear = which == ADAMS ? SUNNonlinSol_FixedPoint(p->X, 0, p->context) : NULL;
  SUNLinearSolver linear = which == BDF ? SUNLinSol_SPGMR(p->X, SUN_PREC_NONE, 20, p->context) : NULL;
  must(CVodeInit(memory, rates, 0, p->X));
  must(CVodeSetUserData(memory, p));
  must(CVodeSVtolerances(memory, tol, p->tolerance));
  must(CVodeSetMaxNumSteps(memory, 1000000));
  must(CVodeSetStopTime(memory, p->end));
  if (nonlinear) must(CVodeSetNonlinearSolver(memory, nonlinear));
  if (linear) must(CVodeSetLinearSolver(memory, linear, NULL));
  if (linear) must(CVodeSetStabLimDet(memory, SUNTRUE));
  must(CVode(memory, p->end, p->X, &t, CV_NORMAL));
  CVodeFree(&memory);
  if (nonlinear) SUNNonlinSolFree(nonlinear);
  if (linear) SUNLinSolFree(linear);
}

static void with_arkode(program *p) {
  double t = 0;
  void *memory = ARKStepCreate(rates, NULL, 0, p->X, p->context);
  must(ARK(SetUserData)(memory, p));
  must(ARK(SVtolerances)(memory, tol, p->tolerance));
  must(ARKStepSetTableNum(memory, ARKODE_DIRK_NONE, ARKODE_DORMAND_PRINCE_7_4_5));
  must(ARK(SetInterpolantType)(memory, ARK_INTERP_LAGRANGE));
  must(ARK(SetInterpolantDegree)(memory, 0));
  must(ARK(SetMaxNumSteps)(memory, 1000000));
  must(ARK(SetStopTime)(memory, p->end));
  must(ARK(Evolve)(memory, p->end, p->X, &t, ARK_NORMAL));
  ARK(Free)(&memory);
}

static SUNContext context_of(void) {
  SUNContext context = NULL;
#if SUNDIALS_VERSION_MAJOR < 7
  must(SUNContext_Create(NULL, &context));
#else
  must(SUNContext_Create(SUN_COMM_NULL, &context));
#endif
  return context;
}

/* ---- the comparison ---- */

typedef struct outcome {
  double seconds, *x;
  size_t evaluations;
} outcome;

static void run_by_hand(curtain *c, method which, int side, outcome *out) {
  program p = {
      .c = c, .s = &c->e.run->dynamics.system, .plain = side == PLAIN, .end = ends[which], .context = context_of()};
  sunindextype size = (sunindextype)p.s->size;
  double *X = malloc(p.s->size * sizeof *X);
  memcpy(X, p.s->X, p.s->size * sizeof *X);
  double begin = now();
  p.X = side == SAME_VECTORS ? hk_sundials_vector(p.s->size, X, p.context) : N_VMake_Serial(size, X, p.context);
  if (side != SAME_VECTORS) N_VEnableFusedOps_Serial(p.X, SUNTRUE);
  p.tolerance = N_VClone(p.X);
  set_tolerance(&p);
  if (which == RUNGE_KUTTA)
    with_arkode(&p);
  else
    with_cvode(&p, which);
  out->seconds = now() - begin;
  out->evaluations = p.evaluations;
  memcpy(out->x, X, 3 * p.s->n * sizeof *X);
  N_VDestroy(p.X);
  N_VDestroy(p.tolerance);
  SUNContext_Free(&p.context);
  free(X);
}

static void run_plugin(curtain *c, method which, outcome *out) {
  hk_summary s;
  double begin = now();
  test_advance(&c->e, ends[which]);
  out->seconds = now() - begin;
  hk_run_summary(c->e.run, &s);
  out->evaluations = s.force_evaluations;
  memcpy(out->x, hk_run_view(c->e.run)->x, 3 * SIDE * SIDE * sizeof *out->x);
}

static void compare(method which) {
  static double x[SIDES][3 * SIDE * SIDE], seconds[SIDES][REPEATS];
  static curtain c;
  outcome out[SIDES];
  for (int k = 0; k < REPEATS; k++)
    for (int side = 0; side < SIDES; side++) {
      open_curtain(&c, which);
      out[side].x = x[side];
      if (side == PLUGIN)
        run_plugin(&c, which, &out[side]);
      else
        run_by_hand(&c, which, side, &out[side]);
      seconds[side][k] = out[side].seconds;
      test_engine_close(&c.e);
    }
  double plugin = median(seconds[PLUGIN], REPEATS);
  for (int side = 0; side < SIDES; side++) {
    double whole = median(seconds[side], REPEATS), off = 0, calls = (double)out[side].evaluations;
    for (size_t e = 0; e < 3 * SIDE * SIDE; e++) off = fmax(off, fabs(x[side][e] - x[PLUGIN][e]));
    printf("%-18s %-22s %6.0f ms, %5.0f evaluations of %5.1f us; the plugin costs %.3f of it, %.3f an evaluation; %.0e "
           "m apart\n",
           method_name[which], side_name[side], 1e3 * whole, calls, 1e6 * whole / calls, plugin / whole,
           plugin / (double)out[PLUGIN].evaluations / (whole / calls), off);
  }
}

int main(void) {
  for (method which = ADAMS; which < METHODS; which++) compare(which);
  return 0;
}
