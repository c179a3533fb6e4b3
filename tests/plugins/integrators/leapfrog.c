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

/* The apex of a pyramid of stiff, damped springs is pressed by 0.1 m in 1 s, with no speed at either end: forces that
 * are not linear. */
static const char pyramid[] =
    "local h = param('h', 1e-3, '')\n"
    "local s = hooke.scene{ duration = 1, fps = 10, dt = h, integrator = 'leapfrog' }\n"
    "local base, bars = {}, {}\n"
    "local apex = s:particle{ position = { 0, 0, 0.3 }, mass = 0.1 }\n"
    "for q = 1, 4 do\n"
    "  local a = math.pi / 2 * q\n"
    "  base[q] = s:particle{ position = { 0.3 * math.cos(a), 0.3 * math.sin(a), -0.1 }, mass = 1 }\n"
    "  bars[q] = { base[q], apex }\n"
    "end\n"
    "s:pin(base)\n"
    "s:force('springs', { edges = bars, k = 2e4, damping = 10 })\n"
    "s:body{ shape = 'box', size = { 0.2, 0.2, 0.1 }, position = { 0.01, 0.02, 0.355 },\n"
    "  path = function(t) return 0, 0, -0.1 * t * t * (3 - 2 * t) end }\n"
    "s:corrector('contact', { radius = 5e-3, leave = base })\n"
    "return s\n";

static double off_pyramid(double h) {
  char command[128];
  snprintf(command, sizeof command, "run pyramid.lua --quiet --json --no-output --no-check h=%g", h);
  test_hooke(&r, NULL, command);
  double work = test_json(r.out, "work"), last = test_json(r.out, "last");
  print_message("a pyramid, h = %g s: work %.9f J, energy %.9f J\n", h, work, last);
  return last - work;
}

static void where_forces_are_not_linear_the_balance_is_of_order_two(void **state) {
  (void)state;
  test_write("pyramid.lua", pyramid);
  double coarse = off_pyramid(8e-4), fine = off_pyramid(4e-4);
  assert_true(fabs(coarse) < 1e-4);
  assert_true(log2(fabs(coarse) / fabs(fine)) > 1.7);
}

/* Two boxes press a sheet between them out of its plane: springs turn and stretch by a quarter, dampers are as stiff as
 * the step allows. Measured at the ends of steps the balance was off by 0.16 of the largest kinetic energy. */
static const char pinch[] =
    "local N = 7\n"
    "local s = hooke.scene{ duration = 0.3, fps = 60, integrator = 'leapfrog' }\n"
    "local c = s:grid{ nx = N, ny = N, width = 0.3, height = 0.3, density = 0.2, alternating = true,\n"
    "  origin = { -0.15, -0.15, 0.2 } }\n"
    "s:force('springs', s:membrane(c, { stiffness = 100, nu = 1 / 3, damping = 0.02 }))\n"
    "local ends = {}\n"
    "for i = 1, N do ends[2 * i - 1], ends[2 * i] = c:at(i, 1), c:at(i, N) end\n"
    "s:pin(ends)\n"
    "local function way(t) t = t / 0.3; return t * t * (3 - 2 * t) end\n"
    "for _, box in ipairs{ { 0.01, 0, 0.1, 0.13 }, { -0.02, 0.02, 0.36, -0.02 } } do\n"
    "  s:body{ shape = 'box', size = { 0.08, 0.08, 0.1 }, position = { box[1], box[2], box[3] },\n"
    "    path = function(t) return 0, 0, box[4] * way(t) end }\n"
    "end\n"
    "s:force('drag', { rate = 3 })\n"
    "s:corrector('contact', { thickness = 4e-3, friction = 0.3 })\n"
    "return s\n";

static void a_pinched_sheet_is_balanced_at_the_step_that_is_chosen(void **state) {
  (void)state;
  test_write("pinch.lua", pinch);
  test_hooke(&r, NULL, "run pinch.lua --quiet --json --no-output --no-check");
  double drift = test_json(r.out, "drift");
  print_message("a pinched sheet: off by %g of the largest kinetic energy\n", drift);
  assert_int_equal(r.code, 0);
  assert_true(fabs(drift) < 0.02);
}

/* A sheet with stiff dampers falls on a floor, and another one on it. What dampers take in an impact is counted along
 * the way that the impact leaves. */
static const char land[] =
    "local s = hooke.scene{ duration = 0.2, fps = 60, integrator = 'leapfrog' }\n"
    "s:body{ shape = 'plane', size = 1 }\n"
    "for k = 1, 2 do\n"
    "  local c = s:grid{ nx = 6, ny = 6, width = 0.3, height = 0.3, density = 0.2, alternating = true,\n"
    "    origin = { -0.15, -0.15, 0.03 * k }, u = { 1, 0, 0.1 * k }, v = { 0, 1, 0 } }\n"
    "  local m = s:membrane(c, { stiffness = 100, nu = 1 / 3, damping = 0.1 })\n"
    "  m.label = 'sheet ' .. k\n"
    "  s:force('springs', m)\n"
    "end\n"
    "s:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "s:corrector('contact', { thickness = 4e-3, friction = 0.3 })\n"
    "return s\n";

static void landing_with_dampers_is_balanced(void **state) {
  (void)state;
  test_write("land.lua", land);
  test_hooke(&r, NULL, "run land.lua --quiet --json --no-output --no-check");
  double drift = test_json(r.out, "drift");
  print_message("sheets that land: off by %g of the largest kinetic energy\n", drift);
  assert_int_equal(r.code, 0);
  assert_true(fabs(drift) < 3e-4);
}

/* A chain of cables falls on a cylinder; cables become taut and slack all the time. Multipliers that jump are no error
 * of the motion's energy: it is off by the cube of the step, 1.6e-5 at half the step, and was by 4e-3 at this one. */
static const char chain[] =
    "local s = hooke.scene{ duration = 0.6, fps = 50, dt = 1e-3, integrator = 'leapfrog' }\n"
    "local c = s:strand{ n = 13, length = 0.6, from = { -0.27, 0.004, 0.4 }, direction = { 1, 0, 0 }, mass = 0.1 }\n"
    "s:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "s:constraint('cables', { edges = c:edges() })\n"
    "s:body{ shape = 'cylinder', radius = 0.1, length = 0.2, detail = 1e-2, orientation = { math.pi / 2, 0, 0 },\n"
    "  position = { 0, 0, 0.25 } }\n"
    "s:corrector('contact', { radius = 0.005, friction = 0.2 })\n"
    "return s\n";

static void cables_on_what_they_touch_are_balanced(void **state) {
  (void)state;
  test_write("chain.lua", chain);
  test_hooke(&r, NULL, "run chain.lua --quiet --json --no-output --no-check");
  double drift = test_json(r.out, "drift");
  print_message("a chain of cables: off by %g of the largest kinetic energy\n", drift);
  assert_int_equal(r.code, 0);
  assert_true(fabs(drift) < 3e-4);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_contact_compresses_has_the_energy_that_was_put_into_it),
                                     cmocka_unit_test(where_forces_are_not_linear_the_balance_is_of_order_two),
                                     cmocka_unit_test(a_pinched_sheet_is_balanced_at_the_step_that_is_chosen),
                                     cmocka_unit_test(landing_with_dampers_is_balanced),
                                     cmocka_unit_test(cables_on_what_they_touch_are_balanced)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
