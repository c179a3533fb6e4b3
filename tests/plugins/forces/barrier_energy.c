/* bdf2 with the barrier: its history makes no energy at impacts that its steps do not resolve, nor out of a start
 * within the barrier's reach; and where nothing touches it has the order 2 with a barrier in the scene as well. A start
 * whose gap is lost in rounding is refused. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, radius = 0.01, reach = 1e-3;

static void open_world(test_engine *e, const char *method, double h) {
  test_engine_open(e);
  e->options.integrator = method;
  e->options.dt = h;
  e->scene->duration = 1000;
  e->scene->fps = 1 / h;
}

static hk_plugin_spec *add_barrier(test_engine *e) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "barrier");
  test_number(e, spec, "radius", radius);
  test_number(e, spec, "d_hat", reach);
  return spec;
}

static void add_floor(test_engine *e) {
  const uint32_t ids[1][3] = {
      {test_particle(e, -50, -50, 0, 1), test_particle(e, 50, -50, 0, 1), test_particle(e, 0, 80, 0, 1)}};
  for (int c = 0; c < 3; c++) test_pin(e, HK_PIN_FIXED, ids[0][c], NULL);
  assert_int_equal(hk_scene_add_triangles(e->scene, 1, ids, &e->error), HK_OK);
}

static double energy_of(test_engine *e) {
  double kinetic, potential, work;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return kinetic + potential - work;
}

/* The largest energy after any step until t = 1 s, of a ball of 1 kg at a gap above the floor that falls at a speed,
 * and the energy at the start, without what the height at the floor has. */
static double largest_energy(double gap, double speed, double h, double *first) {
  test_engine t;
  double most = 0;
  open_world(&t, "bdf2", h);
  add_floor(&t);
  uint32_t id = test_particle(&t, 0, 0, radius + gap, 1);
  t.scene->particles.velocity[3 * (size_t)(id - 1) + 2] = -speed;
  test_vector(&t, test_plugin(&t, HK_FORCE, "gravity"), "g", 0, 0, -g);
  add_barrier(&t);
  test_run(&t);
  *first = energy_of(&t);
  for (int k = 1; k * h <= 1; k++) {
    test_advance(&t, k * h);
    most = fmax(most, energy_of(&t));
  }
  test_engine_close(&t);
  return most;
}

/* The tolerance of the iteration is 1e-3 of v: 2e-3 of the kinetic energy a step, which gravity does not need. */
static void a_ball_gains_no_energy_at_the_floor(void **state) {
  (void)state;
  const double gap[] = {0.5, 0.5, 0.5, 0.1 * reach}, speed[] = {0, 10, 100, 0};
  for (int k = 0; k < 4; k++)
    for (double rate = 30; rate <= 120; rate *= 2) {
      double first, most = largest_energy(gap[k], speed[k], 1 / rate, &first);
      print_message("gap %g m, %3g m/s, h = 1/%-3g s: largest energy %.4g of the first\n", gap[k], speed[k], rate,
                    most / first);
      assert_true(most <= 1.002 * first);
    }
}

/* m, the error at 1 s of two particles of 1 kg on a spring of 10 N/m, swinging by 0.05 m beside a barrier. */
static double swing_error(double h) {
  test_engine t;
  open_world(&t, "bdf2:tolerance=1e-9", h);
  const uint32_t edge[1][2] = {{test_particle(&t, -0.5, 0, 0, 1), test_particle(&t, 0.5, 0, 0, 1)}};
  t.scene->particles.velocity[0] = 0.2, t.scene->particles.velocity[3] = -0.2;
  hk_plugin_spec *springs = test_plugin(&t, HK_FORCE, "springs");
  test_edges(&t, springs, edge, 1);
  test_number(&t, springs, "k", 10);
  add_barrier(&t);
  test_run(&t);
  test_advance(&t, 1);
  double w = sqrt(20), error = fabs(test_position(&t, edge[0][1])[0] - (0.5 - 0.2 / w * sin(w)));
  test_engine_close(&t);
  return error;
}

static void the_order_is_two_where_nothing_touches(void **state) {
  (void)state;
  double error[4];
  for (int k = 0; k < 4; k++) error[k] = swing_error(0.01 / (1 << k));
  for (int k = 0; k < 3; k++) {
    double order = log2(error[k] / error[k + 1]);
    print_message("h = %g s: error %.3e m, order %.3f\n", 0.01 / (1 << k), error[k], order);
    assert_true(fabs(order - 2) < 0.15);
  }
}

/* A point over the middle of a triangle, far from the origin as well. A gap whose force is not known is refused. */
static void a_start_that_touches_is_refused_by_name(void **state) {
  (void)state;
  const double far[] = {0, 16}, gap[] = {1e-17, 1e-14, 1e-13};
  for (size_t k = 0; k < 6; k++) {
    test_engine t;
    double x = far[k / 3];
    open_world(&t, "bdf2", 1. / 120);
    const uint32_t ids[1][3] = {
        {test_particle(&t, x + 1, 0, 0, 1), test_particle(&t, x - 1, 1, 0, 1), test_particle(&t, x - 1, -1, 0, 1)}};
    assert_int_equal(hk_scene_add_triangles(t.scene, 1, ids, &t.error), HK_OK);
    test_particle(&t, x, 0, gap[k % 3], 1);
    test_number(&t, add_barrier(&t), "radius", 0);
    assert_int_equal(hk_run_open(t.scene, &t.options, &t.run, &t.error), HK_BAD_PARAM);
    if (k % 3 == 0) print_message("%s\n", t.error.text);
    assert_non_null(strstr(t.error.text, "particle 4 and triangle 1 2 3 are in contact"));
    test_engine_close(&t);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_ball_gains_no_energy_at_the_floor),
      cmocka_unit_test(a_start_that_touches_is_refused_by_name),
      cmocka_unit_test(the_order_is_two_where_nothing_touches),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
