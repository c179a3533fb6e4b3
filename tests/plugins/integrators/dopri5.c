/* Dormand and Prince's method chooses its steps: their error follows the tolerance, they land where they must, and what
 * cannot be met is said. */
#include "tests/support/fake_system.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

typedef struct orbit {
  double unit, origin; /* s, m */
} orbit;

/* Kepler about a centre that lies anywhere, in any unit of time. */
static void kepler(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  const orbit *o = context;
  (void)t, (void)v, (void)y, (void)dy;
  double p = x[0] - o->origin, q = x[1] - o->origin, r2 = p * p + q * q, scale = r2 * sqrt(r2) * o->unit * o->unit;
  a[0] = -p / scale;
  a[1] = -q / scale;
}

/* Runs to t_end and beyond each stop of `stops` equal ones; returns the steps taken. */
static size_t drive(fake_system *f, fake_method *m, double t_end, size_t stops) {
  size_t steps = 0;
  double h = INFINITY;
  for (size_t k = 1; k <= stops; k++) {
    double stop = t_end * (double)k / (double)stops;
    while (f->system.t < stop) {
      hk_step out = {0, 0, NAN};
      double asked = fmin(h, stop - f->system.t);
      hk_status status =
          m->plugin->integrator->step(m->self, m->plugin->integrator->method, &f->system, stop, asked, &out);
      if (status != HK_OK) fail_msg("%s", f->message);
      assert_true(out.h > 0 && out.h <= asked * (1 + 1e-10) && out.error <= 1 && out.h_next > 0);
      if (out.h < stop - f->system.t) assert_true(f->system.t + out.h < stop);
      f->system.t = out.h >= stop - f->system.t ? stop : f->system.t + out.h;
      h = out.h_next;
      steps++;
    }
    assert_true(f->system.t == stop);
  }
  return steps;
}

static double orbit_error(double tol, orbit o, size_t stops, size_t *steps) {
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, kepler, &o});
  double *X = f->system.X;
  X[0] = 0.4 + o.origin;
  X[1] = o.origin;
  X[4] = 2 / o.unit;
  f->system.tol = tol;
  fake_method m = fake_method_open("dopri5", f);
  *steps = drive(f, &m, 10 * o.unit, stops);
  /* references.md 10.6: t = 10 */
  double error = hypot(X[0] - o.origin + 1.5350235919098137, X[1] - o.origin + 0.28366840649978086);
  fake_method_close(&m);
  fake_system_destroy(f);
  return error;
}

/* Error per step is held, so the error at the end goes like tol, up to the number of steps (tol^-1/5) and the orbit's
 * own growth of errors, about 100 in two revolutions. */
static void error_follows_the_tolerance(void **state) {
  double before = INFINITY;
  (void)state;
  for (double tol = 1e-3; tol > 0.5e-10; tol /= 10) {
    size_t steps;
    double error = orbit_error(tol, (orbit){1, 0}, 1, &steps);
    print_message("tol %.0e: error %.1e in %zu steps\n", tol, error, steps);
    assert_true(error < before);
    assert_true(error > 0.1 * tol && error < 2000 * tol);
    before = error;
  }
}

static void steps_do_not_depend_on_origin_or_unit_of_time(void **state) {
  size_t here, there, slow;
  (void)state;
  orbit_error(1e-6, (orbit){1, 0}, 1, &here);
  orbit_error(1e-6, (orbit){1, 100}, 1, &there);
  orbit_error(1e-6, (orbit){1024, 0}, 1, &slow); /* a power of two: the same roundings */
  assert_int_equal(here, there);
  assert_int_equal(here, slow);
}

/* A stop costs at most two steps, and the next proposal is not forgotten by it. */
static void many_stops_are_met_exactly_and_cost_little(void **state) {
  size_t free_steps, steps;
  (void)state;
  double error = orbit_error(1e-6, (orbit){1, 0}, 1, &free_steps);
  double stopped = orbit_error(1e-6, (orbit){1, 0}, 37, &steps);
  assert_true(steps <= free_steps + 2 * 37);
  assert_true(stopped < 2 * error);
}

static void still(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                  double *dy) {
  (void)context, (void)t, (void)x, (void)v, (void)y, (void)a, (void)dy;
}

static void pushed(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)x, (void)v, (void)y;
  a[0] = sin(t);
  dy[0] = cos(1e6 * t); /* the work */
}

/* From rest, without a size, a speed or a force at the start. x = t - sin t; the work, far too fast to follow, must not
 * shorten the steps. */
static void starts_from_nothing(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_T, pushed, NULL});
  f->system.tol = 1e-8;
  fake_method m = fake_method_open("dopri5", f);
  size_t steps = drive(f, &m, 5, 1);
  assert_true(steps < 200);
  assert_true(fabs(f->system.X[0] - (5 - sin(5))) < 1e-6);
  fake_method_close(&m);
  fake_system_destroy(f);
  f = fake_system_create(&(fake_problem){1, 0, 0, still, NULL});
  m = fake_method_open("dopri5", f);
  assert_true(drive(f, &m, 5, 1) < 20);
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* y' = -50 (y - cos t): the channel alone decides. */
static void decaying(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                     double *dy) {
  (void)context, (void)x, (void)v, (void)a;
  dy[0] = -50 * (y[0] - cos(t)) - sin(t);
}

static void channels_are_held_to_the_tolerance(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 1, HK_DEPENDS_ON_CHANNELS, decaying, NULL});
  f->system.X[6] = 2;
  f->system.tol = 1e-7;
  fake_method m = fake_method_open("dopri5", f);
  drive(f, &m, 1, 1);
  assert_true(fabs(f->system.X[6] - (cos(1) + exp(-50))) < 10 * 1e-7);
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* A wall that no step length can cross: infinite beyond, and 1/d^2 before it. */
static void singular(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                     double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  a[0] = x[0] < 1 ? 1 / ((1 - x[0]) * (1 - x[0])) : NAN;
}

static void says_when_no_step_is_short_enough(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, singular, NULL});
  fake_method m = fake_method_open("dopri5", f);
  double before[7], h = 1;
  hk_status status = HK_OK;
  for (int i = 0; i < 10000 && status == HK_OK; i++) {
    hk_step out = {0, 0, NAN};
    memcpy(before, f->system.X, sizeof before);
    status = m.plugin->integrator->step(m.self, m.plugin->integrator->method, &f->system, 10, h, &out);
    if (status == HK_OK) f->system.t += out.h;
    h = out.h_next;
  }
  assert_int_equal(status, HK_NOT_CONVERGED);
  assert_memory_equal(before, f->system.X, sizeof before);
  assert_non_null(strstr(f->message, "tol"));
  fake_method_close(&m);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(error_follows_the_tolerance),
      cmocka_unit_test(steps_do_not_depend_on_origin_or_unit_of_time),
      cmocka_unit_test(many_stops_are_met_exactly_and_cost_little),
      cmocka_unit_test(starts_from_nothing),
      cmocka_unit_test(channels_are_held_to_the_tolerance),
      cmocka_unit_test(says_when_no_step_is_short_enough),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
