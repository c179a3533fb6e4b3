/* Bodies: closed surfaces that face outwards, as near to round shapes as they say, pinned and moved, or free. */
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

/* What a script can say of a body b in the state s: */
static const char *const library =
    "local function cross(a, b) return { a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * "
    "b[1] } end\n"
    "local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end\n"
    "local function minus(a, b) return { a[1] - b[1], a[2] - b[2], a[3] - b[3] } end\n"
    "local function corners(s, t) return s:position(t[1]), s:position(t[2]), s:position(t[3]) end\n"
    "function volume(s, b)\n  local sum = 0\n  for _, t in ipairs(b:triangles()) do\n"
    "    local p, q, r = corners(s, t)\n    sum = sum + dot(p, cross(q, r)) / 6\n  end\n  return sum\nend\n"
    "function euler(b) return #b:ids() - #b:edges() + #b:triangles() end\n"
    /* the least and the largest distance from c of a triangle's plane and of a vertex */
    "function inner(s, b, c)\n  local least = math.huge\n  for _, t in ipairs(b:triangles()) do\n"
    "    local p, q, r = corners(s, t)\n    local n = cross(minus(q, p), minus(r, p))\n"
    "    least = math.min(least, dot(minus(p, c), n) / math.sqrt(dot(n, n)))\n  end\n  return least\nend\n"
    "function outer(s, b, c)\n  local most = 0\n  for _, i in ipairs(b:ids()) do\n"
    "    local d = minus(s:position(i), c)\n    most = math.max(most, math.sqrt(dot(d, d)))\n  end\n  return "
    "most\nend\n";

static double measured(const char *body, const char *expression) {
  static char scene[8192];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0 }\n%s%s\nscene:measure('m', function(s) return %s end)\n"
           "return scene\n",
           library, body, expression);
  test_write("body.lua", scene);
  test_hooke(&r, NULL, "run body.lua --json --quiet --trust");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

static void near(double found, double expected, double within) {
  if (!(fabs(found - expected) <= within)) fail_msg("%.17g, expected %.17g", found, expected);
}

/* Inscribed: vertices on the sphere, facets no deeper than detail, and no finer than that needs by a third. */
static void a_sphere_is_as_round_as_it_says(void **state) {
  (void)state;
  const double details[] = {0.05, 1e-2, 1e-3};
  for (int k = 0; k < 3; k++) {
    char body[256];
    snprintf(body, sizeof body,
             "local b = scene:body { shape = 'sphere', radius = 2, position = {1, 2, 3}, detail = %g }", details[k]);
    double depth = 1 - measured(body, "inner(s, b, {1, 2, 3})") / 2;
    assert_true(depth <= details[k] && depth > details[k] / 1.8); /* whole rings: three and four at 0.05 */
    near(measured(body, "outer(s, b, {1, 2, 3})"), 2, 1e-14);
    assert_true(measured(body, "euler(b)") == 2);
  }
  near(1 - measured("local b = scene:body { shape = 'sphere', radius = 1 }", "inner(s, b, {0, 0, 0})"), 1e-3, 2e-4);
}

/* Volumes of the true shapes: inscribed ones have less, by no more than twice the detail. */
static void surfaces_are_closed_and_face_outwards(void **state) {
  const double pi = 3.141592653589793;
  const struct {
    const char *shape;
    double volume;
  } bodies[] = {{"shape = 'sphere', radius = 0.5", pi / 6},
                {"shape = 'capsule', radius = 0.5, length = 1", pi / 6 + pi / 4},
                {"shape = 'cylinder', radius = 0.5, length = 0.3", pi / 4 * 0.3},
                {"shape = 'cylinder', radius = 0.5, length = 9, orientation = {0.3, 1, 2}", pi / 4 * 9}};
  (void)state;
  for (size_t k = 0; k < sizeof bodies / sizeof *bodies; k++) {
    char body[256];
    snprintf(body, sizeof body, "local b = scene:body { %s, position = {1, 0, 2}, detail = 0.01 }", bodies[k].shape);
    double volume = measured(body, "volume(s, b)");
    assert_true(volume < bodies[k].volume && volume > bodies[k].volume * (1 - 3 * 0.01));
    assert_true(measured(body, "euler(b)") == 2);
  }
  near(measured("local b = scene:body { shape = 'box', size = {1, 2, 0.5}, orientation = {1, 1, 0} }", "volume(s, b)"),
       1, 1e-14);
  near(measured("local b = scene:body { shape = 'box', size = 2 }", "volume(s, b) + euler(b)"), 10, 1e-14);
  near(measured("local b = scene:body { shape = 'plane', size = 3, position = {0, 0, 1} }", "volume(s, b) + euler(b)"),
       9.0 / 3 + 1, 1e-14); /* the pyramid below it, with its normal upwards */
}

static void a_mesh_is_scaled_turned_and_moved(void **state) {
  (void)state;
  test_write("rock.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const char *body = "local b = scene:body { shape = 'mesh', file = 'rock.obj', scale = 2, position = {0, 0, 1},\n"
                     "  orientation = {0, 0, math.pi / 2} }";
  near(measured(body, "s:position(b:at(2))[2]"), 2, 1e-15);
  near(measured(body, "s:position(b:at(3))[1]"), -2, 1e-15);
  near(measured(body, "volume(s, b)"), 8.0 / 6, 1e-14);
}

/* It turns about its position, also where that is not the middle of its vertices; it weighs nothing. */
static void a_body_moves_as_its_path_and_rotation_say(void **state) {
  (void)state;
  test_write("rock.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  test_write("moves.lua",
             "local scene = hooke.scene { duration = 1, dt = 0.1, integrator = 'leapfrog' }\n"
             "scene:force('gravity')\n"
             "local b = scene:body { shape = 'mesh', file = 'rock.obj', position = {5, 0, 0},\n"
             "  path = function(t) return 0, 0, t end, rotation = function(t) return 0, 0, t * math.pi / 2 end }\n"
             "scene:measure('m', function(s) local x = s:position(b:at(2))\n"
             "  return math.abs(x[1] - 5) + math.abs(x[2] - 1) + math.abs(x[3] - 1) + s:mass(b:at(2)) end)\n"
             "return scene\n");
  test_hooke(&r, NULL, "run moves.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  near(test_json(r.out, "m"), 0, 1e-14);
}

static void one_with_a_mass_is_free(void **state) {
  (void)state;
  const char *body = "local b = scene:body { shape = 'box', size = 1, density = 3 }"; /* kg/m^2: the surface is 6 m^2 */
  near(measured(body, "(function() local sum = 0; for _, i in ipairs(b:ids()) do sum = sum + s:mass(i) end; return sum "
                      "end)()"),
       18, 1e-14);
}

#define BODY(text) "local scene = hooke.scene {}\nscene:body { " text " }\nreturn scene\n"

static void bodies_that_cannot_be_are_refused(void **state) {
  (void)state;
  test_refused(BODY("shape = 'spere', radius = 1"), "", 1,
               "bad.lua:2: body: shape: there is no 'spere'; did you mean 'sphere'?");
  test_refused(BODY("radius = 1"), "", 1, "body: shape: expected sphere, box, capsule, cylinder, plane or mesh");
  test_refused(BODY("shape = 'sphere'"), "", 1, "body: radius: a length in m above 0 has to be given");
  test_refused(BODY("shape = 'sphere', radius = -1"), "", 1, "body: radius: a length in m above 0 has to be given");
  test_refused(BODY("shape = 'sphere', radius = 1, length = 2"), "", 1, "body: unknown key 'length'");
  test_refused(BODY("shape = 'sphere', radius = 1, detail = 0"), "", 1, "body: detail: 0 is not from 1e-06 to 0.2");
  test_refused(BODY("shape = 'box', size = { 1, 0, 1 }"), "", 1, "body: size: {1, 0, 1}: lengths have to be above 0");
  test_refused(BODY("shape = 'box', size = 1, mass = 1, path = function(t) return t, 0, 0 end"), "", 1,
               "body: one with a mass is free and has no path");
  test_refused(BODY("shape = 'box', size = 1, rotation = { 1, 0, 0 }"), "", 1,
               "body: rotation: expected a function of t");
  test_refused(BODY("shape = 'mesh', file = 'none.obj'"), "", 4, "none.obj: No such file");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_sphere_is_as_round_as_it_says),   cmocka_unit_test(surfaces_are_closed_and_face_outwards),
      cmocka_unit_test(a_mesh_is_scaled_turned_and_moved), cmocka_unit_test(a_body_moves_as_its_path_and_rotation_say),
      cmocka_unit_test(one_with_a_mass_is_free),           cmocka_unit_test(bodies_that_cannot_be_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
