/* SUNDIALS' CVODE: multistep methods of variable order and step, as a general-purpose method for comparison.
 *
 * BDF (orders 1 to 5) with Newton's iteration on hooke's Jacobian and the scene's solver, or Adams-Moulton (orders 1 to
 * 12) with functional iteration; see plugins/common/sundials/sundials.c for the weights of errors and for the linear
 * algebra. CVODE chooses the steps, the orders and when the Jacobian or a factorization is renewed. It takes one step
 * per call, and its stop time is set so that a step ends at the host's stop. Whatever invalidates its history (an
 * event, a birth, a corrector, a resumed run) restarts it at order 1. Constraint forces are part of f but not of the
 * Jacobian.
 *
 * It is the yardstick: a curtain of 32 x 32 particles by the cheapest of SUNDIALS' methods on hooke's forces takes 4.8
 * to 6.4 times as long as by hooke's own, for errors of 1e-3 to 1e-7 m (build/bench/rivals).
 */
#include "plugins/common/sundials/sundials.h"
#include "plugins/common/sundials/sundials_vector.h"

#include <complex.h>
#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <stdlib.h>
#include <string.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

enum { BDF, ADAMS };
enum { AUTO, SPARSE, KRYLOV, FIXED_POINT };

typedef struct cvode {
  hk_sundials sundials; /* first member */
  int method, solver;
  int64_t max_order;
  bool stability_detection;
  void *memory;
  N_Vector error, weight; /* NULL without `estimate` */
  bool running;           /* whether CVODE's history is that of X */
  double planned;         /* s, length of the next step that CVODE proposes */
  double most;            /* s, the last h of the host that was shorter than `planned`, but not very; 0: no limit */
  double t;               /* s, CVODE's time */
} cvode;

static const hk_param params[] = {
    {"method", "", "family of methods", .choice = HK_AT(cvode, method), .initial = {BDF}, .choices = "bdf|adams"},
    {"max_order", "",
     "highest order; 0: the method's own, 5 (bdf) or 12 (adams); bdf of 3 and more is unstable for fast undamped "
     "motion",
     .integer = HK_AT(cvode, max_order), .limits = HK_WITHIN(0, 12)},
    {"solver", "",
     "Newton with the scene's solver or with GMRES, or functional iteration; auto: sparse (bdf), fixed_point (adams)",
     .choice = HK_AT(cvode, solver), .initial = {AUTO}, .choices = "auto|sparse|krylov|fixed_point"},
    {"preconditioner", "", "of GMRES: a factorization kept over steps, the diagonal blocks, or none",
     .choice = HK_AT(cvode, sundials.preconditioner), .initial = {HK_PRECONDITION_FACTOR},
     .choices = "factor|block_jacobi|none"},
    {"stability_detection", "",
     "whether BDF lowers its order where it sees orders 3 to 5 near their limit of stability",
     .boolean = HK_AT(cvode, stability_detection), .initial = {1}},
    {0},
};

static const hk_field fields[] = {
    {"state", .state = HK_AT(cvode, sundials.state), .width = 1, .flags = HK_SCRATCH},
    {"work", .state = HK_AT(cvode, sundials.work), .width = 2, .flags = HK_SCRATCH},
    {0},
};

/* The factor of backward Euler, which BDF starts with. Orders 1 and 2 are stable for every oscillation, higher ones are
 * not. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  double complex root = csqrt(hg * hg - 4 * hw * hw), fast = -(hg + root) / 2;
  double complex slow = fast == 0 ? 0 : hw * hw / fast;
  return hb == 0 ? fmax(1 / cabs(1 - fast), 1 / cabs(1 - slow)) : NAN;
}

static int linear_system(double t, N_Vector X, N_Vector f, SUNMatrix A, int reuse, int *current, double gamma,
                         void *self, N_Vector u, N_Vector v, N_Vector w) {
  (void)A, (void)u, (void)v, (void)w;
  return hk_sundials_factorize(self, t, X, f, reuse, current, gamma);
}

static hk_status attach_fixed_point(cvode *m) {
  hk_sundials *s = &m->sundials;
  s->nonlinear = SUNNonlinSol_FixedPoint(s->X, 0, s->context);
  if (!s->nonlinear) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for CVODE's functional iteration");
  return hk_sundials_setup(s, CVodeSetNonlinearSolver(m->memory, s->nonlinear));
}

static hk_status attach_solver(cvode *m) {
  hk_sundials *s = &m->sundials;
  int kind = m->solver == AUTO ? (m->method == BDF ? SPARSE : FIXED_POINT) : m->solver;
  if (kind == FIXED_POINT) return attach_fixed_point(m);
  hk_status status = kind == SPARSE ? hk_sundials_direct(s) : hk_sundials_krylov(s);
  if (status != HK_OK) return status;
  int flag = CVodeSetLinearSolver(m->memory, s->linear, s->matrix);
  if (flag == 0 && kind == SPARSE) flag = CVodeSetLinSysFn(m->memory, linear_system);
  if (flag == 0 && kind == KRYLOV) flag = CVodeSetLSNormFactor(m->memory, 1); /* GMRES has the 2-norm, above ours */
  if (flag == 0 && kind == KRYLOV && s->preconditioner != HK_PRECONDITION_NONE)
    flag = CVodeSetPreconditioner(m->memory, hk_sundials_precondition, hk_sundials_preconditioned);
  return hk_sundials_setup(s, flag);
}

static int set_options(cvode *m) {
  hk_sundials *s = &m->sundials;
  int order = m->max_order > 0 ? (int)m->max_order : m->method == BDF ? 5 : 12;
  int flag = CVodeSetUserData(m->memory, s);
  if (flag == 0) flag = CVodeWFtolerances(m->memory, hk_sundials_weights);
  if (flag == 0) flag = CVodeSetMaxOrd(m->memory, order);
  if (flag == 0 && m->method == BDF) flag = CVodeSetStabLimDet(m->memory, m->stability_detection);
  if (flag == 0) flag = CVodeSetMaxHnilWarns(m->memory, -1);
  return flag;
}

static void destroy(void *self, const hk_host *host) {
  cvode *m = self;
  (void)host;
  if (m->memory) CVodeFree(&m->memory);
  if (m->error) N_VDestroy(m->error);
  if (m->weight) N_VDestroy(m->weight);
  m->error = m->weight = NULL;
  hk_sundials_close(&m->sundials);
}

/* A CVodeInit that fails has freed its vectors, and CVodeFree of SUNDIALS 6 would free them again: only the memory's
 * own block, which holds nothing else yet, is freed then. */
static hk_status start_memory(cvode *m, double t) {
  hk_sundials *s = &m->sundials;
  int flag = CV_SUCCESS;
#if SUNDIALS_VERSION_MAJOR < 7
  flag = CVodeSetErrHandlerFn(m->memory, hk_sundials_hear, s);
#endif
  if (flag == CV_SUCCESS) flag = CVodeInit(m->memory, hk_sundials_rates, t, s->X);
  if (flag == CV_MEM_FAIL) {
    free(m->memory);
    m->memory = NULL;
  }
  return hk_sundials_setup(s, flag);
}

static hk_status set_up(cvode *m, const hk_host *host, const hk_view *view) {
  hk_sundials *s = &m->sundials;
  destroy(m, host);
  m->running = false;
  hk_status status = hk_sundials_open(s, host, view);
  if (status != HK_OK) return status;
  m->memory = CVodeCreate(m->method == BDF ? CV_BDF : CV_ADAMS, s->context);
  m->error = N_VClone(s->X);
  m->weight = N_VClone(s->X);
  if (!m->memory || !m->error || !m->weight || hk_sundials_vector_failed(s->X))
    return host->fail(host, HK_NO_MEMORY, "no memory for CVODE");
  status = start_memory(m, view->t);
  if (status == HK_OK) status = hk_sundials_setup(s, set_options(m));
  return status == HK_OK ? attach_solver(m) : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  const cvode *m = self;
  if (m->method == BDF && m->max_order > 5)
    return host->fail(host, HK_BAD_PARAM, "max_order: bdf has orders 1 to 5, not %d; adams has 12", (int)m->max_order);
  return set_up(self, host, view);
}

static hk_status topology(void *self, const hk_view *view) { return set_up(self, view->host, view); }

static void reset(void *self, hk_reason why) {
  cvode *m = self;
  m->running = false;
  if (why == HK_CHECKPOINT) m->most = 0;
}

/* The correction that projects X onto the constraints. CVODE adds it to its history; a projection by the host would
 * invalidate the history. The correction excludes the values that pins prescribe: f is always evaluated with these
 * values, and the difference from the history would be counted as an error. */
static int project(sunrealtype t, N_Vector X, N_Vector correction, sunrealtype limit, N_Vector error, void *self) {
  hk_sundials *m = self;
  hk_system *s = m->system;
  double *from = m->work, *to = NV_DATA_S(correction);
  (void)limit, (void)error;
  memcpy(from, NV_DATA_S(X), s->size * sizeof *from);
  s->impose(s, t, from, from + 3 * s->n);
  memcpy(to, from, s->size * sizeof *to);
  hk_status status = s->constraint->project(s, t, to, to + 3 * s->n);
  for (size_t e = 0; e < s->size; e++) to[e] -= from[e];
  return hk_sundials_code(m, status);
}

static int set_projection(const cvode *m, const hk_system *s) {
  if (hk_system_equations(s) == 0 || m->method != BDF) return CV_SUCCESS;
  int flag = CVodeSetProjFn(m->memory, project);
  return flag == CV_SUCCESS ? CVodeSetProjErrEst(m->memory, SUNFALSE) : flag;
}

static hk_status start(cvode *m, hk_system *s, double span) {
  hk_status status = hk_sundials_scale(&m->sundials, s, span);
  if (status != HK_OK) return status;
  memcpy(m->sundials.state, s->X, s->size * sizeof *s->X);
  m->t = s->t;
  m->planned = INFINITY;
  int flag = CVodeReInit(m->memory, s->t, m->sundials.X);
  return hk_sundials_setup(&m->sundials, flag == CV_SUCCESS ? set_projection(m, s) : flag);
}

static bool rates_failed(int flag) {
  return flag == CV_RHSFUNC_FAIL || flag == CV_FIRST_RHSFUNC_ERR || flag == CV_REPTD_RHSFUNC_ERR ||
         flag == CV_UNREC_RHSFUNC_ERR;
}

static double error_of(const cvode *m) {
  CVodeGetEstLocalErrors(m->memory, m->error);
  CVodeGetErrWeights(m->memory, m->weight);
  return hk_sundials_norm(m->error, m->weight);
}

static int evolve(cvode *m, double stop) {
  int flag = CVodeSetStopTime(m->memory, stop);
  return flag >= 0 ? CVode(m->memory, stop, m->sundials.X, &m->t, CV_ONE_STEP) : flag;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  cvode *m = self;
  double stop = t_stop;
  (void)method;
  m->sundials.system = s;
  m->sundials.status = HK_OK;
  *m->sundials.message = 0;
  if (!m->running || !hk_sundials_follows(&m->sundials, s, s->tol)) {
    hk_status status = start(m, s, t_stop - s->t);
    if (status != HK_OK) return status;
  }
  double limit = hk_sundials_longest(h, m->planned, &m->most);
  if (t_stop - s->t > limit * (1 + 1e-9)) stop = s->t + limit;
  m->running = false;
  int flag = evolve(m, stop);
  if (flag ==
      CV_ERR_FAILURE) { /* a force may have jumped that found all at rest: the scales are those of what follows */
    hk_status status = start(m, s, t_stop - s->t);
    if (status != HK_OK) return status;
    flag = evolve(m, stop);
  }
  if (flag < 0) return hk_sundials_failed(&m->sundials, flag, rates_failed(flag));
  bool lands = flag == CV_TSTOP_RETURN;
  double taken = (lands ? stop : m->t) - s->t;
  if (!(taken > 0)) return hk_sundials_stuck(&m->sundials);
  m->running = true;
  hk_sundials_notice(&m->sundials, taken);
  CVodeGetCurrentStep(m->memory, &m->planned);
  m->planned = hk_sundials_next(m->planned, taken, stop - s->t - taken, m->most);
  memcpy(s->X, m->sundials.state, s->size * sizeof *s->X);
  *out = (hk_step){taken, m->planned, error_of(m)};
  return HK_OK;
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 5,
                                         .stages = 1,
                                         .flags = HK_ADAPTIVE | HK_IMPLICIT | HK_NEEDS_JACOBIAN,
                                         .step = step,
                                         .reset = reset,
                                         .growth = growth};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "cvode",
    .summary =
        "SUNDIALS' CVODE: BDF (orders 1 to 5, Newton with the scene's solver) or Adams-Moulton (orders 1 to 12); "
        "chooses steps and orders by the tolerance",
    .reference = "Hindmarsh and others 2005, ACM TOMS 31, SUNDIALS; Cohen and Hindmarsh 1996, Computers in Physics 10",
    .instance_size = sizeof(cvode),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .integrator = &integrator,
};
