/* A box of triangles whose edges, diagonals of its faces among them, are bars, tilted, above a pinned floor: what
 * falls, tips over and comes to rest as a rigid body, for all ways of contact. */
#ifndef HK_TEST_BAR_BOX_H
#define HK_TEST_BAR_BOX_H

#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <stdarg.h>

#include <setjmp.h>

#include <cmocka.h>

static const double bar_box_side = 0.2, bar_box_height = 0.3; /* m, of its centre above the floor */

static inline void bar_box_triangle(test_engine *e, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t triangle[1][3] = {{a, b, c}};
  assert_int_equal(hk_scene_add_triangles(e->scene, 1, triangle, &e->error), HK_OK);
}

/* Particles 1 to 3 are the floor, 4 to 11 the corners, of 0.1 kg in all; gravity pulls. `kind`: of the constraint. */
static inline void bar_box_add(test_engine *e, const char *kind) {
  static const uint32_t face[6][4] = {{4, 6, 7, 5},   {8, 9, 11, 10}, {4, 5, 9, 8},
                                      {6, 10, 11, 7}, {4, 8, 10, 6},  {5, 7, 11, 9}};
  static const uint32_t edge[18][2] = {{4, 5}, {6, 7},  {8, 9},  {10, 11}, {4, 6},  {5, 7}, {8, 10}, {9, 11}, {4, 8},
                                       {5, 9}, {6, 10}, {7, 11}, {4, 7},   {8, 11}, {4, 9}, {6, 11}, {4, 10}, {5, 11}};
  const double c = cos(0.4), s = sin(0.4), h = bar_box_side / 2;
  for (int k = 0; k < 3; k++)
    test_pin(e, HK_PIN_FIXED, test_particle(e, 5 * cos(2.1 * k), 5 * sin(2.1 * k), 0, 1), NULL);
  for (int k = 0; k < 8; k++) {
    double x = k & 1 ? h : -h, y = k & 2 ? h : -h, z = k & 4 ? h : -h, u = c * x - s * z, w = s * x + c * z;
    test_particle(e, u, c * y - s * w, s * y + c * w + bar_box_height, 0.0125);
  }
  bar_box_triangle(e, 1, 2, 3);
  for (int k = 0; k < 6; k++) {
    bar_box_triangle(e, face[k][0], face[k][1], face[k][2]);
    bar_box_triangle(e, face[k][0], face[k][2], face[k][3]);
  }
  test_edges(e, test_plugin(e, HK_CONSTRAINT, kind), edge, 18);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
}

#endif
