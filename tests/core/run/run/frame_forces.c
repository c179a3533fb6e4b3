/* What outputs are told at frames: forces one by one, the last step, the error estimate. Asking leaves nothing behind.
 */
#include "tests/fixtures/looker.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const looker *look_at(test_engine *e, const hk_plugin_spec *spec) { return test_instance(e, spec)->self; }

static hk_plugin_spec *add_looker(test_engine *e) {
  e->options.no_output = false;
  return test_plugin(e, HK_OUTPUT, "fixture:looker");
}

/* With g = 9.81 along -z, a spring of 100 N/m from 1 m to 1.5 m, and a field that begins after the end of the run. */
static void every_force_is_told_by_name(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 2);
  test_particle(&e, 1.5, 0, 0, 3);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t[1][2]){{1, 2}}, 1);
  test_number(&e, springs, "k", 100);
  test_number(&e, springs, "rest", 1);
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  hk_plugin_spec *later = test_plugin(&e, HK_FORCE, "gravity");
  later->from = 100;
  const hk_plugin_spec *seen = add_looker(&e);
  test_run(&e);
  const looker *l = look_at(&e, seen);
  assert_int_equal(l->frames, 1);
  assert_int_equal(l->forces, 3);
  assert_string_equal(l->name[0], "springs");
  assert_string_equal(l->name[1], "gravity");
  assert_string_equal(l->scene, "test.lua");
  assert_true(l->step == 0 && isnan(l->error));
  for (int c = 0; c < 6; c++) assert_true(fabs(l->f[0][c] - (c == 0 ? 50 : c == 3 ? -50 : 0)) < 50 * 4e-16);
  assert_true(l->f[1][2] == 2 * -9.81 && l->f[1][5] == 3 * -9.81);
  for (int c = 0; c < 6; c++) assert_true(l->f[2][c] == 0);
  test_advance(&e, 0.1);
  assert_true(l->step > 0 && l->step < 1.0 / 60 * (1 + 1e-12));
  test_engine_close(&e);
}

static void methods_that_estimate_their_error_tell_it(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 1, 0, 0, 1);
  test_number(&e, test_plugin(&e, HK_FORCE, "central"), "strength", 3);
  e.options.integrator = "dopri5";
  const hk_plugin_spec *seen = add_looker(&e);
  test_run(&e);
  test_advance(&e, 0.2);
  const looker *l = look_at(&e, seen);
  assert_true(l->error > 0 && l->error <= 1 + 1e-9); /* accepted steps are within the tolerance, 1 */
  test_engine_close(&e);
}

/* Spheres that touch and rub: their force has a history, the tangential springs of every contact. */
static void rub(test_engine *e, bool looked_at) {
  test_engine_open(e);
  srand(1);
  for (int k = 0; k < 27; k++)
    test_particle(e, 0.19 * (k % 3) + 1e-3 * (rand() % 9), 0.19 * (k / 3 % 3) + 1e-3 * (rand() % 9), 0.19 * (k / 9),
                  0.1);
  hk_plugin_spec *spheres = test_plugin(e, HK_FORCE, "soft_spheres");
  test_number(e, spheres, "radius", 0.1);
  test_number(e, spheres, "friction", 0.5);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0.3, 0, -1);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_pin(e, HK_PIN_FIXED, 5, NULL);
  if (looked_at) add_looker(e);
  test_run(e);
  test_advance(e, 0.5);
}

static void asking_leaves_nothing_behind(void **state) {
  (void)state;
  test_engine bare, watched;
  rub(&bare, false);
  rub(&watched, true);
  assert_int_equal(bare.run->state.size, watched.run->state.size);
  assert_memory_equal(bare.run->state.X, watched.run->state.X, bare.run->state.size * sizeof(double));
  assert_int_equal(bare.run->dynamics.count.evaluations, watched.run->dynamics.count.evaluations);
  test_engine_close(&bare);
  test_engine_close(&watched);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_force_is_told_by_name),
      cmocka_unit_test(methods_that_estimate_their_error_tell_it),
      cmocka_unit_test(asking_leaves_nothing_behind),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
