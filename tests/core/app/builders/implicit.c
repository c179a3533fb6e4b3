/* scene:implicit: bodies, solids and numbers of formulas and metaballs, how often a function is called, and the
 * sentence for each thing that cannot be. */
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

static const char *const ball = "f = function(x, y, z) calls = calls + 1 return 1 - x*x - y*y - z*z end, "
                                "size = 0.1, box = { { -1.3, -1.3, -1.3 }, { 1.3, 1.3, 1.3 } }";

/* The value of a measure in the state s of a scene with the line `body`. */
static double measured(const char *body, const char *expression) {
  static char scene[8192];
  snprintf(
      scene, sizeof scene,
      "local calls = 0\nlocal scene = hooke.scene { duration = 0 }\n"
      "local function det(a, b, c) return a[1] * (b[2] * c[3] - b[3] * c[2]) + a[2] * (b[3] * c[1] - b[1] * c[3]) "
      "+ a[3] * (b[1] * c[2] - b[2] * c[1]) end\n"
      "local function minus(a, b) return { a[1] - b[1], a[2] - b[2], a[3] - b[3] } end\n"
      "local function volume(s, b)\n  local sum = 0\n  for _, t in ipairs(b:triangles()) do\n"
      "    sum = sum + det(s:position(t[1]), s:position(t[2]), s:position(t[3])) / 6\n  end\n  return sum\nend\n"
      "local function filled(s, b)\n  local sum = 0\n  for _, t in ipairs(b:tetrahedra()) do\n"
      "    local o = s:position(t[1])\n    sum = sum + det(minus(s:position(t[2]), o), minus(s:position(t[3]), o), "
      "minus(s:position(t[4]), o)) / 6\n  end\n  return sum\nend\n"
      "local function euler(b) return #b:ids() - #b:edges() + #b:triangles() end\n"
      "%s\nscene:measure('m', function(s) return %s end)\nreturn scene\n",
      body, expression);
  test_write("implicit.lua", scene);
  test_hooke(&r, NULL, "run implicit.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

static void near(double found, double expected, double within) {
  if (!(fabs(found - expected) <= within)) fail_msg("%.17g, expected %.17g", found, expected);
}

static double ball_with(const char *more, const char *expression) {
  char body[512];
  snprintf(body, sizeof body,
           "local b = scene:implicit { %s, %s }\nlocal low = scene:within({ -2, -2, -2 }, { 2, 2, -0.5 })", ball, more);
  return measured(body, expression);
}

/* Facets of 0.1 m are 0.5 % of the volume short: order 2, as validation measures. */
static void a_formula_gives_a_closed_body(void **state) {
  (void)state;
  const char *const methods[] = {"method = 'tetrahedra', mass = 1", "method = 'cubes', mass = 1"};
  for (int k = 0; k < 2; k++) {
    near(ball_with(methods[k], "volume(s, b)"), 4.18879, 0.03);
    assert_true(ball_with(methods[k], "euler(b)") == 2);
    near(ball_with(methods[k], "#s:position(b:ids()[7])"), 3, 0);
  }
  near(ball_with("mass = 1, position = { 5, 0, 0 }", "s:position(b:ids()[1])[1]"), 5, 1.1);
}

/* Beside the coarse corners, a search asks for those of a layer of blocks, and four times a vertex. */
static void a_function_is_called_near_the_surface(void **state) {
  (void)state;
  static const char *const fine =
      "scene:particle {}\nlocal b = scene:implicit { f = function(x, y, z) calls = calls + 1 return 1 - x*x - "
      "y*y - z*z end, method = 'cubes', as = 'surface', size = 0.04, "
      "box = { { -1.3, -1.3, -1.3 }, { 1.3, 1.3, 1.3 } } }";
  double vertices = measured(fine, "#b.vertices / 3"), calls = measured(fine, "calls");
  double corners = 66.0 * 66 * 66, coarse = 34.0 * 34 * 34;
  assert_true(vertices > 10000 && calls > 4 * vertices);
  assert_true(calls - 4 * vertices - coarse < 0.4 * corners);
}

static void a_solid_is_filled(void **state) {
  (void)state;
  near(ball_with("as = 'solid', density = 1000", "filled(s, b)"), 4.18879, 0.03);
  near(ball_with("as = 'solid', density = 1000", "filled(s, b) - volume(s, b)"), 0,
       1e-11); /* rounding of 24,000 parts */
  near(ball_with("as = 'solid', density = 1000, E = 1e5", "b.stiffness[1] > 0 and 1 or 0"), 1, 0);
}

static void metaballs_and_joined_shapes(void **state) {
  (void)state;
  const char *two = "local b = scene:implicit { blobs = { { 0, 0, 0, radius = 0.5 }, { 0.6, 0, 0, radius = 0.5 } }, "
                    "size = 0.05, mass = 1 }";
  near(measured("local b = scene:implicit { blobs = { { 0, 0, 0, radius = 0.5 } }, size = 0.05, mass = 1 }",
                "volume(s, b)"),
       4.18879 / 8, 0.006);
  assert_true(measured(two, "euler(b)") == 2 && measured(two, "volume(s, b)") > 4.18879 / 4);
  const char *shell = "local b = scene:implicit { difference = { { f = function(x, y, z) return x*x + y*y + z*z end, "
                      "level = 1, inside = 'below' }, { blobs = { { 0, 0, 0, radius = 0.5 } } } }, size = 0.1, "
                      "box = { { -1.3, -1.3, -1.3 }, { 1.3, 1.3, 1.3 } }, mass = 1 }";
  assert_true(measured(shell, "euler(b)") == 4); /* two spheres */
  near(measured(shell, "volume(s, b)"), 4.18879 * 7 / 8, 0.04);
}

/* The box of 1 m below a wave, closed along its faces: no triangle is without area, contact takes it, and as a solid it
 * is filled up to the faces. The 10 m of
 * edges lose 1/8 of a cell's square each. */
static void a_wall_closes_what_leaves_the_box(void **state) {
  (void)state;
  static const char *const shape = "local b = scene:implicit { f = function(x, y, z) return 0.5 - z + 0.05 * "
                                   "math.sin(2 * math.pi * x) end, close = true, size = 0.1, box = { { 0, 0, 0 }, "
                                   "{ 1, 1, 1 } }, %s }";
  char body[1024];
  for (int k = 0; k < 3; k++) {
    const char *as[] = {"method = 'tetrahedra', mass = 1", "method = 'cubes', mass = 1", "as = 'solid', density = 1"};
    snprintf(body, sizeof body, shape, as[k]);
    near(measured(body, "volume(s, b)"), 0.5, 0.016);
    assert_true(k == 2 || measured(body, "euler(b)") == 2);
  }
  near(measured(body, "filled(s, b)"), 0.5, 0.016);
  snprintf(body, sizeof body, shape, "method = 'tetrahedra'");
  strcat(body,
         "\nscene:mesh { vertices = { { 0.5, 0.5, 0.9 }, { 0.6, 0.5, 0.9 }, { 0.5, 0.6, 0.9 } }, faces = { { 1, 2, "
         "3 } }, mass = 1 }\nscene:corrector('contact', { thickness = 1e-3 })");
  assert_true(measured(body, "#b:triangles()") > 1000);
  const char *blob =
      "local b = scene:implicit { blobs = { { 0, 0, 0, radius = 0.5 } }, close = true, size = 0.05, mass = "
      "1, box = { { 0, -1, -1 }, { 1, 1, 1 } } }";
  near(measured(blob, "volume(s, b)"), 4.18879 / 16, 0.004);
}

/* The particles of a layer of a solid, all of them and no others. */
static void particles_in_a_box_are_found(void **state) {
  (void)state;
  near(ball_with(
           "as = 'solid', density = 1000",
           "(function() local n = 0 for _, i in ipairs(low) do if s:position(i)[3] "
           "> -0.5 then n = n + 1000 end end for _, i in ipairs(b:ids()) do if s:position(i)[3] <= -0.5 then n = n "
           "+ 1 end end return n - #low end)()"),
       0, 0);
  test_refused("local scene = hooke.scene { duration = 0 }\nscene:within({ 0, 0, 1 }, { 1, 1, 0 })\n", "", 1,
               "within: from 1 m to 0 m along z: the first corner has to be the lower one");
}

static void refused(const char *body, const char *text) {
  char scene[1024];
  snprintf(scene, sizeof scene, "local scene = hooke.scene { duration = 0 }\nscene:implicit { %s }\nreturn scene\n",
           body);
  test_refused(scene, "", 1, text);
}

#define BOX "size = 0.1, box = { { -1, -1, -1 }, { 1, 1, 1 } }"

static void functions_that_give_no_value_are_named(void **state) {
  (void)state;
  refused("f = function(x, y, z) return x > 0.45 and 0/0 or 0.5 - x*x end, " BOX,
          "implicit: f gives nan at (0.5, -1, -1)");
  refused("f = function(x, y, z) end, " BOX, "implicit: f gives nothing at (-1, -1, -1): it has to return a number");
  refused("f = function(x, y, z) return x.y end, " BOX, "f at (-1, -1, -1): bad.lua:2: attempt to index");
  refused("f = function(x, y, z) while true do end end, " BOX, "is there an endless loop?");
  refused("f = 3, " BOX, "implicit: f: expected a function");
}

static void surfaces_that_are_not_there_are_said(void **state) {
  (void)state;
  refused("f = function(x, y, z) return 0.25 - x*x end, level = 8, " BOX,
          "no surface in the box: the field is from -8.75 to -7.75 on the grid and the level 0");
  refused("f = function(x, y, z) return 2 - x*x - y*y - z*z end, " BOX, "the surface leaves the box: at (");
  refused("f = function(x, y, z) return x*x + y*y + z*z - 0.5 end, " BOX, "inside = \"below\" turns it round");
  refused("f = function(x, y, z) return 2 - x*x - y*y - z*z end, as = 'solid', " BOX, "the surface leaves the box, or");
  refused("f = function(x, y, z) return x end, size = 1e-6, box = { { 0, 0, 0 }, { 1, 1, 1 } }",
          "MB are allowed: take a larger spacing or a smaller box");
  refused("f = function(x, y, z) return x end, size = 1e-3, as = 'solid', box = { { 0, 0, 0 }, { 1, 1, 1 } }",
          "a lattice of 2.01e+09 points: take a larger cell");
}

static void what_a_script_may_get_wrong_is_said(void **state) {
  (void)state;
  refused(BOX, "a shape is required: f = function");
  refused("blobs = { { 0, 0, 0 } }, size = 0.1", "implicit: blobs[1]: radius is required, in m");
  refused("blobs = { { 0, 0, 0, radius = -1 } }, size = 0.1", "blobs[1]: radius: -1 m has to be above 0");
  refused("blobs = { { 0, 0, 0, radius = 1, rad = 1 } }, size = 0.1", "blobs[1]: there is no 'rad'");
  refused("blobs = {}, size = 0.1", "implicit: blobs: there are none");
  refused("blobs = { { 0, 0, 0, radius = 1 } }, f = print, size = 0.1", "f and blobs: a shape has one of them");
  refused("blobs = { { 0, 0, 0, radius = 1 } }, level = 1, size = 0.1", "level: it has no meaning beside blobs");
  refused("blobs = { { 0, 0, 0, radius = 1 } }", "implicit: size is required");
  refused("blobs = { { 0, 0, 0, radius = 1 } }, size = 0", "implicit: size: 0 m has to be above 0");
  refused("blobs = { { 0, 0, 0, radius = 1 } }, size = 0.1, method = 'cube'", "expected \"tetrahedra\" or \"cubes\"");
  refused("blobs = { { 0, 0, 0, radius = 1 } }, size = 0.1, as = 'solid', path = print", "unknown key 'path'");
  refused("f = function() return 1 end, size = 0.1", "implicit: box is required where a function");
  refused("f = function() return 1 end, size = 0.1, box = { { 0, 0, 1 }, { 1, 1, 0 } }", "from 1 m to 0 m along z");
  refused("union = { 3 }, " BOX, "implicit: union[1]: expected a shape");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_formula_gives_a_closed_body),
                                     cmocka_unit_test(a_function_is_called_near_the_surface),
                                     cmocka_unit_test(a_solid_is_filled),
                                     cmocka_unit_test(metaballs_and_joined_shapes),
                                     cmocka_unit_test(particles_in_a_box_are_found),
                                     cmocka_unit_test(a_wall_closes_what_leaves_the_box),
                                     cmocka_unit_test(functions_that_give_no_value_are_named),
                                     cmocka_unit_test(surfaces_that_are_not_there_are_said),
                                     cmocka_unit_test(what_a_script_may_get_wrong_is_said)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
