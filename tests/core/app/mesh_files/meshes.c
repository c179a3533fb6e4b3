/* Meshes by hand and from OBJ files, whole and damaged; cloth from material numbers. */
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

/* The value of the measure m in a scene that has `body`. */
static double measured(const char *body, const char *expression) {
  char scene[4096];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0 }\n%s\nscene:measure('m', function(s) return %s end)\n"
           "return scene\n",
           body, expression);
  test_write("mesh.lua", scene);
  test_hooke(&r, NULL, "run mesh.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

#define MESH "local scene = hooke.scene {}\nscene:mesh { file = 'bad.obj' }\n"

/* Three vertices, then the line. */
static void refused_line(const char *line, const char *text) {
  char file[512], expected[512];
  snprintf(file, sizeof file, "v 0 0 0\nv 1 0 0\nv 0 1 0\n%s\n", line);
  snprintf(expected, sizeof expected, "bad.lua:2: mesh: bad.obj:4: %s", text);
  test_write("bad.obj", file);
  test_refused(MESH, "", 4, expected);
}

static void damaged_files_are_refused_with_their_line(void **state) {
  (void)state;
  refused_line("f 1 2 -4", "a face names a vertex that does not exist (yet)");
  refused_line("f 1 2 0", "a face names a vertex that does not exist (yet)");
  refused_line("f 1 2 99999999999999999999", "a face names a vertex that does not exist (yet)");
  refused_line("f 1 2 -99999999999999999999", "a face names a vertex that does not exist (yet)");
  refused_line("f 1 2 2.5", "a face has a corner that is no whole number");
  refused_line("f 1 2 3 x", "a face has a corner that is no whole number");
  refused_line("f 1 2", "a face needs three corners");
  refused_line("f 1 2 1", "a face names a vertex twice");
  refused_line("v 1 2", "a vertex needs three numbers");
  refused_line("v 1 2 nan", "a vertex needs three numbers");
}

/* A line as long as the file, of 16 MB here, and zero bytes. */
static void lines_without_end_are_refused(void **state) {
  (void)state;
  enum { SIZE = 1 << 24 };
  char *text = malloc(SIZE);
  memset(text, 'f', SIZE);
  memcpy(text, "v 0 0 0\n", 8);
  text[SIZE - 1] = 0;
  test_write("bad.obj", text);
  test_refused(MESH, "", 4, "mesh: bad.obj:2: the line is longer than 16383 characters");
  memset(text + 8, '#', SIZE - 9);
  test_write("bad.obj", text);
  test_refused(MESH "error('read')", "", 1, "read"); /* a comment may be as long as it likes */
  free(text);
}

static void records_go_on_and_count_from_the_end(void **state) {
  (void)state;
  test_write("good.obj", "v 0 0 0\r\nv 1 0 \\\r\n 0\r\nv 1 1 0\nv 0 1 0\nf -4/1 -3//2 \\\n -2/1/2 \\\n -1\n");
  assert_true(measured("local m = scene:mesh { file = 'good.obj' }", "#m:triangles() * 10 + #m:edges()") == 25);
}

/* An arrow head: the fan around its first corner would fold over. The area of the triangles is that of the face. */
static void concave_faces_are_cut_within(void **state) {
  (void)state;
  const char *arrow = "local m = scene:mesh { density = 1, vertices = { {0,0,0}, {2,0,0}, {0.5,0.5,0}, {0,2,0} },\n"
                      "  faces = { {%s} } }\n"
                      "local function mass(s) local sum = 0 for i = 1, 4 do sum = sum + s:mass(i) end return sum end";
  static const char *const turns[] = {"1,2,3,4", "2,3,4,1", "3,4,1,2", "4,3,2,1"};
  for (int k = 0; k < 4; k++) {
    char body[1024];
    snprintf(body, sizeof body, arrow, turns[k]);
    assert_true(fabs(measured(body, "mass(s)") - 1) < 1e-15);
    assert_true(measured(body, "#m:triangles()") == 2);
  }
  test_refused("local scene = hooke.scene {}\n"
               "scene:mesh { vertices = { {0,0,0}, {1,1,0}, {1,0,0}, {0,1,0} }, faces = { {1, 2, 3, 4} } }\n",
               "", 1, "mesh: faces[1]: a face of more than three corners crosses itself or has no area");
}

static void meshes_by_hand_are_checked(void **state) {
  (void)state;
  test_refused("local scene = hooke.scene {}\nscene:mesh { vertices = { {0,0,0}, {1,0,0} }, faces = { {1, 2, 3} } }\n",
               "", 1, "mesh: faces[1]: corner 3 is none of the vertices 1 to 2");
  test_refused("local scene = hooke.scene {}\nscene:mesh { vertices = { {0,0} } }\n", "", 1, "mesh: vertices[1]");
  test_refused("local scene = hooke.scene {}\nscene:mesh { vertices = {} }\n", "", 1, "mesh: vertices: there are none");
  test_refused("local scene = hooke.scene {}\nscene:mesh { mass = 1 }\n", "", 1, "mesh: file is required");
  test_refused("local scene = hooke.scene {}\nscene:mesh { vertices = { {0,0,0} }, density = 1 }\n", "", 1,
               "mesh: density: vertex 1 has no area around it");
  test_refused("local scene = hooke.scene {}\nscene:grid { nx = 2, ny = 2, mass = 1, density = 1 }\n", "", 1,
               "grid: give mass or density, not both");
  test_refused("local scene = hooke.scene {}\nscene:grid { nx = 2, ny = 1, density = 1 }\n", "", 1,
               "grid: density: one row has no area");
}

/* 4 x 3 particles of squares of 1 m: a border particle has half a cell, a corner a quarter. Diagonals turn. */
static void density_is_shared_by_area(void **state) {
  (void)state;
  const char *grid = "local g = scene:grid { nx = 4, ny = 3, width = 3, height = 2, density = 2, alternating = true }\n"
                     "local t = g:triangles()";
  assert_true(measured(grid, "s:mass(1)") == 0.5 && measured(grid, "s:mass(2)") == 1);
  assert_true(measured(grid, "s:mass(6)") == 2 && measured(grid, "s:mass(12)") == 0.5);
  assert_true(measured(grid, "t[1][1] * 100 + t[1][2] * 10 + t[1][3]") == 126); /* 1 2 / 5 6 from 1 to 6 */
  assert_true(measured(grid, "t[3][1] * 100 + t[3][2] * 10 + t[3][3]") == 236); /* 2 3 / 6 7 from 3 to 6 */
}

/* The square lattice: k = Y/(1 + nu) and k_d = nu Y/(1 - nu^2); border sides have half. */
static void a_grid_has_the_elasticity_asked_for(void **state) {
  (void)state;
  const char *grid = "local g = scene:grid { nx = 4, ny = 3, width = 3, height = 2, density = 2 }\n"
                     "local m = scene:membrane(g, { stiffness = 12, nu = 0.5, damping = 3 })";
  assert_true(measured(grid, "#m.edges * 100 + #m.k") == 2929);
  assert_true(measured(grid, "m.k[1]") == 4 && measured(grid, "m.k[4]") == 8);
  assert_true(measured(grid, "m.k[29]") == 8 && measured(grid, "m.damping[4]") == 2);
  test_refused("local scene = hooke.scene {}\nlocal g = scene:grid { nx = 3, ny = 2, width = 4 }\n"
               "scene:membrane(g, { stiffness = 1 })\n",
               "", 1, "cells of 2 m x 1 m can have a Poisson's ratio of 0.25 at most");
  test_refused("local scene = hooke.scene {}\nlocal g = scene:grid { nx = 3, ny = 2, v = { 0.5, 1, 0 } }\n"
               "scene:membrane(g, { stiffness = 1 })\n",
               "", 1, "are not at a right angle");
}

/* Two equilateral triangles of side 1: k = Y sqrt(3)/2 inside, half of it on the border. Squares: 3/4 Y, and half. */
static void a_mesh_has_the_stiffness_asked_for(void **state) {
  (void)state;
  const char *mesh =
      "local h = math.sqrt(3) / 2\n"
      "local g = scene:mesh { vertices = { {0,0,0}, {1,0,0}, {0.5,h,0}, {1.5,h,0} }, faces = { {1,2,3}, {2,4,3} } }\n"
      "local m = scene:membrane(g, { stiffness = 2 / math.sqrt(3) })";
  static const double k[5] = {0.5, 0.5, 1, 0.5, 0.5};
  for (int e = 0; e < 5; e++) {
    char expression[32];
    snprintf(expression, sizeof expression, "m.k[%d]", e + 1);
    assert_true(fabs(measured(mesh, expression) - k[e]) < 1e-14);
  }
  const char *square =
      "local g = scene:mesh { vertices = { {0,0,0}, {3,0,0}, {0,3,0}, {3,3,0} }, faces = { {1,2,4,3} } }\n"
      "local m = scene:membrane(g, { stiffness = 4 })";
  assert_true(fabs(measured(square, "m.k[1]") - 1.5) < 1e-14 && fabs(measured(square, "m.k[3]") - 3) < 1e-14);
  test_refused("local scene = hooke.scene {}\nlocal g = scene:mesh { vertices = { {0,0,0}, {1,0,0}, {0,1,0} }, faces = "
               "{ {1,2,3} } }\n"
               "scene:membrane(g, { stiffness = 1, nu = 0.2 })\n",
               "", 1, "have a Poisson's ratio of 1/3, not 0.2");
  test_refused("local scene = hooke.scene {}\nlocal g = scene:mesh { vertices = { {0,0,0}, {1,0,0}, {0,1,0} }, faces = "
               "{ {1,2,3} } }\n"
               "g:triangles()[1][3] = 7\nscene:membrane(g, { stiffness = 1 })\n",
               "", 1, "triangle 1 is none of the mesh");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(damaged_files_are_refused_with_their_line),
      cmocka_unit_test(lines_without_end_are_refused),
      cmocka_unit_test(records_go_on_and_count_from_the_end),
      cmocka_unit_test(concave_faces_are_cut_within),
      cmocka_unit_test(meshes_by_hand_are_checked),
      cmocka_unit_test(density_is_shared_by_area),
      cmocka_unit_test(a_grid_has_the_elasticity_asked_for),
      cmocka_unit_test(a_mesh_has_the_stiffness_asked_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
