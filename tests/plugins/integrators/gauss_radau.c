/* Everhart's method: order 15 where its errors are above rounding, and rounding where the tolerance is; energy errors
 * of orbits that grow like the root of time; forces of the velocity and channels; steps as short as motion asks for. */
#include "tests/support/fake_system.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void kepler(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  double r2 = x[0] * x[0] + x[1] * x[1], r3 = r2 * sqrt(r2);
  a[0] = -x[0] / r3;
  a[1] = -x[1] / r3;
}

/* Steps of the method's choice to t_end, or of h, where that is shorter; returns how many. */
static size_t drive(fake_system *f, fake_method *m, double t_end, double longest) {
  size_t steps = 0;
  for (double h = longest; f->system.t < t_end; steps++) {
    hk_step out = {0, 0, NAN};
    double left = t_end - f->system.t, asked = fmin(fmin(h, longest), left);
    const hk_integrator *method = m->plugin->integrator;
    if (method->step(m->self, method->method, &f->system, t_end, asked, &out) != HK_OK) fail_msg("%s", f->message);
    assert_true(out.h > 0 && out.h <= left * (1 + 1e-12) && out.error <= 1 && out.h_next > 0);
    f->system.t = out.h >= left ? t_end : f->system.t + out.h;
    h = out.h_next;
  }
  return steps;
}

/* The error after ten turns on a circle with n equal steps each. */
static double error_of_turns(int n) {
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, kepler, NULL});
  double turn = 2 * acos(-1);
  f->system.X[0] = f->system.X[4] = 1;
  f->system.tol = 1e30; /* it takes the steps that it is given */
  fake_method m = fake_method_open("gauss_radau", f);
  fake_method_run(&m, 10 * turn, 10 * (size_t)n);
  double error = hypot(f->system.X[0] - 1, f->system.X[1]);
  fake_method_close(&m);
  fake_system_destroy(f);
  return error;
}

/* A third and a quarter of a turn are about the longest steps with which the sweeps converge; the errors are 6e-10 and
 * 8e-12, and those by rounding after ten turns some 1e-13, which changes the order by 0.05. */
static void order_is_fifteen(void **state) {
  (void)state;
  double coarse = error_of_turns(3), fine = error_of_turns(4), order = log(coarse / fine) / log(4 / 3.0);
  print_message("errors %.2e and %.2e: order %.2f\n", coarse, fine, order);
  assert_true(fine > 3e-12 && fabs(order - 15) < 0.3);
}

static double orbit_energy(const double *X) {
  return (X[3] * X[3] + X[4] * X[4]) / 2 - 1 / sqrt(X[0] * X[0] + X[1] * X[1]);
}

/* The largest error of the energy of an orbit of eccentricity e, at its ends, in `orbits` of them, and the steps. */
static double energy_error(double e, size_t orbits, size_t *steps) {
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, kepler, NULL});
  double turn = 2 * acos(-1), most = 0, *X = f->system.X;
  X[0] = 1 - e;
  X[4] = sqrt((1 + e) / (1 - e));
  f->system.tol = DBL_EPSILON;
  fake_method m = fake_method_open("gauss_radau", f);
  double first = orbit_energy(X);
  *steps = drive(f, &m, turn * (double)orbits, INFINITY);
  most = fabs(orbit_energy(X) - first) / fabs(first);
  fake_method_close(&m);
  fake_system_destroy(f);
  return most;
}

/* Brouwer's law: rounding errors of 1.1e-16 in a step, of the kinetic energy at the pericentre, (1 + e)/(1 - e) times
 * the total one, would add up like a random walk; compensated sums make less of it. Errors of one sign would be beyond
 * it by the root of the number of steps. */
static void energy_of_orbits_walks_at_random(void **state) {
  (void)state;
  const struct {
    double e;
    size_t orbits;
  } cases[] = {{0.1, 10000}, {0.3, 3000}, {0.6, 3000}, {0.9, 1000}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    size_t steps;
    double e = cases[k].e, error = energy_error(e, cases[k].orbits, &steps);
    double walk = DBL_EPSILON / 2 * sqrt((double)steps) * (1 + e) / (1 - e);
    print_message("e = %.1f: energy off by %.1e after %zu orbits, %zu steps; one rounding a step: %.1e\n", e, error,
                  cases[k].orbits, steps, walk);
    assert_true(error < 1.5 * walk);
  }
}

/* x'' = -w^2 x - 2 d x' + b z x', a damped oscillator whose plane turns, known in complex numbers; a channel that
 * decays, and the power of the drag. */
static void turning(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                    double *dy) {
  (void)context;
  a[0] = -4 * x[0] - 0.2 * v[0] + 3 * v[1];
  a[1] = -4 * x[1] - 0.2 * v[1] - 3 * v[0];
  dy[0] = -0.5 * y[0] + sin(t);
  dy[1] = -0.2 * (v[0] * v[0] + v[1] * v[1]);
}

/* q'' = -4 q - (0.2 + 3 i) q', from q = 1 at rest: q = (l2 e^(l1 t) - l1 e^(l2 t))/(l2 - l1), the two roots of
 * l^2 + (0.2 + 3 i) l + 4 = 0. The energy lost is what the work says. */
static void forces_of_the_velocity_channels_and_work_are_exact(void **state) {
  (void)state;
  const unsigned all = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_DEPENDS_ON_CHANNELS;
  fake_system *f = fake_system_create(&(fake_problem){1, 1, all, turning, NULL});
  double t = 10, *X = f->system.X;
  X[0] = X[6] = 1;
  f->system.tol = DBL_EPSILON;
  fake_method m = fake_method_open("gauss_radau", f);
  drive(f, &m, t, INFINITY);
  double _Complex g = 0.2 + 3 * I, root = csqrt(g * g / 4 - 4);
  double _Complex a = -g / 2 + root, b = -g / 2 - root, q = (b * cexp(a * t) - a * cexp(b * t)) / (b - a);
  double y = exp(-0.5 * t) * (1 + 0.8) + 0.4 * sin(t) - 0.8 * cos(t);
  double energy = (X[3] * X[3] + X[4] * X[4] + 4 * (X[0] * X[0] + X[1] * X[1])) / 2;
  print_message("off by %.1e, %.1e; channel %.1e; work %.1e\n", X[0] - creal(q), X[1] - cimag(q), X[6] - y,
                energy - 2 - X[7]);
  assert_true(fabs(X[0] - creal(q)) < 3e-15 && fabs(X[1] - cimag(q)) < 3e-15); /* some ten roundings */
  assert_true(fabs(X[6] - y) < 3e-15 && fabs(energy - 2 - X[7]) < 3e-15);
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* Stops cost steps, no accuracy; a first step that is asked for and far too long is not taken. */
static void stops_are_met_at_any_place(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, kepler, NULL});
  double *X = f->system.X, turn = 2 * acos(-1);
  X[0] = 0.4;
  X[4] = 2;
  f->system.tol = DBL_EPSILON;
  fake_method m = fake_method_open("gauss_radau", f);
  for (int k = 1; k <= 37; k++) drive(f, &m, turn * k / 37, INFINITY);
  assert_true(hypot(X[0] - 0.4, X[1]) < 3e-14); /* a turn grows an error of 1e-16 by 100 or so */
  fake_method_close(&m);
  fake_system_destroy(f);
}

static void pushed(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)x, (void)v, (void)y, (void)dy;
  a[0] = sin(t);
}

static void starts_from_nothing(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_T, pushed, NULL});
  f->system.tol = DBL_EPSILON;
  fake_method m = fake_method_open("gauss_radau", f);
  assert_true(drive(f, &m, 5, INFINITY) < 100);
  assert_true(fabs(f->system.X[0] - (5 - sin(5))) < 3e-15);
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* A force that jumps from 1 to -40 where x is 1. */
static void turned_back(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                        double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  a[0] = x[0] < 1 ? 1 : -40;
}

/* The place at 1.5 s, of a start at 0 with the speed v: up to the jump, beyond it, and after the return. */
static double turned_back_exactly(double v, double t) {
  for (double x = 0;;) {
    double hit = sqrt(v * v + 2 * (1 - x)) - v, speed = v + hit;
    if (t <= hit) return x + v * t + t * t / 2;
    t -= hit;
    if (t <= speed / 20) return 1 + speed * t - 20 * t * t;
    t -= speed / 20, x = 1, v = -speed;
    hit = 2 * speed; /* down and back up to the jump */
    if (t <= hit) return 1 + v * t + t * t / 2;
  }
}

/* Jumps fall anywhere in a step, also behind the last node, where none of the nodes sees them. */
static void jumps_between_the_last_node_and_the_end_are_seen(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, turned_back, NULL});
  double worst = 0;
  for (int k = 0; k < 200; k++) {
    double v = 0.8 + 0.002 * k;
    fake_method m = fake_method_open("gauss_radau", f);
    f->system.t = 0, f->system.tol = 1e-12;
    f->system.X[0] = 0, f->system.X[3] = v;
    drive(f, &m, 1.5, INFINITY);
    worst = fmax(worst, fabs(f->system.X[0] - turned_back_exactly(v, 1.5)));
    fake_method_close(&m);
  }
  print_message("the worst of 200 is %.2g m off\n", worst);
  assert_true(worst < 1e-8); /* a jump of 40 m/s2 in the last 1e-6 of a step of 0.01 s, three times */
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
  f->system.tol = 1e-9;
  fake_method m = fake_method_open("gauss_radau", f);
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
      cmocka_unit_test(order_is_fifteen),
      cmocka_unit_test(energy_of_orbits_walks_at_random),
      cmocka_unit_test(forces_of_the_velocity_channels_and_work_are_exact),
      cmocka_unit_test(stops_are_met_at_any_place),
      cmocka_unit_test(starts_from_nothing),
      cmocka_unit_test(jumps_between_the_last_node_and_the_end_are_seen),
      cmocka_unit_test(says_when_no_step_is_short_enough),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
