/* Drag by hand, its power and Jacobian, the choice between its two coefficients, and threads. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 0.5);
  test_particle(e, 1, 0, 0, 2);
  memcpy(e->scene->particles.velocity, (double[]){1, -2, 3, 0.5, 4, -1}, 6 * sizeof(double));
  e->options.dt = 1e-3;
  return test_plugin(e, HK_FORCE, "drag");
}

static void check(const char *name, double value, const double wanted[6], double power) {
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e);
  test_number(&e, spec, name, value);
  test_run(&e);
  hk_instance *drag = test_instance(&e, spec);
  hk_view view = force_view(&e, drag);
  double F[6];
  assert_true(fabs(force_evaluate(drag, &view, F) - power) < 1e-14);
  for (int k = 0; k < 6; k++) assert_true(fabs(F[k] - wanted[k]) < 1e-15);
  /* The force is linear: differences have rounding alone. */
  assert_true(force_damping_error(drag, &view) < 1e-12 && force_stiffness_error(drag, &view) == 0);
  test_engine_close(&e);
}

/* v.v is 14 and 17.25; masses 0.5 and 2. */
static void drag_per_particle_and_per_mass_by_hand(void **state) {
  (void)state;
  check("d", 0.25, (double[]){-0.25, 0.5, -0.75, -0.125, -1, 0.25}, -0.25 * 31.25);
  check("rate", 0.5, (double[]){-0.25, 0.5, -0.75, -0.5, -4, 1}, -0.5 * (0.5 * 14 + 2 * 17.25));
}

static void drag_wants_exactly_one_coefficient(void **state) {
  (void)state;
  for (int both = 0; both < 2; both++) {
    test_engine e;
    hk_plugin_spec *drag = open_scene(&e);
    if (both) test_number(&e, drag, "d", 1), test_number(&e, drag, "rate", 1);
    assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
    assert_non_null(strstr(e.error.text, "give either d"));
    test_engine_close(&e);
  }
}

/* 6 pi viscosity r v with the radii 0.1 and 0.3 of a channel, or one for all; four more particles are for the kernel
 * that takes fours. */
static void drag_by_radius_by_hand(void **state) {
  (void)state;
  for (int channel = 0; channel < 2; channel++) {
    test_engine e;
    double F[18];
    hk_plugin_spec *spec = open_scene(&e);
    for (int k = 0; k < 4; k++) test_particle(&e, k, 1, 0, 1);
    for (int k = 0; k < 18; k++) e.scene->particles.velocity[k] = k - 7;
    assert_int_equal(hk_scene_add_channel(e.scene, "heat", 2, NULL, NAN, NULL, &e.error), HK_OK);
    assert_int_equal(hk_scene_add_channel(e.scene, "radius", 1, (double[]){0.1}, NAN, NULL, &e.error), HK_OK);
    assert_int_equal(hk_scene_set_channel(e.scene, "radius", 2, (double[]){0.3}, 1, &e.error), HK_OK);
    test_number(&e, spec, "viscosity", 0.02);
    if (!channel) test_number(&e, spec, "radius", 0.2);
    test_run(&e);
    hk_instance *drag = test_instance(&e, spec);
    hk_view view = force_view(&e, drag);
    force_evaluate(drag, &view, F);
    for (int k = 0; k < 18; k++) {
      double r = !channel ? 0.2 : k / 3 == 1 ? 0.3 : 0.1;
      assert_true(fabs(F[k] + 6 * 3.14159265358979 * 0.02 * r * (k - 7)) < 1e-14);
    }
    assert_true(force_damping_error(drag, &view) < 1e-12);
    test_engine_close(&e);
  }
}

static void drag_refuses_radii_that_are_not_there(void **state) {
  (void)state;
  test_engine e;
  test_number(&e, open_scene(&e), "viscosity", 1);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "viscosity: the scene has no channel 'radius'; declare it"));
  test_engine_close(&e);
}

/* Enough particles for several chunks, on every other one of which it acts. A sum of n terms of one sign is right to
 * n/2 roundings at worst; the two sums here differ in order alone. */
static void drag_has_the_power_of_its_force_on_any_threads(void **state) {
  (void)state;
  enum { PARTICLES = 20000 };
  double *F = malloc(3 * PARTICLES * sizeof *F), *first = malloc(3 * PARTICLES * sizeof *first), power[3];
  double *x = calloc(3 * PARTICLES, sizeof *x), *v = malloc(3 * PARTICLES * sizeof *v);
  for (size_t k = 0; k < 3 * PARTICLES; k++) v[k] = sin((double)k);
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    uint32_t id;
    test_engine_open(&e);
    e.scene->threads = threads;
    e.options.dt = 1e-3;
    assert_int_equal(hk_scene_add_particles(e.scene, PARTICLES, x, NULL, NULL, 0.1, 0, &id, &e.error), HK_OK);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "drag");
    test_number(&e, spec, "rate", 3);
    spec->only = malloc(PARTICLES / 2 * sizeof *spec->only);
    for (spec->only_count = 0; spec->only_count < PARTICLES / 2; spec->only_count++)
      spec->only[spec->only_count] = 2 * (uint32_t)spec->only_count;
    test_run(&e);
    hk_instance *drag = test_instance(&e, spec);
    hk_view view = force_view(&e, drag);
    view.v = v;
    power[threads - 1] = force_evaluate(drag, &view, F);
    double known = 0;
    for (size_t k = 0; k < 3 * PARTICLES; k++) known += F[k] * v[k];
    assert_true(known < 0 && fabs(power[threads - 1] - known) < PARTICLES * 1.1e-16 * fabs(known));
    for (size_t k = 0; k < 3; k++) assert_true(F[3 + k] == 0);
    if (threads == 1) memcpy(first, F, 3 * PARTICLES * sizeof *F);
    assert_memory_equal(first, F, 3 * PARTICLES * sizeof *F);
    test_engine_close(&e);
  }
  assert_true(power[0] == power[1] && power[0] == power[2]);
  free(F);
  free(first);
  free(x);
  free(v);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(drag_per_particle_and_per_mass_by_hand),
      cmocka_unit_test(drag_wants_exactly_one_coefficient),
      cmocka_unit_test(drag_by_radius_by_hand),
      cmocka_unit_test(drag_refuses_radii_that_are_not_there),
      cmocka_unit_test(drag_has_the_power_of_its_force_on_any_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
