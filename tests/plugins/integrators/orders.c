/* Measured orders of every integrator in the build that works on any f(X, t), against solutions that are known by
 * construction. */
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { N = 2, WIDTH = 1, PARTS = 4, PIECES = 8 };
static const double T = 2;
static const char *const part_name[PARTS] = {"x", "v", "channel", "work"};

/* Methods whose order is lower when forces or rates depend on v or y, as their summaries say. */
static const struct {
  const char *name;
  int order;
} lower[] = {{"blanes_moan", 2}, {"kahan_li8", 2}, {"wisdom_holman", 2}};

/* With steps whose errors are above rounding the first is not stable here, and the iteration of the second does not
 * converge: their orders are measured in stoermer.c and gauss_radau.c. */
static bool measured_elsewhere(const char *name) {
  return strcmp(name, "stoermer8") == 0 || strcmp(name, "gauss_radau") == 0;
}

/* The solution: q_e = e/4 + sin((1 + e/10) t + e), r_i = 2 + cos(t + i), work t/2 + sin(2t)/4. */
static double q(size_t e, double t) { return (double)e / 4 + sin((1 + (double)e / 10) * t + (double)e); }
static double dq(size_t e, double t) { return (1 + (double)e / 10) * cos((1 + (double)e / 10) * t + (double)e); }
static double ddq(size_t e, double t) {
  double w = 1 + (double)e / 10;
  return -w * w * sin(w * t + (double)e);
}
static double r(size_t i, double t) { return 2 + cos(t + (double)i); }
static double dr(size_t i, double t) { return -sin(t + (double)i); }

/* Nonlinear, coupled, explicit in t, of x alone. */
static void driven(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)v, (void)y;
  for (size_t e = 0; e < 3 * N; e++) {
    size_t o = (e + 1) % (3 * N);
    double p = q(e, t), po = q(o, t);
    a[e] = ddq(e, t) - 0.4 * (x[e] * x[e] * x[e] - p * p * p) - 0.3 * (x[e] * x[o] - p * po);
  }
  for (size_t i = 0; i < N; i++) dy[i] = dr(i, t) + x[i] * x[i + 1] - q(i, t) * q(i + 1, t);
  dy[N] = cos(t) * cos(t) + x[0] * x[0] - q(0, t) * q(0, t);
}

/* As well as a drag that is cubic in v, a channel with a rate of its own, and power. */
static void dragged(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                    double *dy) {
  driven(context, t, x, v, y, a, dy);
  for (size_t e = 0; e < 3 * N; e++) {
    size_t o = (e + 1) % (3 * N);
    double p = dq(e, t), po = dq(o, t);
    a[e] -= 0.3 * (v[e] * v[e] * v[e] - p * p * p) + 0.2 * (v[o] * x[o] - po * q(o, t));
  }
  for (size_t i = 0; i < N; i++) dy[i] += -0.5 * (y[i] * y[i] - r(i, t) * r(i, t)) + 0.3 * (v[i] - dq(i, t));
  dy[N] += v[0] * v[1] - dq(0, t) * dq(1, t);
}

static void add_squares(const double *X, double t, double sum[PARTS]) {
  for (size_t e = 0; e < 3 * N; e++) {
    sum[0] += pow(X[e] - q(e, t), 2);
    sum[1] += pow(X[3 * N + e] - dq(e, t), 2);
  }
  for (size_t i = 0; i < N; i++) sum[2] += pow(X[6 * N + i] - r(i, t), 2);
  sum[3] += pow(X[7 * N] - (t / 2 + sin(2 * t) / 4), 2);
}

/* Root of the mean squares over components and eight times, so that no zero of the error is taken for its size. */
static void errors(const char *name, const fake_problem *problem, size_t steps, double error[PARTS]) {
  fake_system *f = fake_system_create(problem);
  f->system.tol = 1e30; /* adaptive methods then take the step they are given */
  double *X = f->system.X;
  for (size_t e = 0; e < 3 * N; e++) {
    X[e] = q(e, 0);
    X[3 * N + e] = dq(e, 0);
  }
  for (size_t i = 0; i < N; i++) X[6 * N + i] = r(i, 0);
  fake_method m = fake_method_open(name, f);
  fake_method_set(&m, "tolerance", 1e-14); /* of implicit methods: the algebraic error is far below the time error */
  memset(error, 0, PARTS * sizeof *error);
  for (int k = 1; k <= PIECES; k++) {
    fake_method_run(&m, T * k / PIECES, steps / PIECES);
    add_squares(X, T * k / PIECES, error);
  }
  for (int k = 0; k < PARTS; k++) error[k] = sqrt(error[k] / PIECES);
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* Halving h divides each part's error by 2^order. The next term of the expansion is O(h) of the first: the steps are
 * such that it changes the measured order by less than 0.2 and rounding does not show; a part may be better by luck, so
 * the worst one counts. */
static void check(const char *name, const fake_problem *problem, int order, int stages) {
  static const double steps[] = {0, 2000, 1000, 500, 320, 210, 210, 100, 40}; /* of methods of one stage */
  double coarse[PARTS], fine[PARTS], least = INFINITY;
  size_t count = (size_t)(steps[order < 8 ? order : 8] / sqrt(stages)) / PIECES * PIECES;
  errors(name, problem, count, coarse);
  errors(name, problem, 2 * count, fine);
  for (int k = 0; k < PARTS; k++) {
    double measured = log2(coarse[k] / fine[k]);
    least = fmin(least, measured);
    print_message("%-18s %-8s order %.2f, error %.1e\n", name, part_name[k], measured, fine[k]);
  }
  if (!(fabs(least - order) < 0.2)) fail_msg("%s: order %.3f, not %d", name, least, order);
}

static void for_all(const fake_problem *problem, bool with_lower) {
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names);
  assert_true(count > 0);
  for (size_t k = 0; k < count; k++) {
    fake_system *f = fake_system_create(problem);
    fake_method m = fake_method_open(names[k], f);
    int order = m.plugin->integrator->order;
    for (size_t i = 0; with_lower && i < sizeof lower / sizeof *lower; i++)
      if (strcmp(lower[i].name, names[k]) == 0) order = lower[i].order;
    if ((fake_method_explicit(&m) || fake_method_implicit(&m)) && !measured_elsewhere(names[k]))
      check(names[k], problem, order, m.plugin->integrator->stages);
    fake_method_close(&m);
    fake_system_destroy(f);
  }
}

static void order_is_as_stated_for_forces_of_x_and_t(void **state) {
  (void)state;
  for_all(&(fake_problem){N, WIDTH, HK_DEPENDS_ON_X | HK_DEPENDS_ON_T, driven, NULL}, false);
}

static void order_is_as_stated_with_drag_and_channels(void **state) {
  (void)state;
  unsigned all = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_DEPENDS_ON_CHANNELS;
  for_all(&(fake_problem){N, WIDTH, all, dragged, NULL}, true);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(order_is_as_stated_for_forces_of_x_and_t),
      cmocka_unit_test(order_is_as_stated_with_drag_and_channels),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
