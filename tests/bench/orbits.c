/* Undamped motion, where methods of order 6 and 8 win: the sun and the outer planets for 200,000 days, and a ring of
 * bodies around a heavy one. hooke's methods beside SUNDIALS' explicit Runge-Kutta methods of order 5 and 8 with fixed
 * steps and with tolerances, on a plain loop over pairs and on hooke's forces; one thread, the thread's own time.
 *
 * Every method runs over a ladder of steps, each 1.3 times the last, until its error is below the smallest target; what
 * reaches a target is interpolated between rungs (log-log), and its time is that of the least of REPEATS runs.
 * The reference is stoermer8 with steps four times as many as any; Fehlberg's method of order 8 must agree with it. */
#include "plugins/common/sundials/sundials.h"
#include "tests/support/engine.h"

#include <arkode/arkode_erkstep.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
#define ERK(name) ARKode##name
#else
#define ERK(name) ERKStep##name
#endif

enum { TARGETS = 3, REPEATS = 2, RUNGS = 40, MOST = 512 };
typedef enum side { HOOKE, PLAIN, SHARED, SIDES } side;
static const char *const side_name[SIDES] = {"hooke", "SUNDIALS, plain C forces", "SUNDIALS, hooke's forces"};

/* ---- the scenes: Hairer, Lubich and Wanner, Geometric Numerical Integration, I.2.4; and a ring ---- */

typedef struct bodies {
  const char *name;
  size_t n;
  double G, end, mass[MOST], x[3 * MOST], v[3 * MOST];
  double target[TARGETS], first; /* of each distance, and the number of evaluations to begin with */
  double reference[3 * MOST];
} bodies;

static const bodies planets = {
    "the sun and five planets, 200,000 days",
    6,
    2.95912208286e-4,
    200000,
    {1.00000597682, 0.000954786104043, 0.000285583733151, 0.0000437273164546, 0.0000517759138449, 1 / 1.3e8},
    {0, 0, 0, -3.5023653, -3.8169847, -1.5507963, 9.0755314, -3.0458353, -1.6483708, 8.3101420, -16.2901086, -7.2521278,
     11.4707666, -25.7294829, -10.8169456, -15.5387357, -25.2225594, -3.1902382},
    {0, 0, 0, 0.00565429, -0.00412490, -0.00190589, 0.00168318, 0.00483525, 0.00192462, 0.00354178, 0.00137102,
     0.00055029, 0.00288930, 0.00114527, 0.00039677, 0.00276725, -0.00170702, -0.00136504},
    {1e-4, 1e-6, 1e-8},
    1000,
    {0}};

/* Circles of radius 1 to 2 around a body of mass 1, once to three times round in 20 s. */
static bodies ring_of(size_t n) {
  bodies b = {.name = "a ring of 256 bodies, 20 s", .n = n, .G = 1, .end = 20, .mass = {1}, .first = 200};
  for (size_t i = 1; i < n; i++) {
    double r = 1 + (double)i / (double)n, angle = 2.399963229728653 * (double)i, speed = 1 / sqrt(r); /* golden */
    b.mass[i] = 1e-8;
    b.x[3 * i] = r * cos(angle), b.x[3 * i + 1] = r * sin(angle), b.x[3 * i + 2] = 0.05 * sin(3 * angle);
    b.v[3 * i] = -speed * sin(angle), b.v[3 * i + 1] = speed * cos(angle);
  }
  for (int k = 0; k < TARGETS; k++) b.target[k] = pow(10, -6 - 2 * k);
  return b;
}

static void open_bodies(test_engine *e, const bodies *b) {
  test_engine_open(e);
  e->scene->threads = 1;
  for (size_t i = 0; i < b->n; i++) {
    uint32_t id = test_particle(e, b->x[3 * i], b->x[3 * i + 1], b->x[3 * i + 2], b->mass[i]);
    memcpy(e->scene->particles.velocity + 3 * (id - 1), b->v + 3 * i, 3 * sizeof *b->v);
  }
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "nbody");
  test_number(e, force, "G", b->G);
  e->scene->fps = 1 / b->end;
  e->options.until = b->end;
}

static void plain_forces(const bodies *b, const double *restrict x, double *restrict a) {
  memset(a, 0, 3 * b->n * sizeof *a);
  for (size_t i = 0; i < b->n; i++)
    for (size_t j = i + 1; j < b->n; j++) {
      double d[3], square = 0;
      for (int c = 0; c < 3; c++) d[c] = x[3 * j + c] - x[3 * i + c], square += d[c] * d[c];
      double f = b->G / (square * sqrt(square));
      for (int c = 0; c < 3; c++) a[3 * i + c] += f * b->mass[j] * d[c], a[3 * j + c] -= f * b->mass[i] * d[c];
    }
}

/* ---- a run of each side ---- */

typedef struct method {
  const char *name;
  side side;
  int table; /* SUNDIALS' */
  double stages;
  bool adaptive;
} method;

/* Not Verner's method of order 6: with SUNDIALS 6.4 its error falls with the third power of the step. */
#define SUNDIALS_SIDE(side)                                                                                            \
  {"Dormand-Prince 5", side, ARKODE_DORMAND_PRINCE_7_4_5, 6, false},                                                   \
      {"Fehlberg 8", side, ARKODE_FEHLBERG_13_7_8, 13, false}, {                                                       \
    "Fehlberg 8, rtol", side, ARKODE_FEHLBERG_13_7_8, 13, true                                                         \
  }
static const method methods[] = {{"stoermer8", HOOKE, 0, 1, false},
                                 {"kahan_li8", HOOKE, 0, 17, false},
                                 {"stoermer5", HOOKE, 0, 1, false},
                                 {"blanes_moan", HOOKE, 0, 6, false},
                                 {"wisdom_holman", HOOKE, 0, 8, false},
                                 SUNDIALS_SIDE(PLAIN),
                                 SUNDIALS_SIDE(SHARED)};
enum { METHODS = sizeof methods / sizeof *methods };

typedef struct outcome {
  double error, seconds, evaluations;
} outcome;

static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double distance(const bodies *b, const double *x) {
  double most = 0;
  for (size_t e = 0; e < 3 * b->n; e++) most = fmax(most, fabs(x[e] - b->reference[e]));
  return most;
}

static outcome with_hooke(const method *m, const bodies *b, double steps, double *x) {
  test_engine e;
  open_bodies(&e, b);
  test_plugin(&e, HK_INTEGRATOR, m->name);
  e.options.dt = b->end / steps;
  test_run(&e);
  double begin = own();
  hk_status status = hk_run_advance(e.run, b->end, &e.error);
  outcome out = {status == HK_OK ? 0 : INFINITY, own() - begin, (double)e.run->dynamics.count.evaluations};
  memcpy(x, e.run->state.X, 3 * b->n * sizeof *x);
  test_engine_close(&e);
  return out;
}

typedef struct program {
  const bodies *b;
  hk_system *s; /* NULL: plain forces */
  double evaluations;
} program;

static int rates(double t, N_Vector X, N_Vector dX, void *user) {
  program *r = user;
  size_t half = 3 * r->b->n;
  double *x = NV_DATA_S(X), *dx = NV_DATA_S(dX), none = 0, work;
  r->evaluations++;
  memcpy(dx, x + half, half * sizeof *dx);
  if (r->s) return r->s->accelerations(r->s, t, x, x + half, &none, dx + half, &work) != HK_OK;
  plain_forces(r->b, x, dx + half);
  return 0;
}

static void must(int flag) {
  if (flag >= 0) return;
  fprintf(stderr, "SUNDIALS refuses a setting: %d\n", flag);
  exit(1);
}

/* Fixed steps; or rtol = 1e-3/steps^3, so that a ladder is as long, with atol in proportion. */
static outcome with_sundials(const method *m, const bodies *b, double steps, double *x) {
  test_engine e;
  SUNContext context = NULL;
  program r = {.b = b};
  double X[6 * MOST], t = 0;
  if (m->side == SHARED) {
    open_bodies(&e, b);
    test_run(&e);
    r.s = &e.run->dynamics.system;
  }
#if SUNDIALS_VERSION_MAJOR < 7
  must(SUNContext_Create(NULL, &context));
#define QUIET(memory) must(ERKStepSetErrFile(memory, NULL))
#else
#define QUIET(memory) must(SUNContext_ClearErrHandlers(context))
  must(SUNContext_Create(SUN_COMM_NULL, &context));
#endif
  memcpy(X, b->x, 3 * b->n * sizeof *X);
  memcpy(X + 3 * b->n, b->v, 3 * b->n * sizeof *X);
  N_Vector v = N_VMake_Serial((sunindextype)(6 * b->n), X, context);
  void *memory = ERKStepCreate(rates, 0, v, context);
  QUIET(memory);
  must(ERKStepSetTableNum(memory, (ARKODE_ERKTableID)m->table));
  must(ERK(SetUserData)(memory, &r));
  must(ERK(SetMaxNumSteps)(memory, 10000000));
  must(ERK(SetStopTime)(memory, b->end));
  double rtol = 1e-3 / pow(steps, 3);
  must(m->adaptive ? ERK(SStolerances)(memory, rtol, 1e-3 * rtol) : ERK(SetFixedStep)(memory, b->end / steps));
  double begin = own();
  int flag = ERK(Evolve)(memory, b->end, v, &t, ARK_NORMAL);
  outcome out = {flag >= 0 ? 0 : INFINITY, own() - begin, r.evaluations};
  memcpy(x, X, 3 * b->n * sizeof *x);
  ERK(Free)(&memory);
  N_VDestroy(v);
  SUNContext_Free(&context);
  if (m->side == SHARED) test_engine_close(&e);
  return out;
}

/* The least time of some runs. */
static outcome measure(const method *m, const bodies *b, double steps) {
  double x[3 * MOST];
  outcome best = {.seconds = INFINITY};
  for (int r = 0; r < REPEATS; r++) {
    outcome out = m->side == HOOKE ? with_hooke(m, b, steps, x) : with_sundials(m, b, steps, x);
    if (out.seconds < best.seconds) best = out;
  }
  if (best.error == 0) best.error = distance(b, x);
  return best;
}

/* ---- ladders ---- */

typedef struct best {
  const method *m;
  double seconds, evaluations;
} best;

static double between(double part, double a, double b) { return b * pow(a / b, part); }

static void climb(const method *m, const bodies *b, best table[SIDES][TARGETS]) {
  outcome last = {.error = INFINITY};
  double steps = ceil((m->adaptive ? 3 : b->first / m->stages)), least = b->target[TARGETS - 1];
  for (int rung = 0; rung < RUNGS && !(last.error <= least); rung++, steps = ceil(1.3 * steps)) {
    outcome now = measure(m, b, steps);
    if (isinf(now.error) && isfinite(last.error)) return; /* a tolerance below rounding */
    for (int k = 0; k < TARGETS; k++) {
      best *t = &table[m->side][k];
      if (!(now.error <= b->target[k]) || !(last.error > b->target[k])) continue;
      double part = isfinite(last.error) ? log(b->target[k] / now.error) / log(last.error / now.error) : 0;
      double seconds = part > 0 ? between(part, last.seconds, now.seconds) : now.seconds,
             evaluations = part > 0 ? between(part, last.evaluations, now.evaluations) : now.evaluations;
      printf("    %-26s %-18s %.0e: %8.0f evaluations  %9.3f ms\n", side_name[m->side], m->name, b->target[k],
             evaluations, 1e3 * seconds);
      if (!t->m || seconds < t->seconds) *t = (best){m, seconds, evaluations};
    }
    last = now;
  }
}

static void compare(bodies *b) {
  best table[SIDES][TARGETS] = {{{NULL, 0, 0}}};
  const method fine = {"stoermer8", HOOKE, 0, 1, false}, other = {"", PLAIN, ARKODE_FEHLBERG_13_7_8, 13, false};
  with_hooke(&fine, b, 200 * b->first, b->reference);
  printf("%s; two methods end %.1e apart\n", b->name, measure(&other, b, 20 * b->first).error);
  for (int l = 0; l < METHODS; l++) climb(&methods[l], b, table);
  for (int k = 0; k < TARGETS; k++)
    for (side s = 0; s < SIDES; s++) {
      const best *t = &table[s][k];
      if (!t->m) continue;
      printf("  %.0e  %-26s %-18s %8.0f evaluations  %9.3f ms", b->target[k], side_name[s], t->m->name, t->evaluations,
             1e3 * t->seconds);
      if (s != HOOKE && table[HOOKE][k].m) printf("  %.1f times hooke's", t->seconds / table[HOOKE][k].seconds);
      printf("\n");
    }
}

int main(void) {
  static bodies b;
  setvbuf(stdout, NULL, _IOLBF, 0);
  b = planets;
  compare(&b);
  b = ring_of(256);
  compare(&b);
  return 0;
}
