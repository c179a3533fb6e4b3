/* Measured orders in scenes with constraints, of every method that takes them: a bar against the pendulum's published
 * figures, a chain of bars with springs on a moving pin and a bar whose length changes against programs of this file
 * that share no code with hooke. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct problem {
  double T;
  size_t steps; /* of a method of order 2 and one stage; `steps_of` says of others */
  void (*build)(test_engine *e, int64_t copies);
  size_t particles;
  const double *end; /* x and v at T, of all particles */
} problem;

static void adds_bar(test_engine *e, const uint32_t (*edge)[2], size_t count, int64_t copies) {
  hk_plugin_spec *bar = test_plugin(e, HK_CONSTRAINT, "fixture:bar");
  test_edges(e, bar, edge, count);
  test_number(e, bar, "copies", (double)copies);
}

static void set_velocity(test_engine *e, uint32_t id, double x, double y, double z) {
  double *v = e->scene->particles.velocity + 3 * (id - 1);
  v[0] = x, v[1] = y, v[2] = z;
}

/* ---- a pendulum: x'' = -l x, y'' = -l y - 1, x^2 + y^2 = 1 from (1, 0) with (0, 1), at t = 1; Hairer and Wanner ----
 */

static const double pendulum_end[] = {0, 0, 0, 0.867348640600439322,   0.497701050479672929,  0,
                                      0, 0, 0, -0.0337480180609545196, 0.0588130114652500075, 0};

static void pendulum(test_engine *e, int64_t copies) {
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -1, 0);
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 1, 0, 0, 1);
  set_velocity(e, 2, 0, 1, 0);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  adds_bar(e, (const uint32_t[][2]){{1, 2}}, 1, copies);
}

/* ---- three bars below a pin that moves along a parabola, with springs across them ---- */

enum { LINKS = 3, REFERENCE_STEPS = 20000 };
static const double start[LINKS + 1][3] = {{0, 0, 0}, {0.8, -0.2, 0.1}, {1.3, -0.9, 0.3}, {2.1, -0.7, -0.2}};
static const double mass[LINKS + 1] = {1, 0.7, 1.3, 0.4}, stiffness = 60, damping = 0.3;
static const uint32_t spring[2][2] = {{0, 2}, {1, 3}};
static const double lift[3] = {0.6, 0.4, -0.2}; /* acceleration of the pin */

static double distance(const double *a, const double *b) {
  return sqrt(pow(b[0] - a[0], 2) + pow(b[1] - a[1], 2) + pow(b[2] - a[2], 2));
}

static void add_springs(const double *x, const double *v, double *F) {
  for (int s = 0; s < 2; s++) {
    const double *a = x + 3 * spring[s][0], *b = x + 3 * spring[s][1];
    double l = distance(a, b), rest = distance(start[spring[s][0]], start[spring[s][1]]), along = 0;
    for (int c = 0; c < 3; c++) along += (b[c] - a[c]) / l * (v[3 * spring[s][1] + c] - v[3 * spring[s][0] + c]);
    for (int c = 0; c < 3; c++) {
      double f = (stiffness * (l - rest) + damping * along) * (b[c] - a[c]) / l;
      F[3 * spring[s][0] + c] += f;
      F[3 * spring[s][1] + c] -= f;
    }
  }
}

/* Gauss's elimination of a dense system, without pivots: it is positive definite. */
static void solve(double A[LINKS][LINKS], double b[LINKS]) {
  for (int k = 0; k < LINKS; k++)
    for (int r = k + 1; r < LINKS; r++) {
      double factor = A[r][k] / A[k][k];
      for (int c = k; c < LINKS; c++) A[r][c] -= factor * A[k][c];
      b[r] -= factor * b[k];
    }
  for (int k = LINKS - 1; k >= 0; k--) {
    for (int c = k + 1; c < LINKS; c++) b[k] -= A[k][c] * b[c];
    b[k] /= A[k][k];
  }
}

/* a of the chain by multipliers; (x - y).(x - y) = L^2 for each link, so J = 2 (x - y), in place of the distance. */
static void chain_slope(double t, const double *X, double *dX) {
  double x[12], v[12], F[12] = {0}, A[LINKS][LINKS] = {{0}}, b[LINKS];
  memcpy(x, X, sizeof x);
  memcpy(v, X + 12, sizeof v);
  for (int c = 0; c < 3; c++) x[c] = lift[c] * t * t / 2, v[c] = lift[c] * t;
  add_springs(x, v, F);
  for (int i = 0; i <= LINKS; i++)
    for (int c = 0; c < 3; c++) F[3 * i + c] = i == 0 ? lift[c] : F[3 * i + c] / mass[i] - (c == 1 ? 9.81 : 0);
  for (int k = 0; k < LINKS; k++) {
    b[k] = 0;
    for (int c = 0; c < 3; c++) {
      double d = x[3 * k + 3 + c] - x[3 * k + c], u = v[3 * k + 3 + c] - v[3 * k + c];
      b[k] -= d * (F[3 * k + 3 + c] - F[3 * k + c]) + u * u;
      A[k][k] += d * d * (1 / mass[k + 1] + (k ? 1 / mass[k] : 0));
      if (k + 1 < LINKS) A[k][k + 1] -= d * (x[3 * k + 6 + c] - x[3 * k + 3 + c]) / mass[k + 1];
    }
    if (k + 1 < LINKS) A[k + 1][k] = A[k][k + 1];
  }
  solve(A, b);
  for (int k = 0; k < LINKS; k++)
    for (int c = 0; c < 3; c++) {
      double d = x[3 * k + 3 + c] - x[3 * k + c];
      F[3 * k + 3 + c] += b[k] * d / mass[k + 1];
      if (k) F[3 * k + c] -= b[k] * d / mass[k];
    }
  memcpy(dX, v, sizeof v);
  memcpy(dX + 12, F, sizeof F);
}

/* The classical Runge-Kutta method, for any slope of `size` numbers. */
static void integrate(void (*slope)(double, const double *, double *), double T, double *X, int size) {
  double h = T / REFERENCE_STEPS, k[4][24], at[24];
  static const double c[4] = {0, 0.5, 0.5, 1}, w[4] = {1, 2, 2, 1};
  for (int n = 0; n < REFERENCE_STEPS; n++) {
    for (int s = 0; s < 4; s++) {
      for (int e = 0; e < size; e++) at[e] = X[e] + (s ? h * c[s] * k[s - 1][e] : 0);
      slope((n + c[s]) * h, at, k[s]);
    }
    for (int s = 0; s < 4; s++)
      for (int e = 0; e < size; e++) X[e] += h / 6 * w[s] * k[s][e];
  }
}

static const double *chain_end(double T) {
  static double X[24];
  memset(X, 0, sizeof X);
  memcpy(X, start, sizeof start);
  integrate(chain_slope, T, X, 24);
  for (int c = 0; c < 3; c++) X[c] = lift[c] * T * T / 2, X[12 + c] = lift[c] * T;
  return X;
}

static hk_status path(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                      size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  for (int c = 0; c < 3; c++) out[c] = lift[c] * in[0] * in[0] / 2, out[3 + c] = lift[c] * in[0];
  *n_out = 6;
  return HK_OK;
}

static void chain(test_engine *e, int64_t copies) {
  uint32_t pivot = 1, edge[2][2];
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -9.81, 0);
  for (int i = 0; i <= LINKS; i++) test_particle(e, start[i][0], start[i][1], start[i][2], mass[i]);
  hk_pin_spec pin = {.kind = HK_PIN_PATH, .count = 1, .id = &pivot, .release = INFINITY, .path = {.call = path}};
  assert_int_equal(hk_scene_add_pin(e->scene, &pin, &e->error), HK_OK);
  for (int s = 0; s < 2; s++)
    for (int c = 0; c < 2; c++) edge[s][c] = spring[s][c] + 1;
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, 2);
  test_number(e, springs, "k", stiffness);
  test_number(e, springs, "damping", damping);
  adds_bar(e, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, 3, copies);
}

/* ---- a bar of length l = 1 + 0.3 sin 2t about a pin, in the angle: p'' = -(2 l' p' + g sin p)/l ---- */

static void swing_slope(double t, const double *X, double *dX) {
  double l = 1 + 0.3 * sin(2 * t), speed = 0.6 * cos(2 * t);
  dX[0] = X[1];
  dX[1] = -(2 * speed * X[1] + 9.81 * sin(X[0])) / l;
}

static const double *swing_end(double T) {
  static double end[12];
  double X[2] = {1.1, 0}, l = 1 + 0.3 * sin(2 * T), speed = 0.6 * cos(2 * T);
  integrate(swing_slope, T, X, 2);
  end[3] = l * sin(X[0]), end[4] = -l * cos(X[0]);
  end[9] = speed * sin(X[0]) + l * cos(X[0]) * X[1], end[10] = -speed * cos(X[0]) + l * sin(X[0]) * X[1];
  return end;
}

static void swing(test_engine *e, int64_t copies) {
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -9.81, 0);
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, sin(1.1), -cos(1.1), 0, 0.8);
  set_velocity(e, 2, 0.6 * sin(1.1), -0.6 * cos(1.1), 0);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  for (int64_t k = 0; k < copies; k++) {
    hk_plugin_spec *bar = test_plugin(e, HK_CONSTRAINT, "fixture:telescope");
    test_edges(e, bar, (const uint32_t[][2]){{1, 2}}, 1);
    test_number(e, bar, "amplitude", 0.3);
    test_number(e, bar, "rate", 2);
  }
}

/* ---- measuring ---- */

static void open_problem(test_engine *e, const problem *p, const char *method, int64_t copies, double tol) {
  test_engine_open(e);
  p->build(e, copies);
  test_exact_integrator(e, method);
  e->options.tol = tol;
  e->scene->duration = p->T;
}

static double error_of(test_engine *e, const problem *p) {
  double sum = 0;
  size_t count = 3 * p->particles;
  const hk_view *view = hk_run_view(e->run);
  for (size_t k = 0; k < count; k++) sum += pow(view->x[k] - p->end[k], 2) + pow(view->v[k] - p->end[count + k], 2);
  return sqrt(sum);
}

/* Violation: 1e-12 of the extent, below 4 m, is what a projection stops at. */
static double error_at(const problem *p, const char *method, int64_t copies, size_t steps) {
  test_engine e;
  hk_summary s;
  open_problem(&e, p, method, copies, 1e30); /* adaptive methods then take the steps they are given */
  e.scene->fps = (double)steps / p->T;
  e.options.dt = p->T / (double)steps * (1 + 1e-6); /* a step reaches the next frame, whatever its last digit */
  test_run(&e);
  test_advance(&e, p->T);
  hk_run_summary(e.run, &s);
  assert_true(s.constraint_violation < 4e-12);
  assert_int_equal(s.steps, steps);
  double error = error_of(&e, p);
  test_engine_close(&e);
  return error;
}

/* Of the same length: order and stages of the methods differ. */
static size_t steps_of(const problem *p, const hk_integrator *method) {
  double part = method->order == 1 ? 4 : method->order == 2 ? 1 : method->order == 3 ? 0.4 : 0.2;
  return (size_t)((double)p->steps * part);
}

/* Halving the step divides the error by 2^order up to the next term of its expansion, O(h) of the first; a method may
 * do better where the first term is small by luck. 0.25 is what the coarsest of these steps leaves of it. */
static void check(const problem *p, const char *name, const hk_integrator *method) {
  size_t steps = steps_of(p, method);
  for (int64_t copies = 1; copies <= 2; copies++) {
    double coarse = error_at(p, name, copies, steps), fine = error_at(p, name, copies, 2 * steps);
    double order = log2(coarse / fine);
    print_message("%-18s copies %d: order %.2f, error %.1e\n", name, (int)copies, order, fine);
    if (!(order > method->order - 0.25)) fail_msg("%s: order %.3f, not %d", name, order, method->order);
  }
}

static double size_of_end(const problem *p) {
  double sum = 0;
  for (size_t k = 0; k < 6 * p->particles; k++) sum += p->end[k] * p->end[k];
  return sqrt(sum);
}

/* CVODE chooses order and step by the tolerance, which is relative: the error follows it. The errors of some hundred
 * steps add up. */
static void check_tolerance(const problem *p, const char *name) {
  for (int64_t copies = 1; copies <= 2; copies++)
    for (double tol = 1e-4; tol > 1e-9; tol /= 100) {
      test_engine e;
      open_problem(&e, p, name, copies, tol);
      e.scene->fps = 1 / p->T;
      test_run(&e);
      test_advance(&e, p->T);
      double error = error_of(&e, p);
      print_message("%-18s copies %d: tol %.0e, error %.1e\n", name, (int)copies, tol, error);
      assert_true(error < 300 * tol * size_of_end(p));
      test_engine_close(&e);
    }
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

static void for_all(const problem *p) {
  char names[64][32];
  size_t count = 0, measured = 0;
  DIR *folder = opendir(HK_BUILD "/plugins/integrators");
  assert_non_null(folder);
  for (struct dirent *at; (at = readdir(folder)) && count < 64;) {
    char *end = strstr(at->d_name, ".so");
    if (end && end[3] == 0) snprintf(names[count++], sizeof *names, "%.*s", (int)(end - at->d_name), at->d_name);
  }
  closedir(folder);
  qsort(names, count, sizeof *names, by_name);
  for (size_t k = 0; k < count; k++) {
    test_engine e;
    const hk_plugin *plugin;
    test_engine_open(&e);
    assert_int_equal(hk_registry_find(&e.registry, HK_INTEGRATOR, names[k], false, &plugin, &e.error), HK_OK);
    const hk_integrator *method = plugin->integrator;
    if (method->flags & HK_IMPLICIT && !hk_integrator_of(plugin)->constrained.refused) {
      measured++;
      if (strcmp(names[k], "cvode") == 0)
        check_tolerance(p, names[k]);
      else
        check(p, names[k], method);
    }
    test_engine_close(&e);
  }
  assert_true(measured >=
              9); /* backward Euler, midpoint, trapezoid, BDF2, TR-BDF2, ESDIRK4, IMEX, Baraff-Witkin, CVODE */
}

static void implicit_methods_keep_their_order_on_a_pendulum(void **state) {
  (void)state;
  for_all(&(problem){1, 200, pendulum, 2, pendulum_end});
}

static void implicit_methods_keep_their_order_on_bars_with_springs_and_a_moving_pin(void **state) {
  (void)state;
  for_all(&(problem){0.75, 300, chain, LINKS + 1, chain_end(0.75)});
}

static void implicit_methods_keep_their_order_on_a_bar_that_changes_its_length(void **state) {
  (void)state;
  for_all(&(problem){1.5, 300, swing, 2, swing_end(1.5)});
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(implicit_methods_keep_their_order_on_a_pendulum),
      cmocka_unit_test(implicit_methods_keep_their_order_on_bars_with_springs_and_a_moving_pin),
      cmocka_unit_test(implicit_methods_keep_their_order_on_a_bar_that_changes_its_length),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
