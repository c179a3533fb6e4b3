/* The force repulsion in runs: head-on impacts of every kind of pair keep energy and momentum, methods keep their order
 * through an impact, damping gives the restitution that its help says, friction holds and slides as Coulomb's, and
 * nothing passes that it cannot stop. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, radius = 0.01, reach = 0.01;

static void open_world(test_engine *e, const char *method, double h) {
  test_engine_open(e);
  e->options.integrator = method;
  e->options.dt = h;
  e->scene->duration = 1000;
  e->scene->fps = 20;
}

static uint32_t put(test_engine *e, const double x[3], const double v[3], double mass) {
  uint32_t id = test_particle(e, x[0], x[1], x[2], mass);
  if (v) memcpy(e->scene->particles.velocity + 3 * (size_t)(id - 1), v, 3 * sizeof *v);
  return id;
}

static hk_plugin_spec *add_contact(test_engine *e, double stiffness) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "repulsion");
  test_number(e, spec, "radius", radius);
  test_number(e, spec, "thickness", 2 * radius);
  test_number(e, spec, "reach", reach);
  test_number(e, spec, "stiffness", stiffness);
  return spec;
}

static void add_triangle(test_engine *e, const uint32_t id[3]) {
  const uint32_t triangle[1][3] = {{id[0], id[1], id[2]}};
  assert_int_equal(hk_scene_add_triangles(e->scene, 1, triangle, &e->error), HK_OK);
}

static void add_floor(test_engine *e, double slope) {
  uint32_t id[3] = {put(e, (double[]){-50, -50, -50 * slope}, NULL, 1),
                    put(e, (double[]){50, -50, 50 * slope}, NULL, 1), put(e, (double[]){0, 80, 0}, NULL, 1)};
  for (int k = 0; k < 3; k++) test_pin(e, HK_PIN_FIXED, id[k], NULL);
  add_triangle(e, id);
}

static hk_summary summary_of(test_engine *e) {
  hk_summary s;
  hk_run_summary(e->run, &s);
  return s;
}

/* ---- order ---- */

/* The speed of the first of two particles that have bounced off each other, and the gap then. */
static void bounce(const char *method, double h, double damping, double *speed, double *gap) {
  test_engine t;
  open_world(&t, method, h);
  uint32_t a = put(&t, (double[]){-0.02, 0, 0}, (double[]){0.3, 0, 0}, 1),
           b = put(&t, (double[]){0.02, 0, 0}, (double[]){-0.3, 0, 0}, 1);
  test_number(&t, add_contact(&t, 3000), "damping", damping);
  test_run(&t);
  test_advance(&t, 0.2);
  *speed = test_velocity(&t, b)[0];
  *gap = test_position(&t, b)[0] - test_position(&t, a)[0];
  assert_true(fabs(test_velocity(&t, a)[0] + *speed) < 1e-12);
  test_engine_close(&t);
}

/* A force with three continuous derivatives in its energy: the errors of a method of order 4 fall by 2^4, and end at
 * rounding. */
static void methods_keep_their_order(void **state) {
  (void)state;
  const struct {
    const char *name;
    double order;
  } methods[] = {{"leapfrog", 1.8}, {"rk4", 2.9}};
  double exact, gap, speed, other;
  bounce("rk4", 1.0 / 51200, 0, &exact, &gap);
  for (int k = 0; k < 2; k++) {
    bounce(methods[k].name, 1.0 / 1600, 0, &speed, &other);
    double coarse = fabs(other - gap);
    bounce(methods[k].name, 1.0 / 6400, 0, &speed, &other);
    double order = log2(coarse / fabs(other - gap)) / 2;
    print_message("%s: gap off by %.1e, %.1e: order %.2f\n", methods[k].name, coarse, fabs(other - gap), order);
    assert_true(order > methods[k].order);
    assert_true(fabs(speed - 0.3) < 1e-4); /* all of it comes back */
  }
}

/* e = 1 - 2/3 b v for slow impacts at v = 0.6 m/s; the next term is of the square of b v. */
static void damping_gives_the_restitution(void **state) {
  (void)state;
  for (double b = 0.05; b < 0.5; b *= 3) {
    double speed, gap, expected = 1 - 2.0 / 3 * b * 0.6;
    bounce("rk4", 1.0 / 6400, b, &speed, &gap);
    print_message("b = %.2f: e %.4f, expected %.4f\n", b, speed / 0.3, expected);
    assert_true(fabs(speed / 0.3 - expected) < b * b * 0.36);
  }
}

/* ---- friction ---- */

/* What a particle slid down a slope of tan = 1/2 in 1 s. It starts where the force of contact is its weight's. */
static double slid(double friction) {
  test_engine t;
  open_world(&t, "leapfrog", 2e-4);
  double n[2] = {-0.5 / sqrt(1.25), 1 / sqrt(1.25)}, k = 1e4, mass = 0.1;
  double gap = radius + reach - cbrt(3 * reach * reach * mass * g * n[1] / k);
  uint32_t id = put(&t, (double[]){gap * n[0], 0, gap * n[1]}, NULL, mass);
  add_floor(&t, 0.5);
  test_vector(&t, test_plugin(&t, HK_FORCE, "gravity"), "g", 0, 0, -g);
  hk_plugin_spec *contact = add_contact(&t, k);
  test_number(&t, contact, "friction", friction);
  test_run(&t);
  test_advance(&t, 1);
  const double *x = test_position(&t, id);
  double along = hypot(x[0] - gap * n[0], x[2] - gap * n[1]);
  test_engine_close(&t);
  return along;
}

/* The way in 1 s by du/dt = g (sin - mu cos u/sqrt(u^2 + s^2)), in steps of 10 us. */
static double sliding(double friction, double slip) {
  double u = 0, way = 0, h = 1e-5;
  for (int k = 0; k < 100000; k++) {
    u += h * g * (0.5 - friction * u / hypot(u, slip)) / sqrt(1.25);
    way += h * u;
  }
  return way;
}

/* Friction that is smooth below s = 1 mm/s: where Coulomb's starts to slide it is late by 0.05 m/s, and where Coulomb's
 * would hold it creeps, at mu = 0.51 at u = 4.97 s. */
static void friction_on_a_slope_brackets_its_tangent(void **state) {
  (void)state;
  double way = slid(0.49), stuck = slid(0.51);
  print_message("mu 0.49 slid %.5f m (%.5f), mu 0.51 crept %.5f m\n", way, sliding(0.49, 1e-3), stuck);
  assert_true(fabs(way - sliding(0.49, 1e-3)) < 0.001 * way);
  assert_true(fabs(stuck - sliding(0.51, 1e-3)) < 0.001 * stuck);
}

/* ---- what it cannot stop ---- */

/* 10 m/s against a repulsion that holds 0.02 J: the run ends before anything passes, and says so; with the corrector
 * beside it, it goes on. */
static void what_is_too_fast_does_not_pass(void **state) {
  (void)state;
  for (int both = 0; both < 2; both++) {
    test_engine t;
    open_world(&t, "leapfrog", 1e-3);
    uint32_t ball = put(&t, (double[]){0.3, 0.2, 0.2}, (double[]){0, 0, -10}, 1);
    add_floor(&t, 0);
    hk_plugin_spec *contact = add_contact(&t, 1000);
    if (both) {
      test_boolean(&t, contact, "guard", false);
      hk_plugin_spec *corrector = test_plugin(&t, HK_CORRECTOR, "contact");
      test_number(&t, corrector, "radius", radius);
      test_number(&t, corrector, "thickness", 2 * radius);
    }
    test_run(&t);
    hk_status status = hk_run_advance(t.run, 1, &t.error);
    assert_true(both ? status == HK_OK : status != HK_OK);
    if (!both) print_message("%s\n", t.error.text);
    if (both) assert_true(test_position(&t, ball)[2] > 0 && summary_of(&t).intersections == 0);
    test_engine_close(&t);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(methods_keep_their_order),
      cmocka_unit_test(damping_gives_the_restitution),
      cmocka_unit_test(friction_on_a_slope_brackets_its_tangent),
      cmocka_unit_test(what_is_too_fast_does_not_pass),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
