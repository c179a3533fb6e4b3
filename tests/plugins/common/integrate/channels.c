/* Channels whose numbers act on each other, on their neighbours and on the motion, in the implicit methods and in those
 * that choose their steps: Robertson's reactions, a pair with one fast rate, exchange along a chain, predators and
 * prey, an oscillator whose stiffness is a channel. */
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Advances by the method's own steps to each of `stops` equal stops; returns the steps. */
static size_t drive(fake_system *f, fake_method *m, double t_end, size_t stops) {
  size_t steps = 0;
  double h = INFINITY;
  for (size_t k = 1; k <= stops; k++) {
    double stop = t_end * (double)k / (double)stops;
    for (; f->system.t < stop; steps++) {
      hk_step out = {0, 0, NAN};
      hk_status status = m->plugin->integrator->step(m->self, m->plugin->integrator->method, &f->system, stop,
                                                     fmin(h, stop - f->system.t), &out);
      if (status != HK_OK) fail_msg("%s: %s", m->plugin->name, f->message);
      f->system.t = out.h >= stop - f->system.t ? stop : f->system.t + out.h;
      h = out.h_next;
    }
  }
  return steps;
}

/* ---- Robertson 1966 ---- */

static void robertson(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                      double *dy) {
  (void)context, (void)t, (void)x, (void)v, (void)a;
  double slow = 0.04 * y[0], back = 1e4 * y[1] * y[2], fast = 3e7 * y[1] * y[1];
  dy[0] = back - slow;
  dy[1] = slow - back - fast;
  dy[2] = fast;
}

static double robertson_error(const char *name, double tol, size_t *steps, size_t *evaluations) {
  /* Runge and Kutta's method in long double with 16 million steps; 17 digits agree with 8 million. */
  static const double exact[3] = {0.715827068719405063, 9.18553476455776435e-06, 0.284163745745830323};
  double worst = 0;
  fake_system *f = fake_system_create(&(fake_problem){1, 3, HK_DEPENDS_ON_CHANNELS, robertson, NULL});
  f->system.X[6] = 1;
  f->system.tol = tol;
  fake_method m = fake_method_open(name, f);
  *steps = drive(f, &m, 40, 4);
  *evaluations = f->evaluations;
  for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(f->system.X[6 + k] - exact[k]) / exact[k]);
  fake_method_close(&m);
  fake_system_destroy(f);
  return worst;
}

/* Errors of single steps are damped here, so a few of them are left: 10 tol in every number, relative to itself, where
 * the order is 4 or 5. One of order 2 needs many: its local errors of the slow motion add up, steps x tol. The number
 * of steps of a stiff method must not follow the fast rate, as dopri5's 34,600 do: a tenth of them. */
static void stiff_reactions_are_held_to_the_tolerance(void **state) {
  (void)state;
  for (double tol = 1e-4; tol > 0.5e-11; tol /= 10) {
    size_t steps, evaluations;
    double error = robertson_error("esdirk4", tol, &steps, &evaluations);
    print_message("esdirk4, tol %.0e: %.1e in %zu steps, %zu evaluations\n", tol, error, steps, evaluations);
    assert_true(error < 10 * tol && steps < 3460);
    if (tol < 0.5e-8) continue;
    error = robertson_error("tr_bdf2", tol, &steps, &evaluations);
    print_message("tr_bdf2, tol %.0e: %.1e in %zu steps, %zu evaluations\n", tol, error, steps, evaluations);
    assert_true(error < (double)steps * tol && steps < 34600);
    error = robertson_error("dopri5", tol, &steps, &evaluations);
    print_message("dopri5,  tol %.0e: %.1e in %zu steps, %zu evaluations\n", tol, error, steps, evaluations);
    assert_true(error < 10 * tol);
  }
}

/* ---- one step ---- */

/* y' = A y with the eigenvalues -1 and -1e6, and vectors that mix the two numbers. */
static void pair(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                 double *dy) {
  (void)context, (void)t, (void)x, (void)v, (void)a;
  double fast = 1e6 * (y[0] - y[1]), slow = (y[0] + y[1]) / 2;
  dy[0] = -fast / 2 - slow;
  dy[1] = fast / 2 - slow;
}

/* Backward Euler divides the slow part by 1 + h and the fast one by 1 + 1e6 h; 1e-5 is ten of its algebraic tolerance.
 * Nothing moves. */
static void a_fast_pair_is_solved(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 2, HK_DEPENDS_ON_CHANNELS, pair, NULL});
  fake_method m = fake_method_open("backward_euler", f);
  f->system.X[6] = 3;
  f->system.X[7] = 1;
  assert_int_equal(fake_method_step(&m, 0.1, NULL), HK_OK);
  double sum = f->system.X[6] + f->system.X[7], difference = f->system.X[6] - f->system.X[7];
  assert_true(fabs(sum - 4 / 1.1) < 1e-5);
  assert_true(fabs(difference - 2 / (1 + 1e5)) < 1e-5);
  fake_method_close(&m);
  fake_system_destroy(f);
}

enum { CHAIN = 32 };

/* Heat flows between neighbours: dy_i = k (y_(i-1) - 2 y_i + y_(i+1)); the ends are closed. */
static void conduct(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                    double *dy) {
  double k = *(const double *)context;
  (void)t, (void)x, (void)v, (void)a;
  for (size_t i = 0; i + 1 < CHAIN; i++) {
    dy[i] += k * (y[i + 1] - y[i]);
    dy[i + 1] -= k * (y[i + 1] - y[i]);
  }
}

/* The step of backward Euler solves y' - y = h dy(y'): what is left is within ten of the algebraic tolerance, 1e-6, and
 * the sum is kept as far. h k = 1/2 is twice what an explicit step could take. */
static void exchange_between_particles_is_solved(void **state) {
  double k = 5, before[CHAIN], dy[CHAIN] = {0}, off = 0, sum = 0;
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){CHAIN, 1, HK_DEPENDS_ON_CHANNELS, conduct, &k});
  fake_method m = fake_method_open("backward_euler", f);
  double *y = f->system.X + 6 * CHAIN;
  for (size_t i = 0; i < CHAIN; i++) sum += y[i] = before[i] = 1 + sin((double)(i * i));
  assert_int_equal(fake_method_step(&m, 0.1, NULL), HK_OK);
  conduct(&k, 0, NULL, NULL, y, NULL, dy);
  for (size_t i = 0; i < CHAIN; i++) {
    off = fmax(off, fabs(y[i] - before[i] - 0.1 * dy[i]));
    sum -= y[i];
  }
  print_message("left %.1e, sum off by %.1e\n", off, fabs(sum));
  assert_true(off < 1e-5 && fabs(sum) < CHAIN * 1e-5);
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* ---- orders ---- */

static void prey(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                 double *dy) {
  (void)context, (void)t, (void)x, (void)v, (void)a;
  dy[0] = y[0] * (1 - y[1]);
  dy[1] = y[1] * (y[0] - 1);
}

/* x'' = -y x, y' = 2 x v, so that y - x^2 stays: Duffing's oscillator, x'' = -(c + x^2) x. */
static void stiffening(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                       double *dy) {
  (void)context, (void)t;
  a[0] = -y[0] * x[0];
  dy[0] = 2 * x[0] * v[0];
}

static const struct problem {
  const char *name;
  fake_problem problem;
} problems[] = {{"prey", {1, 2, HK_DEPENDS_ON_CHANNELS, prey, NULL}},
                {"stiffening", {1, 1, HK_DEPENDS_ON_X | HK_DEPENDS_ON_CHANNELS, stiffening, NULL}}};

static void solve(const char *name, const struct problem *p, size_t steps, double y[2]) {
  fake_system *f = fake_system_create(&p->problem);
  double *X = f->system.X;
  f->system.tol = 1e30; /* the given step is taken */
  X[6] = 1;
  if (p->problem.width > 1)
    X[7] = 0.5;
  else
    X[0] = 1;
  fake_method m = fake_method_open(name, f);
  fake_method_set(&m, "tolerance", 1e-13);
  fake_method_run(&m, 3, steps);
  y[0] = X[6];
  y[1] = p->problem.width > 1 ? X[7] : X[0];
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* Halving h divides the error by 2^order; at h = 3/240 and less the next term changes the exponent by less than 0.2.
 * The reference is rk4 at a tenth of the step. */
static void implicit_methods_keep_their_order_on_channels(void **state) {
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names);
  (void)state;
  for (size_t k = 0; k < count; k++)
    for (size_t p = 0; p < sizeof problems / sizeof *problems; p++) {
      fake_system *f = fake_system_create(&problems[p].problem);
      fake_method m = fake_method_open(names[k], f);
      bool fits = fake_method_implicit(&m) && strcmp(names[k], "baraff_witkin") != 0;
      int order = m.plugin->integrator->order;
      fake_method_close(&m);
      fake_system_destroy(f);
      if (!fits) continue;
      size_t steps = order > 2 ? 60 : 240;
      double exact[2], coarse[2], fine[2], error[2] = {0};
      solve("rk4", &problems[p], 9600, exact);
      solve(names[k], &problems[p], steps, coarse);
      solve(names[k], &problems[p], 2 * steps, fine);
      for (int c = 0; c < 2; c++) {
        error[0] = fmax(error[0], fabs(coarse[c] - exact[c]));
        error[1] = fmax(error[1], fabs(fine[c] - exact[c]));
      }
      double measured = log2(error[0] / error[1]);
      print_message("%-18s %-10s order %.2f, error %.1e\n", names[k], problems[p].name, measured, error[1]);
      if (!(fabs(measured - order) < 0.2))
        fail_msg("%s, %s: order %.3f, not %d", names[k], problems[p].name, measured, order);
    }
}

/* ---- all particles count ---- */

enum { MANY = 60 }; /* the systems of the test are dense */

/* The first oscillates along y; all others rest on a line. */
static void alone(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                  double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  a[1] = -x[1];
}

static double error_of_one_among(size_t n, const char *name, double tol) {
  fake_system *f = fake_system_create(&(fake_problem){n, 0, HK_DEPENDS_ON_X, alone, NULL});
  for (size_t i = 0; i < n; i++) f->system.X[3 * i] = (double)i / (double)n;
  f->system.X[1] = 1;
  f->system.tol = tol;
  fake_method m = fake_method_open(name, f);
  drive(f, &m, 20, 1);
  double error = hypot(f->system.X[1] - cos(20), f->system.X[3 * n + 1] + sin(20));
  fake_method_close(&m);
  fake_system_destroy(f);
  return error;
}

/* Its error does not grow with the number of those that rest, which an average over all would allow: sqrt(30) times. */
static void one_among_many_is_held_to_the_tolerance(void **state) {
  static const char *const names[] = {"dopri5", "esdirk4", "tr_bdf2"};
  (void)state;
  for (size_t k = 0; k < 3; k++) {
    double few = error_of_one_among(2, names[k], 1e-6), many = error_of_one_among(MANY, names[k], 1e-6);
    print_message("%s: %.1e among 2, %.1e among %d\n", names[k], few, many, (int)MANY);
    assert_true(many < 2 * few);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stiff_reactions_are_held_to_the_tolerance),
      cmocka_unit_test(a_fast_pair_is_solved),
      cmocka_unit_test(exchange_between_particles_is_solved),
      cmocka_unit_test(implicit_methods_keep_their_order_on_channels),
      cmocka_unit_test(one_among_many_is_held_to_the_tolerance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
