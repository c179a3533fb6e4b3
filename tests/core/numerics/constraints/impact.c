/* Impacts of one-sided constraints are found inside steps: a method keeps its order across them, a constraint that is
 * met and left again within one step is seen, and the energy that an impact takes is work. */
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, end = 0.7;

/* A particle at (x, y) with (u, v), tied to a pin at the origin by a cable of 1 m. */
static void tie(test_engine *e, const char *method, double dt, const double at[4]) {
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, method);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -g, 0);
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, at[0], at[1], 0, 2);
  e->scene->particles.velocity[3] = at[2];
  e->scene->particles.velocity[4] = at[3];
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *spec = test_plugin(e, HK_CONSTRAINT, "cables");
  test_edges(e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(e, spec, "length", 1);
  e->scene->duration = 1;
  e->scene->fps = 10;
  e->options.dt = dt;
}

/* Let go at (0.6, 0) it is taut at (0.6, -0.8) after sqrt(1.6/g) s and keeps 0.6 of its speed, along the circle. The
 * swing is integrated here in the angle from the vertical, by 20,000 steps of Runge and Kutta, right to 1e-14. */
static void swing(double t, double at[2]) {
  enum { STEPS = 20000 };
  double fall = sqrt(1.6 / g), angle = asin(0.6), rate = -0.6 * g * fall, h = (t - fall) / STEPS;
  for (int k = 0; k < STEPS; k++) {
    double a1 = -g * sin(angle), r2 = rate + h / 2 * a1, a2 = -g * sin(angle + h / 2 * rate);
    double r3 = rate + h / 2 * a2, a3 = -g * sin(angle + h / 2 * r2), r4 = rate + h * a3;
    double a4 = -g * sin(angle + h * r3);
    angle += h / 6 * (rate + 2 * r2 + 2 * r3 + r4);
    rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  at[0] = sin(angle);
  at[1] = -cos(angle);
}

static double error_of(const char *method, double dt) {
  test_engine e;
  double at[2];
  tie(&e, method, dt, (double[]){0.6, 0, 0, 0});
  test_run(&e);
  test_advance(&e, end);
  swing(end, at);
  const double *x = test_position(&e, 2);
  double error = hypot(x[0] - at[0], x[1] - at[1]);
  test_engine_close(&e);
  return error;
}

/* Without it all of them have order 1: an impact late by half a step moves the particle by some h |v|/2. The observed
 * order is asked for up to 0.3, the size of the next term of the error at these steps. */
static void methods_keep_their_order_across_an_impact(void **state) {
  (void)state;
  static const struct method {
    const char *name;
    int order;
    double dt;
  } methods[] = {{"leapfrog", 2, 1 / 320.0}, {"midpoint", 2, 1 / 320.0},   {"bdf2", 2, 1 / 320.0},
                 {"rk4", 4, 1 / 40.0},       {"kahan_li8", 2, 1 / 80.0},   {"esdirk4", 4, 1 / 40.0},
                 {"tr_bdf2", 2, 1 / 320.0},  {"blanes_moan", 2, 1 / 80.0}, {"implicit_midpoint", 2, 1 / 320.0}};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    const struct method *m = &methods[k];
    double coarse = error_of(m->name, m->dt), fine = error_of(m->name, m->dt / 2), order = log2(coarse / fine);
    if (!(order > m->order - 0.3) && fine > 1e-11)
      fail_msg("%s: order %.2f, errors %g and %g m", m->name, order, coarse, fine);
  }
}

/* A parabola from (0.9, 0.1) thrown out and up leaves the circle and would be inside again at the end of the step of
 * 0.1 s: leapfrog's steps are the parabola, whose velocity along the cable ends where it meets the circle. */
static void what_is_met_and_left_within_a_step_is_seen(void **state) {
  (void)state;
  test_engine e;
  tie(&e, "leapfrog", 0.1, (double[]){0.9, 0.1, 0.45, 0.35});
  test_run(&e);
  test_advance(&e, 0.1);
  const double *x = test_position(&e, 2);
  double free[2] = {0.9 + 0.045, 0.1 + 0.035 - g * 0.005},
         middle[2] = {0.9 + 0.45 * 0.05, 0.1 + 0.35 * 0.05 - g * 0.00125};
  assert_true(hypot(free[0], free[1]) < 1 && hypot(middle[0], middle[1]) < 1);
  assert_true(hypot(x[0] - free[0], x[1] - free[1]) < 1e-14); /* this one does not reach it */
  test_engine_close(&e);
  tie(&e, "leapfrog", 0.1, (double[]){0.97, 0.1, 1, 0.5});
  test_run(&e);
  test_advance(&e, 0.1);
  x = test_position(&e, 2);
  assert_true(hypot(x[0], x[1]) < 1 + 1e-12);
  double reach = hypot(0.97 + 0.1, 0.1 + 0.05 - g * 0.005);
  assert_true(reach > 1); /* this one ends beyond it */
  test_engine_close(&e);
  /* Up and down again: at its top, after 0.05 s, it is beyond the circle, at the end where it was. */
  tie(&e, "leapfrog", 0.1, (double[]){0, 0.99, 0, g * 0.05});
  test_run(&e);
  test_advance(&e, 0.1);
  x = test_position(&e, 2);
  /* It stops at y = 1 0.05 s - sqrt(0.0025 s2 - 2 0.01 m/g) later and falls from there. */
  double met = 0.05 - sqrt(0.0025 - 0.02 / g), y = 1 - g * (0.1 - met) * (0.1 - met) / 2;
  assert_true(fabs(x[1] - y) < 1e-10);
  test_engine_close(&e);
}

/* Runge's and Kutta's method is exact for the parabola, so that the work is what the impact took to rounding: a half of
 * 2 kg times the square of 0.8 of the speed. */
static void the_energy_of_an_impact_is_work(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  double fall = sqrt(1.6 / g);
  tie(&e, "rk4", 1e-3, (double[]){0.6, 0, 0, 0});
  test_run(&e);
  test_advance(&e, fall + 2e-3);
  hk_run_summary(e.run, &s);
  assert_true(fabs(s.energy_work + 0.64 * g * g * fall * fall) < 1e-10);
  assert_true(fabs(s.energy_last - s.energy_first - s.energy_work) < 1e-10);
  assert_true(s.rejected_steps >= 1 && s.late_impacts == 0);
  test_engine_close(&e);
}

/* They keep their order with the impact at the end of the step, without steps that are taken back. */
static void methods_of_order_1_meet_it_at_the_end_of_a_step(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  tie(&e, "symplectic_euler", 1e-3, (double[]){0.6, 0, 0, 0});
  test_run(&e);
  test_advance(&e, 0.5);
  hk_run_summary(e.run, &s);
  assert_true(s.rejected_steps == 0 && s.steps >= 500);
  test_engine_close(&e);
}

/* A method of order 2 is as good with the root of the cubic as with one to rounding, and takes one step back; the cable
 * is at its length at once. One of order 4 looks again. */
static void a_method_of_order_2_takes_one_step_back(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    test_engine e;
    hk_summary s;
    tie(&e, k ? "rk4" : "leapfrog", 1.0 / 100, (double[]){0.6, 0, 0, 0});
    test_run(&e);
    test_advance(&e, 0.5);
    hk_run_summary(e.run, &s);
    const double *x = test_position(&e, 2);
    assert_true(k ? s.rejected_steps > 1 : s.rejected_steps == 1);
    assert_true(s.late_impacts == 0 && fabs(hypot(x[0], x[1]) - 1) < 1e-12);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(methods_keep_their_order_across_an_impact),
      cmocka_unit_test(what_is_met_and_left_within_a_step_is_seen),
      cmocka_unit_test(the_energy_of_an_impact_is_work),
      cmocka_unit_test(methods_of_order_1_meet_it_at_the_end_of_a_step),
      cmocka_unit_test(a_method_of_order_2_takes_one_step_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
