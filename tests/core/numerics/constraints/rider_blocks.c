/* Equations on riders: bodies hang on welds and bars of their points as they should, by every kind of method, and the
 * forces that scripts read are those on the points. */
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

/* A box of 2 kg whose upper corner hangs on a weld or a bar; pulled aside by a, rad. */
static void run(const char *how, double a, double end, const char *options) {
  char scene[2048], line[256];
  snprintf(scene, sizeof scene,
           "local a, bar = %.17g, '%s' == 'bars'\n"
           "local scene = hooke.scene { duration = %g, fps = 10, dt = 1 / 400 }\n"
           "local b = scene:rigid { shape = 'box', size = {0.2, 0.3, 1}, mass = 2, orientation = {0, -a, 0},\n"
           "  position = {0.5 * math.sin(a), 0, -0.5 * math.cos(a)} }\n"
           "local top, low = b:point{0, 0, 0.5}, b:point{0, 0, -0.5}\n"
           "local hook = scene:particle { position = {0, 0, bar and 1 or 0}, mass = 0 }\n"
           "scene:pin { hook }\n"
           "scene:force('gravity', { g = {0, 0, -9.81} })\n"
           "scene:constraint(bar and 'bars' or 'weld', { edges = {{hook, top}}, label = 'hung' })\n"
           "scene:measure('E', function(s) return b:energy(s) + 2 * 9.81 * b:position(s)[3] end)\n"
           "scene:measure('z', function(s) return s:position(low)[3] end)\n"
           "scene:measure('T', function(s) return s:force('hung', top)[3] end)\n"
           "scene:measure('C', function(s) return s:force('hung', b:ids()[1])[3] end)\n"
           "scene:measure('w', function(s) return b:spin(s)[2] end)\n"
           "return scene\n",
           a, how, end);
  test_write("hung.lua", scene);
  snprintf(line, sizeof line, "run hung.lua --json --quiet %s", options);
  test_hooke(&r, NULL, line);
  if (r.code != 0) fail_msg("%s: exit %d: %s", options, r.code, r.err);
}

static void near(double found, double expected, double within) {
  if (!(fabs(found - expected) <= within)) fail_msg("%.17g, expected %.17g", found, expected);
}

static void a_body_at_rest_pulls_with_its_weight(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    run(k ? "bars" : "weld", 0, 0.2, "--integrator leapfrog");
    near(test_json(r.out, "T"), 2 * 9.81, 1e-9);
    near(test_json(r.out, "C"), 0, 0); /* what acts on a point is not what acts on its carriers */
    near(test_json(r.out, "z"), k ? -1 : -1, 1e-12);
  }
}

/* Let go at rest from 0.8 rad the box turns with w'^2 I = 2 m g d (cos - cos 0.8), I = m (0.2^2 + 1)/12 + m d^2 about
 * the weld: the energy at t gives the spin. */
static void a_swinging_body_keeps_its_energy_by_every_kind_of_method(void **state) {
  static const char *const methods[] = {"leapfrog",          "kahan_li8",         "rk4",
                                        "dopri5 --tol 1e-9", "implicit_midpoint", "esdirk4 --tol 1e-8"};
  const double within[] = {3e-5, 1e-12, 1e-9, 1e-6, 1e-4, 1e-5};
  (void)state;
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    char options[64];
    snprintf(options, sizeof options, "--integrator %s", methods[k]);
    run("weld", 0.8, 0.7, options);
    double E = -2 * 9.81 * 0.5 * cos(0.8), I = 2 * 1.04 / 12 + 0.5, w = test_json(r.out, "w");
    double z = test_json(r.out, "z"); /* of the lower end, 1 m from the weld */
    near(test_json(r.out, "E"), E, within[k] * fabs(E));
    near(I * w * w / 2 + 9.81 * z, E, 3 * within[k] * fabs(E));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_body_at_rest_pulls_with_its_weight),
      cmocka_unit_test(a_swinging_body_keeps_its_energy_by_every_kind_of_method),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
