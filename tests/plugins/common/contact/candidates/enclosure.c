/* What starts wholly inside of something solid is refused, with how deep; what is hollow, soft or outside is not.
 * Depths are those of boxes by hand, printed to three digits. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static const char *text_of(const char *what) {
  static char text[2048];
  snprintf(text, sizeof text,
           "local s = hooke.scene { duration = 0.02, fps = 50, dt = 0.01, integrator = 'leapfrog' }\n"
           "local function rigid(size, x) s:rigid { shape = 'box', size = size, mass = 1, position = {x, 0, 0} "
           "}:surface() end\n"
           "local corners = {{-1,-1,-1}, {1,-1,-1}, {1,1,-1}, {-1,1,-1}, {-1,-1,1}, {1,-1,1}, {1,1,1}, {-1,1,1}}\n"
           "local outward = {{1,3,2}, {1,4,3}, {5,6,7}, {5,7,8}, {1,2,6}, {1,6,5}, {2,3,7}, {2,7,6}, {3,4,8}, {3,8,7}, "
           "{4,1,5}, {4,5,8}}\n"
           "local function cube(size, inward, mass)\n  local v, f = {}, {}\n"
           "  for k, p in ipairs(corners) do v[k] = { size * p[1] / 2, size * p[2] / 2, size * p[3] / 2 } end\n"
           "  for k, t in ipairs(outward) do f[k] = inward and { t[1], t[3], t[2] } or t end\n"
           "  local c = s:mesh { vertices = v, faces = f, mass = 1 }\n"
           "  if not mass then s:pin(c) end\nend\n"
           "%s\ns:corrector('contact', { radius = 1e-3, thickness = 1e-3 })\nreturn s\n",
           what);
  return text;
}

static void refuse(const char *what, const char *said) { test_refused(text_of(what), "", 1, said); }

static void accept(const char *what) {
  test_result r;
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s --no-output", test_write("in.lua", text_of(what)));
  test_hooke(&r, "", arguments);
  if (r.code != 0) fail_msg("%s: %s", what, r.err);
}

static void what_is_inside_of_a_solid_is_refused_with_its_depth(void **state) {
  (void)state;
  refuse("rigid(1, 0) rigid(0.4, 0.1)", "by up to 0.3 m");
  refuse("rigid(1, 0) s:particle { position = {0.1, 0, 0.42}, mass = 1 }", "by up to 0.08 m");
  refuse("rigid(1, 0) s:grid { nx = 2, ny = 2, width = 0.2, height = 0.2, mass = 1 }", "inside of something solid");
  refuse("rigid(1, 0) s:body { shape = 'box', size = 0.2 }", "by up to 0.4 m");
  refuse("s:body { shape = 'box', size = 2 } rigid(1, 0.2)", "by up to 0.5 m");
  refuse("cube(1) s:particle { position = {0, 0, 0.4}, mass = 1 }", "by up to 0.1 m");
}

/* The winding numbers of a box with a hollow add up to 0 there. */
static void what_is_in_a_hollow_or_outside_is_accepted(void **state) {
  (void)state;
  accept("cube(1, true) rigid(0.4, 0)");
  accept("cube(2) cube(1, true) rigid(0.4, 0)");
  accept("cube(1, false, 1) s:particle { position = {0, 0, 0.4}, mass = 1 }");
  accept("rigid(1, 0) rigid(1, 1.01) s:particle { position = {0, 0, 0.51}, mass = 1 }");
  accept("s:joint { kind = 'ball', a = (function() local b = s:rigid { shape = 'box', size = 1, mass = 1 } b:surface() "
         "return b end)(), at = {0, 0, 0.4} }");
}

static void the_wall_of_a_hollow_body_is_solid(void **state) {
  (void)state;
  refuse("cube(2) cube(1, true) rigid(0.2, 0.75)", "by up to 0.15 m");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_inside_of_a_solid_is_refused_with_its_depth),
      cmocka_unit_test(what_is_in_a_hollow_or_outside_is_accepted),
      cmocka_unit_test(the_wall_of_a_hollow_body_is_solid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
