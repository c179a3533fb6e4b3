/* The energy balance of steps that correctors end, by methods that do not know it themselves: a floor that rises slowly
 * under a spring does all the work that this stores, k d^2/2, and what a method loses across corrections stays seen. */
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
    "local damping = param('damping', 0, '')\n"
    "local s = hooke.scene{ duration = 1, fps = 10, dt = 2e-3, integrator = 'bdf2' }\n"
    "local top = s:particle{ position = { 0.3, 0.2, 1 }, mass = 1 }\n"
    "local p = s:particle{ position = { 0.3, 0.2, 0 }, mass = 0.1 }\n"
    "s:pin{ top }\n"
    "s:force('springs', { edges = { { top, p } }, k = 2e4, damping = damping })\n"
    "s:corrector('obstacle', { position = function(t) return { 0, 0, 0.05 * t * t * (3 - 2 * t) } end })\n"
    "return s\n";

static void what_is_pressed_has_the_work_that_was_done(void **state) {
  (void)state;
  static const char *const methods[] = {"bdf2", "imex", "rk4", "stoermer", "local_leapfrog", "implicit_midpoint"};
  const double all = 25; /* J */
  char command[256];
  test_write("press.lua", press);
  for (size_t k = 0; k < 2 * sizeof methods / sizeof *methods; k++) {
    const char *method = methods[k / 2], *damping = k % 2 ? "damping=10" : "";
    snprintf(command, sizeof command, "run press.lua --quiet --json --no-output --no-check --integrator %s %s", method,
             damping);
    test_hooke(&r, NULL, command);
    double work = test_json(r.out, "work"), last = test_json(r.out, "last");
    print_message("%-18s %-10s work %.9f J, energy %.9f J\n", method, damping, work, last);
    if (!(fabs(work - all) < 1e-6 * all && fabs(last - all) < 1e-6 * all)) fail_msg("%s is off: %s", method, r.err);
  }
}

/* A mass swings on a floor that bears it, without friction, and another one beside, free. The method loses as much in
 * both. */
static const char swing[] = "local w, g = 4, 0.1\n" /* a fall of 1e-4 m in a step tilts no spring */
                            "local s = hooke.scene{ duration = 2, fps = 10, dt = 5e-2, integrator = 'bdf2' }\n"
                            "local function oscillator(z)\n"
                            "  local pin = s:particle{ position = { 0, z, z }, mass = 1 }\n"
                            "  local p = s:particle{ position = { 1, z, z }, velocity = { 1, 0, 0 }, mass = 1 }\n"
                            "  s:pin{ pin }\n"
                            "  s:force('springs', { edges = { { pin, p } }, k = w * w, label = 'at ' .. z })\n"
                            "  return p\n"
                            "end\n"
                            "local low, high = oscillator(0), oscillator(1)\n"
                            "s:force('gravity', { g = { 0, 0, -g }, only = { low } })\n"
                            "s:corrector('obstacle', {})\n"
                            "s:measure('has', function(st)\n"
                            "  local x, v = st:position(high)[1], st:velocity(high)[1]\n"
                            "  return v * v / 2 + w * w * (x - 1) ^ 2 / 2\n"
                            "end)\n"
                            "return s\n";

static void what_a_method_loses_across_corrections_is_seen(void **state) {
  (void)state;
  static const char *const methods[] = {"bdf2", "imex"};
  char command[256];
  test_write("swing.lua", swing);
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    snprintf(command, sizeof command, "run swing.lua --quiet --json --no-output --no-check --integrator %s",
             methods[k]);
    test_hooke(&r, NULL, command);
    double off = test_json(r.out, "last") - test_json(r.out, "first") - test_json(r.out, "work");
    double lost = 2 * (test_json(r.out, "has") - 0.5); /* J, of 1 kg (1 m/s)^2 / 2 each */
    print_message("%-18s two free masses lose %.7f J, the balance is off by %.7f J\n", methods[k], -lost, off);
    assert_true(fabs(lost) > 1e-4);
    assert_true(fabs(off - lost) < 1e-2 * fabs(lost));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_pressed_has_the_work_that_was_done),
                                     cmocka_unit_test(what_a_method_loses_across_corrections_is_seen)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
