/* Largest stable steps in scenes with constraints: the frequencies of the motion that these allow, with what their
 * forces stiffen. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

static void limit_is(const char *options, double wanted, double tolerance) {
  char arguments[1024];
  snprintf(arguments, sizeof arguments, "run %s/scene.lua --json --no-output --integrator leapfrog %s", test_folder(),
           options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", options, r.code, r.err, r.out);
  double limit = test_json(r.out, "dt_limit");
  if (!(fabs(limit / wanted - 1) <= tolerance)) fail_msg("%s: the limit is %g s, not %g s", options, limit, wanted);
}

/* A pendulum that passes its lowest point at the speed v = 1 m/s: its force m (g + v^2/L) gives leapfrog the limit
 * 2/sqrt(g/L + v^2/L^2), and without gravity 2 L/v. That off the sphere accelerations depend on the velocity does not
 * turn velocities, for which leapfrog would have no stable step. The central differences are right to 1e-8. */
static void a_pendulum_has_the_limit_of_its_swing(void **state) {
  (void)state;
  test_write("scene.lua", "local g = param('g', 9.81, 'm/s^2')\n"
                          "local scene = hooke.scene { duration = 0.01, fps = 100 }\n"
                          "local p = scene:particle { position = { 0, 0, -1.5 }, velocity = { 1, 0, 0 } }\n"
                          "scene:force('gravity', { g = { 0, 0, -g } })\n"
                          "scene:constraint('surface', { particles = { p }, radius = 1.5 })\n"
                          "return scene\n");
  limit_is("", 2 / sqrt(9.81 / 1.5 + 1 / 1.5 / 1.5), 1e-6);
  limit_is("g=0", 3, 1e-6);
}

/* A chain of n bars that turns about its end at the rate W is pulled by T = m n W^2 L/2 at the hub: its shortest waves
 * have the frequency 2 sqrt(T/(m l)) = W n sqrt 2 there, a little less over the whole length. */
static void a_sling_is_stiffened_by_its_own_pull(void **state) {
  (void)state;
  test_write("scene.lua",
             "local n, W = param('n', 20, ''), param('W', 30, '')\n"
             "local scene = hooke.scene { duration = 0.01, fps = 100 }\n"
             "local ids, edges = {}, {}\n"
             "for k = 0, n do\n"
             "  ids[k] = scene:particle { position = { k / n, 0, 0 }, velocity = { 0, W * k / n, 0 }, mass = 1 / n }\n"
             "  if k > 0 then edges[k] = { ids[k - 1], ids[k] } end\n"
             "end\n"
             "scene:pin { ids[0] }\n"
             "scene:constraint('bars', { edges = edges })\n"
             "return scene\n");
  limit_is("", 2 / (30 * 20 * sqrt(2)), 0.06);
  limit_is("n=60 W=300", 2 / (300 * 60 * sqrt(2)), 0.06);
}

/* A hanging chain has that of its waves under gravity: 2 sqrt(T/(m l)) = 2 n sqrt(g/L) at the top. */
static void a_hanging_chain_has_the_limit_of_its_shortest_waves(void **state) {
  (void)state;
  test_write("scene.lua", "local n = param('n', 20, '')\n"
                          "local scene = hooke.scene { duration = 0.01, fps = 100 }\n"
                          "local s = scene:strand { n = n + 1, from = { 0, 0, 0 }, to = { 0, 0, -1 }, mass = 1 }\n"
                          "scene:pin { s:at(1) }\n"
                          "scene:force('gravity')\n"
                          "scene:constraint('bars', { edges = s:structural() })\n"
                          "return scene\n");
  limit_is("", 2 / (2 * 20 * sqrt(9.81)), 0.06);
  limit_is("n=100", 2 / (2 * 100 * sqrt(9.81)), 0.06);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pendulum_has_the_limit_of_its_swing),
      cmocka_unit_test(a_sling_is_stiffened_by_its_own_pull),
      cmocka_unit_test(a_hanging_chain_has_the_limit_of_its_shortest_waves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
