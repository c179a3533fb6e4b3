/* hang(32), 0.5 s, to 3e-3 m: hooke's best integrator beside XPBD, which is what one would take from a game engine:
 * hooke's own plugin over its settings, and a plain C program as its user writes it (gravity and drag, then one
 * Gauss-Seidel sweep over the springs in their order per substep, compliance 1/k and the springs' damping). To reach:
 * ten times faster than either.
 *
 * Every method runs over a ladder of steps, its coarsest below what it needs; the cheapest run whose error is at most
 * the target counts, and is repeated in turn with the others. The reference is of the flat start in exact symmetry, on
 * which two methods agree although it is a buckling knife-edge (a perturbation of 1e-9 m grows to 2.6e-5 m). */
#include "tests/bench/plain.h"

enum { SIDE = 32, REPEATS = 5, RUNGS = 24 };
static const double end = 0.5, target = 3e-3, goal = 10; /* s, m */

typedef struct outcome {
  double error, seconds;
} outcome;

typedef struct method {
  const char *name, *plugin; /* NULL: the plain program */
  bool xpbd;
  const char *sweep, *order; /* xpbd's settings */
  double bdf;
  size_t first; /* steps of the coarsest rung */
} method;

#define EXPLICIT(plugin)                                                                                               \
  { plugin, plugin, false, NULL, NULL, 0, 1500 }
#define XPBD(sweep, order, bdf)                                                                                        \
  { "xpbd, " sweep ", " order ", bdf " #bdf, "xpbd", true, sweep, order, bdf, 1000 }
static const method methods[] = {
    EXPLICIT("stoermer_wide2"),      EXPLICIT("leapfrog"),
    EXPLICIT("symplectic_euler"),    XPBD("forward", "colours", 1),
    XPBD("symmetric", "colours", 1), XPBD("forward", "colours", 2),
    XPBD("symmetric", "colours", 2), XPBD("forward", "scene", 1),
    XPBD("symmetric", "scene", 1),   {"XPBD in plain C", NULL, true, NULL, NULL, 1, 1000},
};
enum { METHODS = sizeof methods / sizeof *methods };

static void set_text(test_engine *e, hk_plugin_spec *i, const char *name, const char *text) {
  const hk_param *p = hk_spec_param(i, name, &e->error);
  hk_value value = {.kind = HK_VALUE_STRING, .text = text};
  if (p && hk_spec_set(i, p, &value, e->scene->n, &e->error) == HK_OK) return;
  fprintf(stderr, "xpbd: %s\n", e->error.text);
  exit(1);
}

static outcome with_hooke(const method *m, size_t steps, double *x) {
  test_engine e;
  open_reference(&e, SIDE, false, end);
  hk_plugin_spec *i = test_plugin(&e, HK_INTEGRATOR, m->plugin);
  e.options.dt = m->xpbd ? end : end / (double)steps;
  if (m->xpbd) {
    test_number(&e, i, "substeps", (double)steps);
    test_number(&e, i, "bdf", m->bdf);
    set_text(&e, i, "sweep", m->sweep);
    set_text(&e, i, "order", m->order);
  }
  test_run(&e);
  double begin = own();
  hk_status status = hk_run_advance(e.run, end, &e.error);
  outcome out = {status == HK_OK ? 0 : INFINITY, own() - begin};
  memcpy(x, e.run->state.X, 3 * e.run->dynamics.system.n * sizeof *x);
  test_engine_close(&e);
  return out;
}

/* One substep. Macklin and others 2016, (18) and (26), with the compliance 1/(k h^2) and gamma = c/(k h), written so
 * that root and division do not wait for each other: a quarter faster than line by line. */
static void substep(const plain *p, double h, double *restrict x, double *restrict v, double *restrict before) {
  for (size_t e = 0; e < 3 * p->n; e++) {
    before[e] = x[e];
    if (p->w[e / 3] > 0) v[e] += h * ((e % 3 == 2 ? -9.81 : 0) - 0.02 * v[e]);
    x[e] += h * v[e];
  }
  for (const spring *s = p->springs, *stop = s + p->count; s < stop; s++) {
    const size_t i = 3 * (size_t)s->i, j = 3 * (size_t)s->j;
    double wi = p->w[s->i], wj = p->w[s->j], gamma = s->c / (s->k * h), alpha = 1 / (s->k * h * h);
    double dx = x[j] - x[i], dy = x[j + 1] - x[i + 1], dz = x[j + 2] - x[i + 2], l2 = dx * dx + dy * dy + dz * dz;
    double moved = dx * (dx - before[j] + before[i]) + dy * (dy - before[j + 1] + before[i + 1]) +
                   dz * (dz - before[j + 2] + before[i + 2]);
    double l = sqrt(l2), f = ((l - s->L) * l + gamma * moved) / (((1 + gamma) * (wi + wj) + alpha) * l2);
    x[i] += wi * f * dx, x[i + 1] += wi * f * dy, x[i + 2] += wi * f * dz;
    x[j] -= wj * f * dx, x[j + 1] -= wj * f * dy, x[j + 2] -= wj * f * dz;
  }
  for (size_t e = 0; e < 3 * p->n; e++) v[e] = (x[e] - before[e]) / h;
}

static outcome in_plain_c(const plain *p, size_t steps, double *x) {
  double *X = memory(9 * p->n, sizeof *X), begin = own();
  memcpy(X, p->start, 6 * p->n * sizeof *X);
  for (size_t k = 0; k < steps; k++) substep(p, end / (double)steps, X, X + 3 * p->n, X + 6 * p->n);
  outcome out = {0, own() - begin};
  memcpy(x, X, 3 * p->n * sizeof *x);
  free(X);
  return out;
}

typedef struct problem {
  plain p;
  double *reference;
} problem;

static outcome measure(const method *m, const problem *q, size_t steps) {
  double *x = memory(3 * q->p.n, sizeof *x);
  outcome out = m->plugin ? with_hooke(m, steps, x) : in_plain_c(&q->p, steps, x);
  if (out.error == 0) out.error = rms(x, q->reference, q->p.n);
  if (!(out.error < 1)) out.error = INFINITY;
  free(x);
  return out;
}

/* Steps of the cheapest rung that reaches the target; 0: none does. */
static size_t climb(const method *m, const problem *q) {
  size_t steps = m->first;
  for (int r = 0; r < RUNGS; r++) {
    outcome out = measure(m, q, steps);
    if (out.error <= target) return steps;
    steps = (size_t)((double)steps * (m->xpbd ? 1.1 : 1.04));
  }
  return 0;
}

static void converge(problem *q) {
  test_engine e;
  open_reference(&e, SIDE, false, end);
  test_run(&e);
  q->p = plain_of(&e);
  test_engine_close(&e);
  q->reference = memory(3 * q->p.n, sizeof *q->reference);
  const method fine = EXPLICIT("stoermer5"), other = EXPLICIT("rk4");
  with_hooke(&fine, 8000, q->reference);
  outcome out = measure(&other, q, 8000);
  printf("hang(%d), %.1f s: stoermer5 and rk4 of 8000 steps end %.1e m apart\n", SIDE, end, out.error);
  if (out.error <= target / 100) return;
  fprintf(stderr, "the reference does not support errors of %g m: shorten its steps\n", target);
  exit(1);
}

int main(void) {
  problem q;
  size_t steps[METHODS];
  double seconds[METHODS][REPEATS], ours = INFINITY;
  outcome out[METHODS];
  converge(&q);
  for (int m = 0; m < METHODS; m++) steps[m] = climb(&methods[m], &q);
  for (int r = 0; r < REPEATS; r++)
    for (int m = 0; m < METHODS; m++) {
      if (steps[m]) out[m] = measure(&methods[m], &q, steps[m]);
      seconds[m][r] = steps[m] ? out[m].seconds : INFINITY;
    }
  for (int m = 0; m < METHODS; m++)
    if (!methods[m].xpbd) ours = fmin(ours, median(seconds[m], REPEATS));
  for (int m = 0; m < METHODS; m++) {
    if (!steps[m]) continue;
    double whole = median(seconds[m], REPEATS), ratio = whole / ours;
    printf("  %-34s %6zu steps  %8.1f ms  %.1e m  %5.2f times hooke's best", methods[m].name, steps[m], 1e3 * whole,
           out[m].error, ratio);
    if (methods[m].xpbd) printf(", %s %g", ratio >= goal ? "reaches" : "MISSES", goal);
    printf("\n");
  }
  free(q.reference);
  plain_free(&q.p);
  return 0;
}
