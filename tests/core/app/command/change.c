/* hooke run --resume FILE --change NAME=VALUE: a run goes on with another value of a parameter, from the present state;
 * the run says so, its energy is balanced with what the change gives, and what a run under way cannot have is refused.
 */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* An oscillator of 1 kg that passes its place of rest with 2 m/s: x = (v/w) sin wt. */
static const char scene[] = "local k = param('k', 100, 'stiffness, N/m', { min = 1 })\n"
                            "local mass = param('mass', 1, 'kg')\n"
                            "local extra = param('extra', 0, 'particles more')\n"
                            "local scene = hooke.scene { duration = 2, fps = 50 }\n"
                            "scene:particle { position = {0, 0, 0} }\n"
                            "scene:particle { position = {1, 0, 0}, velocity = {2, 0, 0}, mass = mass }\n"
                            "for i = 1, extra do scene:particle { position = {0, i, 0} } end\n"
                            "scene:pin { 1 }\n"
                            "scene:force('springs', { edges = { {1, 2} }, k = k })\n"
                            "scene:measure('x', function(s) return s:position(2)[1] - 1 end)\n"
                            "scene:output('checkpoint', { every = 25 })\n"
                            "return scene\n";

/* half.checkpoint, at 0.5 s. */
static void begin(const char *options) {
  static test_result r;
  char arguments[256];
  test_write("spring.lua", scene);
  snprintf(arguments, sizeof arguments, "run spring.lua --until 0.5 --quiet --out part %s", options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, "cp part/newest.checkpoint half.checkpoint;", "--version");
  assert_int_equal(r.code, 0);
}

static void go_on(test_result *r, const char *options) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run spring.lua --resume half.checkpoint --until 2 --out rest --json %s",
           options);
  test_hooke(r, NULL, arguments);
}

/* From 0.5 s on the frequency is 20 /s in place of 10. To 1e-5 m: both methods, the explicit one in steps of 0.2 ms and
 * the one of many steps with its history, are within 4e-6 m of it. */
static void it_goes_on_from_the_present_state_by_the_other_law(void **state) {
  (void)state;
  static const char *const method[] = {"--integrator leapfrog --dt 2e-4", "--integrator dopri5 --tol 1e-10",
                                       "--integrator stoermer5 --dt 1e-3", "--integrator bdf2 --dt 2e-5"};
  for (size_t k = 0; k < sizeof method / sizeof *method; k++) {
    static test_result r;
    double x = 0.2 * sin(5), v = 2 * cos(5), exact = x * cos(30) + v / 20 * sin(30);
    double limit = k == 3 ? 1e-3 : 1e-5; /* of order 2, with 100 times the error constant of leapfrog's phase */
    begin(method[k]);
    go_on(&r, "--change k=400");
    if (r.code != 0) fail_msg("%s: code %d: %s", method[k], r.code, r.err);
    if (!(fabs(test_json(r.out, "x") - exact) < limit))
      fail_msg("%s: x = %.9g m in place of %.9g", method[k], test_json(r.out, "x"), exact);
    if (!strstr(r.err, "from t = 0.5 s on the parameter k was 100 and is 400: positions, velocities and masses stay as "
                       "they are, and the energy changes by 5.517 J")) /* 150 N/m x^2 */
      fail_msg("%s", r.err);
    assert_non_null(strstr(r.out, "its parameters were changed while it ran, which no other run repeats"));
    if (!(fabs(test_json(r.out, "drift")) < 1e-3)) fail_msg("%s: drift %g", method[k], test_json(r.out, "drift"));
  }
}

/* The step follows the new stiffness: it is 0.2 s by the old one, above the new limit of 2 / 100 s. */
static void the_chosen_step_is_that_of_the_new_value(void **state) {
  (void)state;
  static test_result r;
  begin("--integrator leapfrog");
  go_on(&r, "--change k=10000");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  assert_true(test_json(r.out, "dt_min") < 0.02);
}

static void a_run_that_goes_on_twice_has_both_changes(void **state) {
  (void)state;
  static test_result r;
  begin("");
  test_hooke(&r, NULL, "run spring.lua --resume half.checkpoint --until 1 --out twice --quiet --change k=400");
  assert_int_equal(r.code, 0);
  test_hooke(&r, "cp twice/from-step-*/newest.checkpoint one.checkpoint;",
             "run spring.lua --resume one.checkpoint --until 2 --out last --json --change k=50");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  assert_non_null(strstr(r.out, "from t = 0.5 s on the parameter k was 100 and is 400"));
  assert_non_null(strstr(r.out, "from t = 1 s on the parameter k was 400 and is 50"));
  test_hooke(&r, NULL, "run spring.lua --resume one.checkpoint --until 2 --out last --json"); /* k stays 400 */
  if (r.code != 0 || !strstr(r.err, "k=400")) fail_msg("code %d: %s", r.code, r.err);
}

/* An accuracy is that of one scene. */
static void no_accuracy_is_claimed(void **state) {
  (void)state;
  static test_result r;
  begin("");
  go_on(&r, "--change k=400 --accuracy 1e-3");
  assert_int_equal(r.code, 5);
  assert_non_null(strstr(r.out, "changed parameters as it ran, which no other run repeats"));
}

static void what_a_run_under_way_cannot_have_is_refused(void **state) {
  (void)state;
  static test_result r;
  begin("");
  go_on(&r, "--change mass=2");
  if (r.code != 1 ||
      !strstr(r.err, "the parameter mass was 1 and is 2, with which particle 2 has another mass or group"))
    fail_msg("code %d: %s", r.code, r.err);
  go_on(&r, "--change extra=3");
  if (r.code != 1 || !strstr(r.err, "with which there are 5 particles in place of 2"))
    fail_msg("%d: %s", r.code, r.err);
  go_on(&r, "--change nothing=3");
  if (r.code != 1 || !strstr(r.err, "has no parameter 'nothing'")) fail_msg("code %d: %s", r.code, r.err);
  go_on(&r, "--change k");
  if (r.code != 1 || !strstr(r.err, "--change: 'k' is not the parameter and its value"))
    fail_msg("%d: %s", r.code, r.err);
  go_on(&r, "k=400");
  if (r.code != 1 || !strstr(r.err, "--change NAME=VALUE goes on with another value"))
    fail_msg("%d: %s", r.code, r.err);
  test_hooke(&r, NULL, "run spring.lua --change k=400 --quiet");
  if (r.code != 1 || !strstr(r.err, "give its checkpoint as well, --resume FILE")) fail_msg("%d: %s", r.code, r.err);
}

/* A pin that is moved by a parameter is elsewhere by its new value, at once. */
static void pins_that_jump_are_told(void **state) {
  (void)state;
  static test_result r;
  test_write("pin.lua", "local way = param('way', 1, 'm')\n"
                        "local scene = hooke.scene { duration = 1, fps = 50 }\n"
                        "scene:particle { position = {0, 0, 0} }\n"
                        "scene:particle { position = {1, 0, 0} }\n"
                        "scene:pin({ 1 }, { path = function(t) return 0, way * t, 0 end })\n"
                        "scene:force('springs', { edges = { {1, 2} }, k = 100 })\n"
                        "scene:output('checkpoint', { every = 25 })\n"
                        "return scene\n");
  test_hooke(&r, NULL, "run pin.lua --until 0.5 --quiet --out pinned");
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run pin.lua --resume pinned/newest.checkpoint --until 1 --change way=3 --out moved");
  if (r.code != 0 || !strstr(r.err, "stay as they are but for pins, which jump by 1 m to where they are by it"))
    fail_msg("code %d: %s", r.code, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(it_goes_on_from_the_present_state_by_the_other_law),
      cmocka_unit_test(the_chosen_step_is_that_of_the_new_value),
      cmocka_unit_test(a_run_that_goes_on_twice_has_both_changes),
      cmocka_unit_test(no_accuracy_is_claimed),
      cmocka_unit_test(what_a_run_under_way_cannot_have_is_refused),
      cmocka_unit_test(pins_that_jump_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
