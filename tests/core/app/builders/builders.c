/* Builders and edges of the Lua face, through scenes that measure themselves. */
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

/* The value of the measure m in a scene that has `body`. */
static double measured(const char *body, const char *expression) {
  char scene[4096];
  snprintf(
      scene, sizeof scene,
      "local scene = hooke.scene { duration = 0 }\n%s\nscene:measure('m', function(s) return %s end)\nreturn scene\n",
      body, expression);
  test_write("build.lua", scene);
  test_hooke(&r, NULL, "run build.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

static void a_grid_has_the_springs_it_should(void **state) {
  (void)state;
  const char *grid = "local g = scene:grid { nx = 5, ny = 4, width = 2, height = 3, mass = 40, origin = {1, 1, 1} }";
  assert_true(measured(grid, "#g:structural()") == 4 * 4 + 5 * 3);
  assert_true(measured(grid, "#g:shear()") == 2 * 4 * 3);
  assert_true(measured(grid, "#g:flexion()") == 3 * 4 + 5 * 2);
  assert_true(measured(grid, "#g:triangles()") == 2 * 4 * 3);
  assert_true(measured(grid, "s:position(g:at(5, 4))[1] * 10 + s:position(g:at(5, 4))[2]") == 34);
  assert_true(measured(grid, "s:mass(g:at(2, 2))") == 2); /* the total is shared equally */
  assert_true(measured(grid, "g:at(2, 3)") == 12);
}

static void edges_mix_with_hand_written_ones(void **state) {
  (void)state;
  const char *body =
      "local a = scene:strand { n = 3, length = 1, mass = 1 }\nlocal b = scene:strand { n = 3, length = 2, mass = 1 }\n"
      "local all = a:edges() .. b:edges() .. {{1, 4}}\n"
      "scene:force('springs', { edges = { all, {3, 6}, b:flexion() }, k = 1, label = 'mixed' })";
  assert_true(measured(body, "#all") == 5);
  assert_true(measured(body, "all[5][1] * 10 + all[5][2]") == 14);
  assert_true(measured(body, "s:strain('mixed')") == 0);
}

static void a_mesh_is_read_with_its_sides_once(void **state) {
  (void)state;
  test_write("square.obj", "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 -1/1\n");
  const char *body = "local m = scene:mesh { file = 'square.obj', mass = 4, scale = 2 }";
  assert_true(measured(body, "#m:edges()") == 5);
  assert_true(measured(body, "#m:triangles()") == 2);
  assert_true(measured(body, "s:position(m:at(3))[2]") == 2);
  test_write("wrong.obj", "v 0 0 0\nv 1 0\n");
  test_refused("local scene = hooke.scene {}\nscene:mesh { file = 'wrong.obj' }\n", "", 4,
               "wrong.obj:2: a vertex needs three numbers");
  test_write("far.obj", "v 0 0 0\nv 1 0 0\nf 1 2 7\n");
  test_refused("local scene = hooke.scene {}\nscene:mesh { file = 'far.obj' }\n", "", 4,
               "far.obj:3: a face names a vertex");
  test_refused("local scene = hooke.scene {}\nscene:mesh { file = 'none.obj' }\n", "", 4, "none.obj: No such file");
}

/* A tetrahedron as an obstacle: its numbers, and, with a face missing, the file and the edges. */
static void a_surface_gives_its_numbers(void **state) {
  (void)state;
  test_write("rock.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  test_write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
  const char *body =
      "local m = scene:surface { file = 'rock.obj', scale = 2, origin = { 1, 1, 1 } }\n"
      "scene:particle { position = { 1.3, 1.3, 5 }, velocity = { 0, 0, -10 }, mass = 1 }\n"
      "scene:corrector('obstacle', { shape = 'mesh', vertices = m.vertices, faces = m.faces, file = m.file })";
  assert_true(measured(body, "#m.vertices") == 12 && measured(body, "#m.faces") == 12);
  assert_true(measured(body, "m.vertices[12]") == 3 && measured(body, "m.faces[2]") == 3);
  assert_true(measured(body, "m.file == 'rock.obj' and s.n") == 1); /* no vertex became a particle */
  test_refused(
      "local scene = hooke.scene {}\nscene:particle {}\nlocal m = scene:surface { file = 'open.obj' }\n"
      "scene:corrector('obstacle', { shape = 'mesh', vertices = m.vertices, faces = m.faces, file = m.file })\n"
      "return scene\n",
      "", 1, "open.obj is not closed, so it has no inside: 3 edges, between vertices 1-3 (1 face)");
}

static void places_outside_are_refused(void **state) {
  (void)state;
  test_refused("local scene = hooke.scene {}\nlocal g = scene:grid { nx = 2, ny = 2 }\nprint(g:at(3, 1))\n", "", 1,
               "bad.lua:3: at(3, 1) is outside the grid of 2 x 2");
  test_refused("local scene = hooke.scene {}\nscene:grid { nx = 2.5, ny = 2 }\n", "", 1,
               "nx: 2.5 is not a whole number");
}

static void groups_and_lists_choose_whom_a_force_acts_on(void **state) {
  (void)state;
  const char *body = "local a = scene:particle { mass = 1, group = 'light' }\nlocal b = scene:particle { mass = 1 }\n"
                     "scene:force('gravity', { g = {0, 0, -8}, group = 'light', label = 'g' })\n"
                     "scene:force('gravity', { g = {4, 0, 0}, only = { b }, label = 'h' })";
  assert_true(measured(body, "s:force('g', a)[3]") == -8);
  assert_true(measured(body, "s:force('g', b)[3]") == 0);
  assert_true(measured(body, "s:force('h', a)[1] * 10 + s:force('h', b)[1]") == 4);
}

/* Twice the same scene, once in one go and once driven in two pieces that end on a frame: the same bits. */
static void a_script_may_drive(void **state) {
  (void)state;
  test_write(
      "drive.lua",
      "local scene = hooke.scene { duration = 1 }\nlocal p = scene:particle { mass = 1 }\nscene:force('gravity')\n"
      "local run = scene:run { to = 0.5 }\nassert(run:state().t == 0.5)\nrun = scene:run {}\n"
      "assert(math.abs(run:state():position(p)[3] + 9.81 / 2) < 1e-12)\nassert(run:summary().steps == 60)\n");
  test_hooke(&r, NULL, "run drive.lua --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_grid_has_the_springs_it_should),
      cmocka_unit_test(edges_mix_with_hand_written_ones),
      cmocka_unit_test(a_mesh_is_read_with_its_sides_once),
      cmocka_unit_test(a_surface_gives_its_numbers),
      cmocka_unit_test(places_outside_are_refused),
      cmocka_unit_test(groups_and_lists_choose_whom_a_force_acts_on),
      cmocka_unit_test(a_script_may_drive),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
