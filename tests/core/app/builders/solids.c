/* Blocks, tetrahedra by hand and from files of Gmsh, whole and damaged; springs from Young's modulus. */
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

/* The value of an expression in a scene that has `body`; `volume(s)` sums over the tetrahedra of b, `enclosed(s)` is
 * that inside its triangles, `elasticity(s, i, j)` the C_iijj of its springs times that. */
static double measured(const char *body, const char *expression) {
  static const char helpers[] =
      "local function side(s, a, b)\n"
      "  local p, q = s:position(a), s:position(b)\n"
      "  return { q[1] - p[1], q[2] - p[2], q[3] - p[3] }\n"
      "end\n"
      "local function det(a, b, c)\n"
      "  return a[1] * (b[2] * c[3] - b[3] * c[2]) + a[2] * (b[3] * c[1] - b[1] * c[3])\n"
      "    + a[3] * (b[1] * c[2] - b[2] * c[1])\n"
      "end\n"
      "local function volume(s)\n"
      "  local sum = 0\n"
      "  for _, t in ipairs(b:tetrahedra()) do\n"
      "    local part = det(side(s, t[1], t[2]), side(s, t[1], t[3]), side(s, t[1], t[4])) / 6\n"
      "    sum = sum + (part > 0 and part or 1e9)\n"
      "  end\n"
      "  return sum\n"
      "end\n"
      "local function enclosed(s)\n"
      "  local sum = 0\n"
      "  for _, t in ipairs(b:triangles()) do\n"
      "    sum = sum + det(s:position(t[1]), s:position(t[2]), s:position(t[3])) / 6\n"
      "  end\n"
      "  return sum\n"
      "end\n"
      "local function elasticity(s, i, j)\n"
      "  local sum, edges = 0, b:edges()\n"
      "  for e = 1, #edges do\n"
      "    local d = side(s, edges[e][1], edges[e][2])\n"
      "    sum = sum + b.stiffness[e] * (d[i] * d[j]) ^ 2 / (d[1] ^ 2 + d[2] ^ 2 + d[3] ^ 2)\n"
      "  end\n"
      "  return sum\n"
      "end\n"
      "local function mass(s)\n"
      "  local sum = 0\n"
      "  for i = 1, s.n do sum = sum + s:mass(i) end\n"
      "  return sum\n"
      "end\n";
  char scene[8192];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0 }\nlocal b\n%s%s\nscene:measure('m', function(s) return %s end)\n"
           "return scene\n",
           helpers, body, expression);
  test_write("solid.lua", scene);
  test_hooke(&r, NULL, "run solid.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

#define BLOCK                                                                                                          \
  "b = scene:block { nx = 4, ny = 3, nz = 5, size = { 3, 2, 2 }, origin = { 1, 2, 3 }, u = { 0, 2, 0 }, "              \
  "v = { 0, 0, 1 }, density = 10 }"

/* 3 x 2 x 4 cells of five tetrahedra; the skin has 2 (6 + 12 + 8) squares. Its volume is that of the tetrahedra, which
 * all are right-handed; edges by Euler's formula V - E + F - T = 1 of a ball. */
static void blocks_are_filled(void **state) {
  (void)state;
  assert_true(measured(BLOCK, "#b:tetrahedra()") == 120);
  assert_true(measured(BLOCK, "#b:triangles()") == 104);
  assert_true(measured(BLOCK, "60 - #b:edges() + (4 * 120 + 104) / 2 - 120") == 1);
  assert_true(fabs(measured(BLOCK, "volume(s)") - 12) < 1e-13);
  assert_true(fabs(measured(BLOCK, "enclosed(s)") - 12) < 1e-12);
  assert_true(fabs(measured(BLOCK, "mass(s)") - 120) < 1e-12);
}

static void blocks_have_places(void **state) {
  (void)state;
  assert_true(measured(BLOCK, "b:at(4, 3, 5)") == 60 && measured(BLOCK, "b:at(2, 1, 3)") == 26);
  assert_true(measured(BLOCK, "s:position(b:at(1, 1, 3))[1]") == 2); /* u = y, v = z, and so w = x */
  assert_true(measured(BLOCK, "s:position(b:at(4, 1, 1))[2]") == 5);
  assert_true(measured(BLOCK, "s:position(b:at(1, 3, 1))[3]") == 5);
  test_refused("local scene = hooke.scene {}\nlocal b = scene:block { nx = 2, ny = 3, nz = 4 }\nb:at(1, 1, 5)\n", "", 1,
               "at(1, 1, 5) is outside the block of 2 x 3 x 4");
}

/* E = 5/2 C_xxyy for each pair of axes, C_xxxx = 3 C_xxyy, also where cells are no cubes (1 x 1 x 0.8 m here). */
static void springs_of_blocks_are_isotropic(void **state) {
  (void)state;
  static const double mu = 5 / 2.5;
  for (int i = 1; i <= 3; i++)
    for (int j = 1; j <= i; j++) {
      char expression[64];
      snprintf(expression, sizeof expression, "elasticity(s, %d, %d) / volume(s)", i, j);
      assert_true(fabs(measured("b = scene:block { nx = 4, ny = 3, nz = 5, size = { 3, 2, 3.2 }, density = 1, E = 5 }",
                                expression) -
                       (i == j ? 3 : 1) * mu) < 1e-13);
    }
  test_refused("local scene = hooke.scene {}\nscene:block { nx = 2, ny = 2, nz = 2, size = { 2, 1, 1 }, E = 1 }\n", "",
               1, "cells of 2 m x 1 m x 1 m are too oblong for a stiffness of edges");
}

#define HAND                                                                                                           \
  "b = scene:tetrahedra { vertices = { {0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}, {1,1,1} }, density = 6, E = 7,\n"           \
  "  tetrahedra = { {1, 2, 3, 4}, {2, 3, 4, 5} } }"

/* Volumes 1/6 and 1/3; the second one is given inside out. The trace C_iijj of their springs is 6 E. */
static void tetrahedra_by_hand(void **state) {
  (void)state;
  assert_true(fabs(measured(HAND, "volume(s)") - 0.5) < 1e-15);
  assert_true(fabs(measured(HAND, "enclosed(s)") - 0.5) < 1e-15);
  assert_true(fabs(measured(HAND, "s:mass(1)") - 0.25) < 1e-15 && fabs(measured(HAND, "s:mass(2)") - 0.75) < 1e-15);
  assert_true(measured(HAND, "#b:triangles() * 100 + #b:edges()") == 609);
  assert_true(fabs(measured(HAND, "(elasticity(s,1,1) + elasticity(s,2,2) + elasticity(s,3,3)\n"
                                  "  + 2 * (elasticity(s,1,2) + elasticity(s,1,3) + elasticity(s,2,3))) / volume(s)") -
                   42) < 1e-12);
}

#define CORNERS "vertices = { {0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}, {1,1,1}, {2,2,2} }"

static void refused(const char *tetrahedra, const char *why) {
  char scene[512];
  snprintf(scene, sizeof scene, "local scene = hooke.scene {}\nscene:tetrahedra { " CORNERS ", tetrahedra = { %s } }\n",
           tetrahedra);
  test_refused(scene, "", 1, why);
}

static void what_fills_no_space_is_refused(void **state) {
  (void)state;
  refused("{1, 2, 3, 4}, {2, 3, 4, 9}", "tetrahedra: tetrahedra[2]: corner 4 is none of the vertices 1 to 6");
  refused("{1, 2, 3, 3}", "tetrahedra[1]: a tetrahedron names a vertex twice");
  refused("{1, 2, 3}", "tetrahedra[1]: expected four vertices");
  refused("{1, 5, 6, 2}", "tetrahedra[1]: a tetrahedron has no volume");
  refused("{1, 2, 3, 4}, {4, 2, 3, 1}", "tetrahedra 1 and 2: they overlap");
  refused("{1, 2, 3, 4}, {2, 3, 4, 5}, {2, 3, 4, 6}", "tetrahedra 2 and 3: they overlap");
  test_refused("local scene = hooke.scene {}\nscene:tetrahedra { " CORNERS
               ", tetrahedra = { {1, 2, 3, 4} }, density = 1 }\n",
               "", 1, "density: vertex 5 is part of no tetrahedron");
  refused("", "tetrahedra: there are none");
  test_refused("local scene = hooke.scene {}\nscene:block { nx = 1, ny = 2, nz = 2 }\n", "", 1, "block: nx: 1 is not");
  test_refused("local scene = hooke.scene {}\nscene:block { nx = 1e3, ny = 1e3, nz = 2e3 }\n", "", 1, "than a million");
  test_refused("local scene = hooke.scene {}\nscene:block { nx = 2, ny = 2, nz = 2, v = { 1, 1, 0 } }\n", "", 1,
               "u and v are not at a right angle");
  test_refused("local scene = hooke.scene {}\nscene:grid { nx = 2, ny = 2 }:tetrahedra()\n", "", 1,
               "only what scene:block and scene:tetrahedra made has tetrahedra");
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

#define FILE_OF(nodes, elements)                                                                                       \
  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nany\n$EndComments\n$Nodes\n" nodes                                 \
  "$EndNodes\n$Elements\n" elements "$EndElements\n"
#define FOUR "5\n1 0 0 0\n2 1 0 0\n5 9 9 9\n7 0 1 0\n8 0 0 1\n"
#define LOAD "b = scene:tetrahedra { file = 'good.msh', scale = 2, origin = { 1, 0, 0 }, density = 3 }"

/* A point, a triangle and a tetrahedron; node 5 belongs to nothing. */
static void files_of_gmsh(void **state) {
  (void)state;
  test_write("good.msh", FILE_OF(FOUR, "3\n1 15 2 0 1 5\n2 2 2 0 1 1 2 7\n3 4 2 0 1 1 2 7 8\n"));
  assert_true(measured(LOAD, "s.n * 10 + #b:tetrahedra()") == 41);
  assert_true(fabs(measured(LOAD, "volume(s)") - 8.0 / 6) < 1e-15 && fabs(measured(LOAD, "mass(s)") - 4) < 1e-15);
  assert_true(measured(LOAD, "s:position(2)[1]") == 3);
}

static void refused_file(const char *text, const char *why) {
  test_write("bad.msh", text);
  test_refused("local scene = hooke.scene {}\nscene:tetrahedra { file = 'bad.msh' }\n", "", 4, why);
}

static void damaged_files_are_refused_with_their_line(void **state) {
  (void)state;
  refused_file("$MeshFormat\n4.1 0 8\n", "bad.lua:2: tetrahedra: bad.msh:2: expected version 2.2 of the format");
  refused_file("$MeshFormat\n2.2 1 8\n", "bad.msh:2: the file is binary");
  refused_file(FILE_OF("1\n1 0 0\n", "0\n"), "bad.msh:9: a node needs a number and three coordinates");
  refused_file(FILE_OF("2\n2 0 0 0\n1 0 0 1\n", "0\n"), "bad.msh:10: the numbers of nodes have to rise");
  refused_file(FILE_OF("2\n1 0 0 0\n", "0\n"), "bad.msh:10: the section has not as many records as it says");
  refused_file(FILE_OF("1\n1 0 0 0\n2 0 0 0\n", "0\n"), "bad.msh:10: the section has more records than it says");
  refused_file(FILE_OF("x\n", "0\n"), "bad.msh:8: expected the number of records");
  refused_file(FILE_OF(FOUR, "1\n1 4 1 0 1 2 7 9\n"), "bad.msh:17: a tetrahedron names a node that does not exist");
  refused_file(FILE_OF(FOUR, "1\n1 4 1 0 1 2 7\n"), "bad.msh:17: a tetrahedron needs four nodes");
  refused_file(FILE_OF(FOUR, "1\n1 4 1 0 1 2 7 7\n"), "bad.msh:17: a tetrahedron names a vertex twice");
  refused_file(FILE_OF(FOUR, "1\n1 4 9 0\n"), "bad.msh:17: an element has fewer tags than it says");
  refused_file(FILE_OF(FOUR, "1\n1 4\n"), "bad.msh:17: an element needs a number, a type and the number of its tags");
  refused_file(FILE_OF(FOUR, "1\n1 5 0 1 2 7 8 1 2 7 8\n"), "bad.msh:17: a solid that is no tetrahedron of four nodes");
  refused_file(FILE_OF(FOUR, "1\n1 15 0 1\n"), "it has no tetrahedra");
  refused_file("$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n2\n1 15 0 1\n", "has not as many records as it says");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blocks_are_filled),
      cmocka_unit_test(blocks_have_places),
      cmocka_unit_test(springs_of_blocks_are_isotropic),
      cmocka_unit_test(tetrahedra_by_hand),
      cmocka_unit_test(what_fills_no_space_is_refused),
      cmocka_unit_test(files_of_gmsh),
      cmocka_unit_test(damaged_files_are_refused_with_their_line),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
