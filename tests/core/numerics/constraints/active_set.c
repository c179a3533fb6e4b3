/* One-sided constraints: what lies on the ground, cords that are slack and taut, contacts that depend on each other. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81;
static const char *const methods[] = {"leapfrog",          "rk4",     "dopri5",  "backward_euler", "bdf2",
                                      "implicit_midpoint", "tr_bdf2", "esdirk4", "cvode"};
enum { METHODS = sizeof methods / sizeof *methods };

static void open(test_engine *e, const char *integrator) {
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, integrator);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -g, 0);
}

static void time_grid(test_engine *e, double T, size_t frames, size_t steps) {
  e->scene->fps = (double)frames / T;
  e->scene->duration = T;
  e->options.dt = T / (double)(frames * steps);
  e->options.tol = 1e-7;
}

static hk_plugin_spec *ground(test_engine *e, const double *ids, size_t count) {
  hk_plugin_spec *spec = test_plugin(e, HK_CONSTRAINT, "fixture:ground");
  test_list(e, spec, "particles", ids, count);
  return spec;
}

static double distance(test_engine *e, uint32_t i, uint32_t j) {
  const double *a = test_position(e, i), *b = test_position(e, j);
  return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* It falls for sqrt(2 y/g) = 0.45 s, is caught within one step and lies there; what the impact takes is in the energy
 * balance. 1e-6: ten times the tolerance of the adaptive methods, which is far above rounding; backward Euler damps the
 * fall by about h g/v = 1e-3/0.45 of the energy. */
static void a_ball_comes_to_rest_on_the_ground(void **state) {
  (void)state;
  for (size_t m = 0; m < METHODS; m++) {
    test_engine e;
    hk_summary s;
    open(&e, methods[m]);
    test_particle(&e, 0, 1, 0, 0.3);
    e.scene->particles.velocity[0] = 0.25;
    ground(&e, (const double[]){1}, 1);
    time_grid(&e, 1, 20, 50);
    test_run(&e);
    for (int k = 1; k <= 20; k++) {
      test_advance(&e, k / 20.0);
      const double *x = test_position(&e, 1), *v = test_velocity(&e, 1);
      assert_true(x[1] > -1e-12); /* the tolerance of the projection */
      if (k >= 10) assert_true(fabs(x[1]) < 1e-12 && fabs(v[1]) < 1e-12);
      assert_true(fabs(v[0] - 0.25) < 1e-12 && fabs(x[0] - 0.25 * k / 20) < 1e-9);
    }
    hk_run_summary(e.run, &s);
    assert_true(s.constraint_violation < 1e-12);
    assert_true(fabs(s.energy_drift) < (strcmp(methods[m], "backward_euler") == 0 ? 3e-3 : 1e-6));
    test_engine_close(&e);
  }
}

/* On a slope of 30 degrees without friction: g sin(30) along it, from the first step, and never off it. Methods of
 * order 2 or more are exact for a constant acceleration (CVODE to its tolerance); backward Euler is a h T/2 ahead, 200
 * steps of 4e-3 s: 5e-3 of the way. */
static void a_ball_slides_down_a_slope(void **state) {
  (void)state;
  for (size_t m = 0; m < METHODS; m++) {
    test_engine e;
    double slope = acos(-1) / 6, t = 0.8, along = g * sin(slope) * t * t / 2;
    open(&e, methods[m]);
    test_particle(&e, 0, 0, 0, 2);
    test_vector(&e, ground(&e, (const double[]){1}, 1), "normal", sin(slope), cos(slope), 0);
    time_grid(&e, t, 8, 25);
    test_run(&e);
    test_advance(&e, t);
    const double *x = test_position(&e, 1);
    double error = strcmp(methods[m], "backward_euler") == 0 ? 5.1e-3 * along : 1e-6;
    assert_true(fabs(sin(slope) * x[0] + cos(slope) * x[1]) < 1e-12);
    assert_true(fabs(cos(slope) * x[0] - sin(slope) * x[1] - along) < error);
    test_engine_close(&e);
  }
}

/* A tetrahedron of bars on three feet, each stated three times: nine contacts, six of which depend on the others. It is
 * set down and stays; once a spring from above pulls at five times its weight it leaves without delay. */
static void feet_that_are_stated_three_times_carry_and_let_go(void **state) {
  (void)state;
  static const double at[5][3] = {{0, 0.1, 0}, {1, 0.1, 0}, {0.4, 0.1, 0.9}, {0.45, 0.9, 0.3}, {0.45, 2.9, 0.3}};
  for (size_t m = 0; m < METHODS; m++) {
    test_engine e;
    uint32_t edge[6][2];
    size_t count = 0;
    open(&e, methods[m]);
    for (uint32_t i = 0; i < 5; i++) {
      test_particle(&e, at[i][0], at[i][1], at[i][2], 0.5);
      for (uint32_t j = 0; j < i && i < 4; j++, count++) edge[count][0] = j + 1, edge[count][1] = i + 1;
    }
    test_pin(&e, HK_PIN_FIXED, 5, NULL);
    test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t(*)[2])edge, 6);
    test_number(&e, ground(&e, (const double[]){1, 2, 3}, 3), "copies", 3);
    hk_plugin_spec *spring = test_plugin(&e, HK_FORCE, "springs");
    test_edges(&e, spring, (const uint32_t[][2]){{4, 5}}, 1);
    test_number(&e, spring, "k", 100);
    test_number(&e, spring, "rest", 1);
    spring->from = 0.7;
    time_grid(&e, 0.8, 8, 50);
    test_run(&e);
    test_advance(&e, 0.5);
    for (uint32_t id = 1; id <= 3; id++)
      assert_true(fabs(test_position(&e, id)[1]) < 1e-11 && fabs(test_velocity(&e, id)[1]) < 1e-11);
    double x = test_position(&e, 4)[0];
    test_advance(&e, 0.7);
    assert_true(fabs(test_position(&e, 4)[0] - x) < 1e-9); /* nothing pushes it sideways */
    for (uint32_t id = 1; id <= 3; id++) assert_true(fabs(test_position(&e, id)[1]) < 1e-11);
    test_advance(&e, 0.8);
    for (uint32_t id = 1; id <= 3; id++) assert_true(test_position(&e, id)[1] > 0.05);
    test_engine_close(&e);
  }
}

/* A ball on a cord of 1 m at rest at the bottom is struck with v^2 = 3.5 g L: it rises taut past the horizontal and the
 * cord goes slack where the pull vanishes, at a height sin(p) = (v^2 - 2 g L)/(3 g L) = 1/2 above the pivot; from there
 * it flies along a parabola. The moment is met within some steps of 1e-4 s, at 2 to 3 m/s. */
static void a_cord_goes_slack_where_its_pull_vanishes(void **state) {
  (void)state;
  static const char *const two[] = {"rk4", "bdf2"};
  for (size_t m = 0; m < 2; m++) {
    test_engine e;
    double h = 1e-4, t = 0, slack = 0, from[3], speed[3];
    open(&e, two[m]);
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, 0, -1, 0, 0.4);
    e.scene->particles.velocity[3] = sqrt(3.5 * g);
    test_pin(&e, HK_PIN_FIXED, 1, NULL);
    test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "fixture:cord"), (const uint32_t[][2]){{1, 2}}, 1);
    time_grid(&e, 2, 20000, 1);
    test_run(&e);
    for (int k = 1; k < 12000 && slack == 0; k++) {
      memcpy(from, test_position(&e, 2), sizeof from);
      memcpy(speed, test_velocity(&e, 2), sizeof speed);
      t = k / 10000.0;
      test_advance(&e, t);
      assert_true(distance(&e, 1, 2) < 1 + 1e-11);
      if (distance(&e, 1, 2) < 1 - 1e-11) slack = t - h;
    }
    assert_true(slack > 0);
    assert_true(fabs(from[1] - 0.5) < 20 * h); /* some v h */
    double height = from[1], energy = (speed[0] * speed[0] + speed[1] * speed[1]) / 2 + g * from[1];
    assert_true(fabs(energy - (1.75 * g - g)) < 1e-3 && height > 0);
    double fly = 0.1;
    test_advance(&e, t + fly - h);
    assert_true(fabs(test_position(&e, 2)[0] - from[0] - speed[0] * fly) < 1e-6);
    assert_true(fabs(test_position(&e, 2)[1] - from[1] - speed[1] * fly + g * fly * fly / 2) < 1e-6);
    test_engine_close(&e);
  }
}

/* A ball thrown level from the pivot's height, 0.6 m away, falls freely until the cord is taut, loses what it moves
 * along the cord, and swings on. Where: x = 0.6 + u t, y = -g t^2/2, x^2 + y^2 = 1. */
static void a_slack_cord_catches_a_ball(void **state) {
  (void)state;
  for (size_t m = 0; m < METHODS; m++) {
    test_engine e;
    hk_summary s;
    open(&e, methods[m]);
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, 0.6, 0, 0, 0.4);
    e.scene->particles.velocity[3] = 0.3;
    test_pin(&e, HK_PIN_FIXED, 1, NULL);
    test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "fixture:cord"), (const uint32_t[][2]){{1, 2}}, 1);
    time_grid(&e, 0.6, 60, 20);
    test_run(&e);
    double t = 0;
    while (pow(0.6 + 0.3 * t, 2) + pow(g * t * t / 2, 2) < 1) t += 1e-6;
    double x = 0.6 + 0.3 * t, y = -g * t * t / 2, side = 0.3 * y + g * t * x; /* across the cord */
    for (int k = 1; k <= 60; k++) {
      test_advance(&e, k / 100.0);
      assert_true(distance(&e, 1, 2) < 1 + 1e-11);
    }
    /* Energy after the catch: the part across the cord is kept. The catch is late by up to a step of 5e-4 s. */
    const double *at = test_position(&e, 2), *v = test_velocity(&e, 2);
    double energy = (v[0] * v[0] + v[1] * v[1]) / 2 + g * at[1];
    double loss = strcmp(methods[m], "backward_euler") == 0 ? 0.15 : 0.05; /* which damps */
    assert_true(fabs(energy - side * side / 2 - g * y) < loss);
    hk_run_summary(e.run, &s);
    assert_true(s.constraint_violation < 1e-11);
    assert_true(fabs(distance(&e, 1, 2) - 1) < 1e-11); /* and it is still taut */
    test_engine_close(&e);
  }
}

/* A chain of two cords and a bar that is given twice, above the ground, with a foot that lands and slides. */
static void busy_scene(test_engine *e, const char *method) {
  open(e, method);
  test_particle(e, 0, 1, 0, 1);
  test_particle(e, 0.5, 1.2, 0, 0.4);
  test_particle(e, 1.1, 1.3, 0.2, 0.6);
  test_particle(e, 1.5, 1, 0.1, 0.3);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *cord = test_plugin(e, HK_CONSTRAINT, "fixture:cord");
  test_edges(e, cord, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  test_number(e, cord, "length", 0.65);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t[][2]){{3, 4}, {4, 3}}, 2);
  ground(e, (const double[]){2, 3, 4}, 3);
  time_grid(e, 2, 20, 20);
}

/* Which contacts may push is found again from the state that a step begins with. */
static void a_checkpoint_with_contacts_goes_on_bit_by_bit(void **state) {
  (void)state;
  static const char *const explicit[] = {"leapfrog", "stoermer", "rk4", "symplectic_euler"};
  for (size_t m = 0; m < 4; m++) {
    test_engine whole, first, second;
    char path[512];
    snprintf(path, sizeof path, "%s/state.bin", test_folder());
    busy_scene(&whole, explicit[m]);
    test_run(&whole);
    test_advance(&whole, 2);
    busy_scene(&first, explicit[m]);
    test_run(&first);
    test_advance(&first, 1.1);
    assert_int_equal(hk_run_save(first.run, path, &first.error), HK_OK);
    busy_scene(&second, explicit[m]);
    second.scene->start_file = strdup(path);
    test_run(&second);
    test_advance(&second, 2);
    const hk_view *a = hk_run_view(whole.run), *b = hk_run_view(second.run);
    assert_memory_equal(a->x, b->x, 3 * a->n * sizeof *a->x);
    assert_memory_equal(a->v, b->v, 3 * a->n * sizeof *a->v);
    for (size_t i = 1; i < 4; i++) assert_true(a->x[3 * i + 1] > -1e-11);
    test_engine_close(&whole);
    test_engine_close(&first);
    test_engine_close(&second);
  }
}

static void methods_that_split_the_forces_refuse_one_sided_constraints(void **state) {
  (void)state;
  test_engine e;
  open(&e, "imex");
  test_particle(&e, 0, 1, 0, 0.3);
  ground(&e, (const double[]){1}, 1);
  time_grid(&e, 1, 20, 50);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "imex takes no one-sided constraints ('ground')"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_ball_comes_to_rest_on_the_ground),
      cmocka_unit_test(a_ball_slides_down_a_slope),
      cmocka_unit_test(feet_that_are_stated_three_times_carry_and_let_go),
      cmocka_unit_test(a_cord_goes_slack_where_its_pull_vanishes),
      cmocka_unit_test(a_slack_cord_catches_a_ball),
      cmocka_unit_test(a_checkpoint_with_contacts_goes_on_bit_by_bit),
      cmocka_unit_test(methods_that_split_the_forces_refuse_one_sided_constraints),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
