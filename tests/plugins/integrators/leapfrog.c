/* The energy balance of leapfrog where a corrector bears a load: a floor that rises slowly compresses a spring under a
 * mass, by contact of surfaces or as an obstacle, and does the work k d^2/2, all that there is. Damping takes next to
 * nothing. What a step falls and is put back has to be no energy, as near to the largest stable step as it may be. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static const char press[] =
    "local surfaces, h, damping = param('surfaces', true, ''), param('h', 1e-3, ''), param('damping', 0, '')\n"
    "local s = hooke.scene{ duration = 1, fps = 10, dt = h, integrator = 'leapfrog' }\n"
    "local top = s:particle{ position = { 0.3, 0.2, 1 }, mass = 1 }\n"
    "local p = s:particle{ position = { 0.3, 0.2, 0 }, mass = 0.1 }\n"
    "s:pin{ top }\n"
    "s:force('springs', { edges = { { top, p } }, k = 1e5, damping = damping })\n"
    "local function rise(t) return 0.05 * t * t * (3 - 2 * t) end\n"
    "if surfaces then\n"
    "  s:body{ shape = 'box', size = { 4, 4, 0.1 }, position = { 0, 0, -0.055 },\n"
    "    path = function(t) return 0, 0, rise(t) end }\n"
    "  s:corrector('contact', { radius = 5e-3, leave = { top } })\n"
    "else\n"
    "  s:corrector('obstacle', { position = function(t) return { 0, 0, rise(t) } end })\n"
    "end\n"
    "return s\n";

static const double all = 125; /* J, k d^2/2 */

static void check(const char *options) {
  char command[256];
  snprintf(command, sizeof command, "run press.lua --quiet --json --no-output %s", options);
  test_hooke(&r, NULL, command);
  if (r.code != 0 && r.code != 5) fail_msg("%s: exit %d: %s", options, r.code, r.err);
  double work = test_json(r.out, "work"), last = test_json(r.out, "last");
  print_message("%-50s work %.9f J, energy %.9f J\n", options, work, last);
  assert_true(fabs(last - all) < 1e-6 * all);
  assert_true(fabs(work - last) < 1e-6 * all);
}

static void what_contact_compresses_has_the_energy_that_was_put_into_it(void **state) {
  (void)state;
  test_write("press.lua", press);
  check("surfaces=true h=0.001");
  check("surfaces=true h=0.00025");
  check("surfaces=true h=0.001 damping=20");
  check("surfaces=false h=0.001");
  check("surfaces=false h=0.001 damping=20");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_contact_compresses_has_the_energy_that_was_put_into_it)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
