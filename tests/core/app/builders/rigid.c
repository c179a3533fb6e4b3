/* scene:rigid: shapes, parts, attitudes and points as a script gives them, and one sentence for what no body is. */
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

static double measured(const char *body, const char *expression) {
  static char scene[4096];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0 }\n%s\nscene:measure('m', function(s) return %s end)\n"
           "return scene\n",
           body, expression);
  test_write("rigid.lua", scene);
  test_hooke(&r, NULL, "run rigid.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

static void near(double found, double expected, double within) {
  if (!(fabs(found - expected) <= within)) fail_msg("%.17g, expected %.17g", found, expected);
}

static void shapes_have_their_mass_and_moments(void **state) {
  const double pi = 3.141592653589793;
  (void)state;
  const char *ball = "local b = scene:rigid { shape = 'sphere', radius = 0.5, density = 12 }";
  near(measured(ball, "b.mass"), 2 * pi, 1e-14);
  near(measured(ball, "b.inertia[1]"), 0.4 * 2 * pi / 4, 1e-14);
  const char *box = "local b = scene:rigid { shape = 'box', size = {1, 2, 3}, mass = 12 }";
  near(measured(box, "b.inertia[1] + 100 * b.inertia[2] + 1e4 * b.inertia[3]"), 5 + 1000 + 13e4, 1e-9);
  const char *disc = "local b = scene:rigid { shape = 'cylinder', radius = 1, length = 1e-3, mass = 2 }";
  near(measured(disc, "b.inertia[3]"), 1, 1e-6);
  const char *plate = "local b = scene:rigid { points = {{1,0,0},{-1,0,0},{0,1,0},{0,-1,0}}, masses = {1, 1, 1, 1} }";
  near(measured(plate, "#b:ids() + b.inertia[3]"), 3 + 4, 1e-14);
  test_write("tet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const char *mesh = "local b = scene:rigid { mesh = 'tet.obj', scale = 2, density = 3, position = {1, 0, 0} }";
  near(measured(mesh, "b.mass + b:position(s)[1]"), 4 + 1.5, 1e-14);
}

static void surfaces_are_points_of_bodies(void **state) {
  (void)state;
  const char *box = "local b = scene:rigid { shape = 'box', size = {1, 2, 3}, mass = 12, position = {0, 0, 1} }\n"
                    "local f = b:surface()\nlocal p = b:surface { {0.5, 0, 0}, {0, 0, 1} }";
  near(measured(box, "#f:triangles() + 100 * #f:edges() + 1e4 * #f:ids()"), 12 + 1800 + 8e4, 0);
  near(measured(box, "math.abs(s:position(f:ids()[1])[3] - 1)"), 1.5, 1e-14);
  near(measured(box, "#p + s:position(p[2])[3]"), 4, 1e-14);
  test_refused("local scene = hooke.scene {}\nscene:rigid { mass = 1, inertia = {1, 1, 1} }:surface()\nreturn scene\n",
               "--quiet", 1, "this body has no triangles: name points of it");
}

/* The faces of a box of 1 x 2 x 3 are a radius of 0.2 further inside. */
static void a_radius_moves_triangles_inwards(void **state) {
  (void)state;
  const char *box =
      "local b = scene:rigid { shape = 'box', size = {1, 2, 3}, mass = 12 }\nlocal f = b:surface { radius = 0.2 }\n"
      "local function far(s, c) local most = 0\nfor _, i in ipairs(f:ids()) do most = math.max(most, "
      "math.abs(s:position(i)[c])) end\nreturn most end";
  near(measured(box, "far(s, 1) + 10 * far(s, 2) + 100 * far(s, 3)"), 0.3 + 8 + 130, 1e-12);
}

static void wrong_radii_are_refused(void **state) {
  (void)state;
  static const struct {
    const char *call, *says;
  } wrong[] = {{"{ radius = 0.5 }", "it is half of the body's least extent or more: make it smaller"},
               {"{ radius = 0 }", "radius: 0 m is not above 0"},
               {"{ radios = 1 }", "did you mean 'radius'?"},
               {"({ {0, 0, 0} }, { radius = 0.1, joined = true })", "joined: 1 point has nothing to be joined with"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char scene[512];
    snprintf(
        scene, sizeof scene,
        "local scene = hooke.scene {}\nscene:rigid { shape = 'box', size = 1, mass = 1 }:surface%s\nreturn scene\n",
        wrong[k].call);
    test_refused(scene, "--quiet", 1, wrong[k].says);
  }
  test_refused(
      "local scene = hooke.scene {}\nscene:rigid { shape = 'sphere', radius = 1, mass = 1 }:surface { radius = "
      "0.1 }\nreturn scene\n",
      "--quiet", 1, "it is for boxes and other bodies with three planes at each corner");
}

static void parts_are_one_body(void **state) {
  (void)state;
  const char *halves =
      "local b = scene:rigid { mass = 8, parts = { { shape = 'box', size = 1, position = {0.5, 0, 0} },"
      " { shape = 'box', size = 1, position = {-0.5, 0, 0}, orientation = {0, 0, math.pi} } } }";
  near(measured(halves, "b.inertia[1]"), 8 * 2 / 12.0, 1e-14);
  near(measured(halves, "b.inertia[3]"), 8 * 5 / 12.0, 1e-14);
}

static void orientations_mean_the_same_in_three_forms(void **state) {
  (void)state;
  const char *forms[] = {"{0, 0, math.pi / 2}", "{math.sqrt(0.5), 0, 0, math.sqrt(0.5)}",
                         "{ {0, -1, 0}, {1, 0, 0}, {0, 0, 1} }"};
  for (int k = 0; k < 3; k++) {
    char body[256];
    snprintf(body, sizeof body,
             "local b = scene:rigid { shape = 'box', size = {1, 2, 3}, mass = 1, orientation = %s }\n"
             "local p = b:point{1, 0, 0}",
             forms[k]);
    near(measured(body, "s:position(p)[2]"), 1, 1e-15);
    near(measured(body, "b:attitude(s)[4]"), sqrt(0.5), 1e-15);
    near(measured(body, "select(2, b:attitude(s))[1][2]"), -1, 1e-15);
  }
}

static void motions_are_read_as_they_were_given(void **state) {
  (void)state;
  const char *body =
      "local b = scene:rigid { mass = 2, inertia = {1, 2, 2.5}, velocity = {1, 2, 3}, spin = {3, 2, 1} }\n"
      "local p = b:point{0, 1, 0}";
  near(measured(body, "b:spin(s)[1] + 10 * b:spin(s)[2] + 100 * b:spin(s)[3]"), 123, 1e-12);
  near(measured(body, "b:momentum(s)[3]"), 6, 1e-14);
  near(measured(body, "b:angular_momentum(s)[2]"), 4, 1e-14);
  near(measured(body, "b:angular_momentum(s, {0, 0, -1})[2]"), 4 + 2, 1e-14); /* r x p = (0, 0, 1) x (2, 4, 6) */
  near(measured(body, "b:energy(s) - s:kinetic()"), 0, 1e-14);
  near(measured(body, "b:energy(s)"), 14 + (9 + 8 + 2.5) / 2, 1e-13);
  near(measured(body, "s:velocity(p)[1] + s:velocity(p)[3]"), 1 - 1 + 3 + 3, 1e-14);
}

static void refused(const char *body, const char *text) {
  char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0 }\nlocal b = scene:rigid { %s }\nreturn scene\n", body);
  test_refused(scene, "--quiet", 1, text);
}

static void what_no_body_is_gets_a_sentence(void **state) {
  (void)state;
  refused("mass = 1, inertia = {1, 1, 3}", "bad.lua:2: rigid: inertia: no body has the moments of inertia 1, 1, 3");
  refused("shape = 'sphere', radius = 1", "rigid: mass, kg, or density, kg/m^3, is required");
  refused("shape = 'sphere', radius = 1, mass = -1", "rigid: mass: -1 kg has to be above 0");
  refused("shape = 'sphere', radius = 0/0, mass = 1", "radius");
  refused("shape = 'sphere', radius = 1, mass = 1, density = 1", "give mass or density, not both");
  refused("shape = 'ball', radius = 1, mass = 1", "rigid: shape: there is no 'ball'");
  refused("shape = 'box', size = 1, radius = 3, mass = 1", "rigid: radius: a box has none");
  refused("shape = 'sphere', radius = 1, length = 3, mass = 1", "rigid: length: a sphere has none");
  refused("shape = 'capsule', radius = 1, length = 3, scale = 2, mass = 1", "rigid: scale: a capsule has none");
  refused("mesh = 'open.obj', size = 3, density = 1", "rigid: size: a mesh has none");
  refused("points = {{0,0,0},{1,0,0}}, masses = {1, 1}, radius = 1", "rigid: radius: a body of points has none");
  refused("mass = 1, inertia = {1, 1, 1}, size = 1", "rigid: size: a body by its inertia alone has none");
  refused("mass = 1, size = 1, parts = { { shape = 'box', size = 1 } }", "rigid: size: a body of parts has none");
  refused("mass = 1, parts = { { shape = 'box', size = 1, radius = 1 } }", "rigid: radius: a box has none");
  refused("shape = 'box', size = 1, mesh = 'open.obj', mass = 1", "shape and mesh both say what the body is");
  refused("mass = 1, shape = 'box', parts = { { shape = 'box', size = 1 } }", "shape and parts both say");
  refused("shape = 'box', size = 0.2, mass = 1, position = {0, 1e300, 0}",
          "rigid: position: {0, 1e+300, 0} m: numbers there are 2.2e+284 m apart");
  refused("shape = 'box', size = 0.2, mass = 1, position = {1e10, 0, 0}", "too coarse for a body that reaches");
  refused("mass = 1", "expected a shape, a mesh, points, parts, or mass and inertia");
  refused("shape = 'box', size = 1, mass = 1, orientation = {1, 1, 0, 0}",
          "has the length 1.414214: divide it by that");
  refused("shape = 'box', size = 1, mass = 1, orientation = {{1,0,0},{0,1,0},{0,0,-1}}", "reflection");
  refused("shape = 'box', size = 1, mass = 1, orientation = {{1,0,0},{0,2,0},{0,0,1}}", "no unit vectors");
  refused("shape = 'box', size = 1, mass = 1, velocity = {0, 0/0, 0}", "velocity");
  refused("points = {{0,0,0}}, masses = {1}", "a body without extent does not turn");
  refused("points = {{0,0,0},{1,0,0}}, masses = {1}", "masses: expected 2 numbers");
  refused("mass = 1, parts = { { shape = 'box', size = 1, mass = 1 }, { shape = 'box', size = 1 } }",
          "1 of 2 have neither mass nor density");
  test_write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
  refused("mesh = 'open.obj', density = 1", "rigid: open.obj: the surface is open: the edge between vertices 1 and 3");
  test_refused("local s = hooke.scene { duration = 0 }\ns:rigid { mesh = 'none.obj', density = 1 }\nreturn s\n",
               "--quiet", 4, "none.obj");
}

static void points_that_a_body_has_not_are_refused(void **state) {
  (void)state;
  refused("mass = 1, inertia = {1, 2, 3} }\nb:point{1, 1, 1", "off the plane that the body is");
  refused("shape = 'box', size = 1, mass = 1 }\nb:point{1e9, 0, 0", "no digits would be left");
  refused("shape = 'box', size = 1, mass = 1 }\nscene:pin { b:point{0, 0, 1} ",
          "is a point of a rigid body and goes where that goes");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shapes_have_their_mass_and_moments),
      cmocka_unit_test(surfaces_are_points_of_bodies),
      cmocka_unit_test(a_radius_moves_triangles_inwards),
      cmocka_unit_test(wrong_radii_are_refused),
      cmocka_unit_test(parts_are_one_body),
      cmocka_unit_test(orientations_mean_the_same_in_three_forms),
      cmocka_unit_test(motions_are_read_as_they_were_given),
      cmocka_unit_test(what_no_body_is_gets_a_sentence),
      cmocka_unit_test(points_that_a_body_has_not_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
