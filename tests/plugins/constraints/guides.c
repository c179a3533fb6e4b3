/* Guides: a bead on a rod that turns, against its closed form, and the sentence for what has no direction. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void near(const char *key, double wanted, double tolerance) {
  double got = test_json(strstr(r.out, "\"measures\""), key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s is %.12g, not %.12g +- %g", key, got, wanted, tolerance);
}

/* A bead without friction on a rod that is turned at w = 2 rad/s, at rest on it 0.1 m from the axis: it keeps no
 * angular momentum, and is at 0.1 cosh(w t) (Landau and Lifshitz, Mechanics, section 39). The rod is two pins on
 * circles, the bead stays in the plane across them: the error is that of leapfrog, (w h)^2 t. Its multiplier is the
 * force across, 2 m w r'. */
static void a_bead_on_a_turning_rod_goes_out_as_known(void **state) {
  (void)state;
  test_write(
      "bead.lua",
      "local w = 2\n"
      "local scene = hooke.scene { duration = 1, fps = 10, dt = 1 / 2000, integrator = 'leapfrog' }\n"
      "local a = scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
      "local c = scene:particle { position = { 0, 0, 1 }, mass = 1 }\n"
      "local d = scene:particle { position = { 0, 0.5, 1 }, mass = 1 }\n"
      "local b = scene:particle { position = { 0.1, 0, 0 }, velocity = { 0, 0.1 * w, 0 }, mass = 3 }\n"
      "scene:pin { a, c }\n"
      "scene:pin({ d }, { path = function(t) return -0.5 * math.sin(w * t), 0.5 * math.cos(w * t) - 0.5, 0 end })\n"
      "scene:constraint('guides', { points = { { a, b, c, d } } })\n"
      "scene:measure('r', function(s) local p = s:position(b) return math.sqrt(p[1] ^ 2 + p[2] ^ 2) end)\n"
      "scene:measure('f', function(s) return s:constraint_forces('guides')[1] end)\nreturn scene\n");
  test_hooke(&r, NULL, "run bead.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  near("r", 0.1 * cosh(2), 1e-6);
  near("f", 2 * 3 * 2 * 0.1 * 2 * sinh(2), 1e-4);
}

static void what_has_no_direction_gets_a_sentence(void **state) {
  (void)state;
  test_refused("local scene = hooke.scene { duration = 0.1 }\n"
               "local p = {}\nfor k = 1, 4 do p[k] = scene:particle { position = { k // 4, 0, 0 }, mass = 1 } end\n"
               "scene:constraint('guides', { points = { { p[1], p[4], p[2], p[3] } } })\nreturn scene\n",
               "--quiet --no-output", 1, "particles 2 and 3, start in one place: their way has no direction");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bead_on_a_turning_rod_goes_out_as_known),
      cmocka_unit_test(what_has_no_direction_gets_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
