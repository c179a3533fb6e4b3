/* SUNDIALS' ARKODE (ARKStep): embedded Runge-Kutta pairs with ARKODE's own control of the step, as a general-purpose
 * method for comparison.
 *
 * `erk` is explicit; `dirk` is diagonally implicit, with Newton's iteration on hooke's Jacobian and the scene's solver.
 * See plugins/common/sundials/sundials.c for the weights of errors and for the linear algebra. If the user gives a dt,
 * the steps are fixed: the time to the host's next stop is divided into equal steps of at most dt, and no error is
 * estimated. Otherwise ARKODE chooses the steps, and its stop time is set so that a step ends at the host's stop. The
 * flags, the order and the growth are those of the default, Dormand and Prince's pair of order 5. The only
 * history is the length of the step.
 *
 * It is the yardstick: a curtain of 32 x 32 particles by the cheapest of SUNDIALS' methods on hooke's forces takes 4.8
 * to 6.4 times as long as by hooke's own, for errors of 1e-3 to 1e-7 m (build/bench/rivals).
 */
#include "plugins/common/integrate/runge_kutta.h"
#include "plugins/common/sundials/sundials.h"
#include "plugins/common/sundials/sundials_vector.h"

#include <arkode/arkode_arkstep.h>
#include <string.h>

/* From SUNDIALS 7.1 on, functions that all of ARKODE's methods share have common names. */
#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
#define ARK(name) ARKode##name
#else
#define ARK(name) ARKStep##name
#endif

enum { ERK, DIRK, PATIENCE = 20 };
enum { SPARSE, KRYLOV };

typedef struct arkode {
  hk_sundials sundials; /* first member */
  int method, solver;
  int64_t order;
  void *memory;
  N_Vector error, weight;
  int64_t started; /* whether a step has been requested in this run */
  double fixed;    /* s, the dt that the user gave; 0: none, ARKODE chooses the steps */
  bool running;    /* whether ARKODE's state is X */
  double planned;  /* s, length of the next step that ARKODE proposes */
  double most;     /* s, the last h of the host that was shorter than `planned`, but not very; 0: no limit */
  double t;        /* s, ARKODE's time */
} arkode;

static const hk_param params[] = {
    {"method", "", "explicit or diagonally implicit", .choice = HK_AT(arkode, method), .initial = {ERK},
     .choices = "erk|dirk"},
    {"order", "", "order of the pair's better half: 2 to 5, of erk also 6 and 8", .integer = HK_AT(arkode, order),
     .initial = {5}, .limits = HK_WITHIN(2, 8)},
    {"solver", "", "of dirk: Newton with the scene's solver, or with GMRES", .choice = HK_AT(arkode, solver),
     .initial = {SPARSE}, .choices = "sparse|krylov"},
    {"preconditioner", "", "of GMRES: a factorization kept over steps, the diagonal blocks, or none",
     .choice = HK_AT(arkode, sundials.preconditioner), .initial = {HK_PRECONDITION_FACTOR},
     .choices = "factor|block_jacobi|none"},
    {0},
};

static const hk_field fields[] = {
    {"started", .integer = HK_AT(arkode, started)},
    {"fixed", .number = HK_AT(arkode, fixed)},
    {"state", .state = HK_AT(arkode, sundials.state), .width = 1, .flags = HK_SCRATCH},
    {"work", .state = HK_AT(arkode, sundials.work), .width = 2, .flags = HK_SCRATCH},
    {0},
};

/* Tables by order, from 2 on; SUNDIALS' own defaults differ between its versions. There is none of order 7. */
static const ARKODE_ERKTableID explicit_table[] = {ARKODE_HEUN_EULER_2_1_2, ARKODE_BOGACKI_SHAMPINE_4_2_3,
                                                   ARKODE_ZONNEVELD_5_3_4,  ARKODE_DORMAND_PRINCE_7_4_5,
                                                   ARKODE_VERNER_8_5_6,     ARKODE_ERK_NONE,
                                                   ARKODE_FEHLBERG_13_7_8};
static const ARKODE_DIRKTableID implicit_table[] = {ARKODE_SDIRK_2_1_2, ARKODE_ESDIRK324L2SA_4_2_3,
                                                    ARKODE_ESDIRK436L2SA_6_3_4, ARKODE_ESDIRK547L2SA2_7_4_5};

static int linear_system(double t, N_Vector X, N_Vector f, SUNMatrix A, SUNMatrix M, int reuse, int *current,
                         double gamma, void *self, N_Vector u, N_Vector v, N_Vector w) {
  (void)A, (void)M, (void)u, (void)v, (void)w;
  return hk_sundials_factorize(self, t, X, f, reuse, current, gamma);
}

static hk_status attach_solver(arkode *m) {
  hk_sundials *s = &m->sundials;
  if (m->method == ERK) return HK_OK;
  hk_status status = m->solver == SPARSE ? hk_sundials_direct(s) : hk_sundials_krylov(s);
  if (status != HK_OK) return status;
  int flag = ARK(SetLinearSolver)(m->memory, s->linear, s->matrix);
  if (flag == 0 && m->solver == SPARSE) flag = ARK(SetLinSysFn)(m->memory, linear_system);
  if (flag == 0 && m->solver == KRYLOV)
    flag = ARK(SetLSNormFactor)(m->memory, 1); /* GMRES has the 2-norm, above ours */
  if (flag == 0 && m->solver == KRYLOV && s->preconditioner != HK_PRECONDITION_NONE)
    flag = ARK(SetPreconditioner)(m->memory, hk_sundials_precondition, hk_sundials_preconditioned);
  return hk_sundials_setup(s, flag);
}

/* The interpolant is Lagrange's of degree 0: dense output is not used, and Hermite's would need more evaluations. */
static int set_options(arkode *m) {
  hk_sundials *s = &m->sundials;
  int flag = ARK(SetUserData)(m->memory, s);
#if SUNDIALS_VERSION_MAJOR < 7
  if (flag == 0) flag = ARKStepSetErrHandlerFn(m->memory, hk_sundials_hear, s);
#endif
  if (flag == 0) flag = ARK(WFtolerances)(m->memory, hk_sundials_weights);
  if (flag == 0 && m->method == ERK)
    flag = ARKStepSetTableNum(m->memory, ARKODE_DIRK_NONE, explicit_table[m->order - 2]);
  if (flag == 0 && m->method == DIRK)
    flag = ARKStepSetTableNum(m->memory, implicit_table[m->order - 2], ARKODE_ERK_NONE);
  if (flag == 0) flag = ARK(SetInterpolantType)(m->memory, ARK_INTERP_LAGRANGE);
  if (flag == 0) flag = ARK(SetInterpolantDegree)(m->memory, 0);
  if (flag == 0) flag = ARK(SetMaxHnilWarns)(m->memory, -1);
  return flag;
}

static void destroy(void *self, const hk_host *host) {
  arkode *m = self;
  (void)host;
#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
  if (m->memory) ARKodeFree(&m->memory);
#else
  if (m->memory) ARKStepFree(&m->memory);
#endif
  if (m->error) N_VDestroy(m->error);
  if (m->weight) N_VDestroy(m->weight);
  m->error = m->weight = NULL;
  hk_sundials_close(&m->sundials);
}

static hk_status set_up(arkode *m, const hk_host *host, const hk_view *view) {
  hk_sundials *s = &m->sundials;
  destroy(m, host);
  m->running = false;
  hk_status status = hk_sundials_open(s, host, view);
  if (status != HK_OK) return status;
  ARKRhsFn explicit_part = m->method == ERK ? hk_sundials_rates : NULL;
  m->memory = ARKStepCreate(explicit_part, explicit_part ? NULL : hk_sundials_rates, view->t, s->X, s->context);
  m->error = N_VClone(s->X);
  m->weight = N_VClone(s->X);
  if (!m->memory || !m->error || !m->weight || hk_sundials_vector_failed(s->X))
    return host->fail(host, HK_NO_MEMORY, "no memory for ARKODE");
  status = hk_sundials_setup(s, set_options(m));
  return status == HK_OK ? attach_solver(m) : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  arkode *m = self;
  if (m->order == 7 || (m->method == DIRK && m->order > 5))
    return host->fail(host, HK_BAD_PARAM, "order: erk has orders 2 to 6 and 8, dirk 2 to 5; %d is none of %s",
                      (int)m->order, m->method == ERK ? "erk" : "dirk");
  return set_up(m, host, view);
}

static hk_status topology(void *self, const hk_view *view) { return set_up(self, view->host, view); }

static void reset(void *self, hk_reason why) {
  arkode *m = self;
  m->running = false;
  if (why == HK_CHECKPOINT) m->most = 0;
}

static hk_status start(arkode *m, hk_system *s, double span, double h) {
  hk_status status = m->fixed > 0 && m->method == ERK ? HK_OK : hk_sundials_scale(&m->sundials, s, span);
  if (status != HK_OK) return status;
  memcpy(m->sundials.state, s->X, s->size * sizeof *s->X);
  m->t = s->t;
  m->planned = INFINITY;
  ARKRhsFn explicit_part = m->method == ERK ? hk_sundials_rates : NULL;
  int flag = ARKStepReInit(m->memory, explicit_part, explicit_part ? NULL : hk_sundials_rates, s->t, m->sundials.X);
  if (flag == 0) flag = ARK(SetInitStep)(m->memory, h < INFINITY ? h : 0);
  if (flag == 0 && m->fixed > 0 && m->method == DIRK)
    flag = ARK(SetMaxNonlinIters)(m->memory, PATIENCE); /* the step cannot be shortened */
  return hk_sundials_setup(&m->sundials, flag);
}

static bool rates_failed(int flag) {
  return flag == ARK_RHSFUNC_FAIL || flag == ARK_FIRST_RHSFUNC_ERR || flag == ARK_REPTD_RHSFUNC_ERR ||
         flag == ARK_UNREC_RHSFUNC_ERR;
}

static double error_of(const arkode *m) {
  if (m->fixed > 0) return NAN;
  ARK(GetEstLocalErrors)(m->memory, m->error);
  ARK(GetErrWeights)(m->memory, m->weight);
  return hk_sundials_norm(m->error, m->weight);
}

/* Determines the end of the next step. ARKODE gets the length of a fixed step, or otherwise a stop time. */
static int prepare(arkode *m, const hk_system *s, double t_stop, double h, double *stop) {
  double span = t_stop - s->t;
  *stop = t_stop;
  if (!(m->fixed > 0)) {
    double limit = hk_sundials_longest(h, m->planned, &m->most);
    if (t_stop - s->t > limit * (1 + 1e-9)) *stop = s->t + limit;
    return ARK(SetStopTime)(m->memory, *stop);
  }
  double pieces = ceil(span / m->fixed * (1 - 1e-12)), length = pieces > 1 ? span / pieces : span;
  if (pieces > 1) *stop = s->t + length;
  return ARK(SetFixedStep)(m->memory, length);
}

static int evolve(arkode *m, const hk_system *s, double t_stop, double h, double *stop) {
  int flag = prepare(m, s, t_stop, h, stop);
  return flag >= 0 ? ARK(Evolve)(m->memory, *stop, m->sundials.X, &m->t, ARK_ONE_STEP) : flag;
}

/* Called at the first step of a run: decides whether the steps are fixed. */
static void choose_fixed(arkode *m, double h) {
  m->fixed = h < INFINITY ? h : 0;
  if (m->fixed > 0)
    m->sundials.host->warn(
        m->sundials.host,
        "dt = %g s is given, so steps are fixed and tol is not used; leave dt out to have them chosen", h);
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  arkode *m = self;
  double stop;
  (void)method;
  m->sundials.system = s;
  m->sundials.status = HK_OK;
  *m->sundials.message = 0;
  if (!m->started) choose_fixed(m, h);
  if (!m->running || !hk_sundials_follows(&m->sundials, s, m->fixed > 0 ? 0 : s->tol)) {
    hk_status status = start(m, s, t_stop - s->t, m->started ? fmin(h, t_stop - s->t) : INFINITY);
    if (status != HK_OK) return status;
  }
  m->started = 1;
  m->running = false;
  int flag = evolve(m, s, t_stop, h, &stop);
  if (flag ==
      ARK_ERR_FAILURE) { /* a force may have jumped that found all at rest: the scales are those of what follows */
    hk_status status = start(m, s, t_stop - s->t, 0);
    if (status != HK_OK) return status;
    flag = evolve(m, s, t_stop, h, &stop);
  }
  if (flag < 0) return hk_sundials_failed(&m->sundials, flag, rates_failed(flag));
  bool lands = m->fixed > 0 || flag == ARK_TSTOP_RETURN;
  double taken = (lands ? stop : m->t) - s->t;
  if (!(taken > 0)) return hk_sundials_stuck(&m->sundials);
  m->running = true;
  hk_sundials_notice(&m->sundials, taken);
  ARK(GetCurrentStep)(m->memory, &m->planned);
  m->planned = hk_sundials_next(m->planned, taken, stop - s->t - taken, m->most);
  memcpy(s->X, m->sundials.state, s->size * sizeof *s->X);
  *out = (hk_step){taken, m->fixed > 0 ? m->fixed : m->planned, error_of(m)};
  return HK_OK;
}

/* The flags are the same for both methods: a solver is provided, though only dirk has matrices. */
static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 5,
                                         .stages = 7,
                                         .flags = HK_ADAPTIVE | HK_NEEDS_SOLVER,
                                         .method = &hk_dormand_prince,
                                         .step = step,
                                         .reset = reset,
                                         .growth = hk_rk_growth};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "arkode",
    .summary = "SUNDIALS' ARKODE: explicit (erk) or diagonally implicit (dirk) Runge-Kutta pairs of orders 2 to 8; "
               "chooses its steps by the tolerance, or takes the given dt",
    .reference = "Reynolds and others 2023, ACM TOMS 49, ARKODE; Dormand and Prince 1980; Verner 1978; Fehlberg 1968; "
                 "Kennedy and Carpenter 2019",
    .instance_size = sizeof(arkode),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .integrator = &integrator,
};
