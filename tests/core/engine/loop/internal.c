/* When internal variables of forces move: with accepted steps alone, before what follows sees them; and what they
 * dissipate in the balance that the verdict rests on. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* A mass on a spring with a branch that relaxes; `way`: m, of a step that is let through, 0: all are. */
static double place_after_a_second(double way, size_t *rejected) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1);
  e.scene->particles.velocity[3] = 1;
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "maxwell_springs");
  test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, spec, "k", 30);
  test_number(&e, spec, "k_m", 50);
  test_number(&e, spec, "tau", 0.1);
  if (way > 0) test_number(&e, test_plugin(&e, HK_CORRECTOR, "fixture:rejecter"), "way", way);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  e.scene->fps = 10;
  e.options.dt = 0.02;
  test_run(&e);
  test_advance(&e, 1);
  double x = test_position(&e, 2)[0];
  *rejected = e.run->record.rejected;
  test_engine_close(&e);
  return x;
}

/* The branch knows the time and the length of the last accepted state. Steps of 0.02 s are off by 1.1e-6 m, and halves
 * of them by less; a step that is taken back and counted would be seen a thousand times larger. */
static void steps_that_are_taken_back_leave_no_trace(void **state) {
  (void)state;
  size_t none, many;
  double whole = place_after_a_second(0, &none), halves = place_after_a_second(0.004, &many);
  print_message("%zu steps taken back: %.2e m apart\n", many, fabs(whole - halves));
  assert_true(none == 0 && many >= 10);
  assert_true(fabs(whole - halves) < 2e-6);
}

static test_result r;

/* The verdict on a mass that is thrown on springs of tests/fixtures/wrong/internal.c with that fault. */
static const char *verdict_on(const char *bug) {
  char before[1024];
  test_write("thrown.lua", "local scene = hooke.scene { duration = 1, dt = 1e-3, fps = 20, integrator = 'leapfrog' }\n"
                           "local a = scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
                           "local b = scene:particle { position = { 0.8, 0, 0 }, velocity = { 1, 0, 0 }, mass = 1 }\n"
                           "scene:pin { a }\n"
                           "scene:force('./internal.so', { edges = { { a, b } } })\nreturn scene\n");
  snprintf(
      before, sizeof before,
      "cc -O1 -w -shared -fPIC -DBUG=%s $('%s/hooke' --cflags) '%s/tests/fixtures/wrong/internal.c' -o internal.so "
      "-lm && ",
      bug, HK_BUILD, HK_ROOT);
  test_hooke(&r, before, "run thrown.lua --trust --quiet --json --no-output");
  const char *found = strstr(r.out, "\"verdict\":");
  return found ? found : r.err;
}

static void a_loss_that_is_told_wrongly_makes_a_run_inaccurate(void **state) {
  (void)state;
  static const char *const expected[][2] = {{"NONE", "\"verdict\":\"ok\""},
                                            {"LOST_HALF", "\"verdict\":\"inaccurate\""},
                                            {"LOST_NOTHING", "\"verdict\":\"inaccurate\""}};
  for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
    const char *verdict = verdict_on(expected[k][0]);
    if (strncmp(verdict, expected[k][1], strlen(expected[k][1])) != 0) fail_msg("%s: %s", expected[k][0], verdict);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_that_are_taken_back_leave_no_trace),
      cmocka_unit_test(a_loss_that_is_told_wrongly_makes_a_run_inaccurate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
