/* See element_scenes.h. */
#include "tests/support/element_scenes.h"

#include <string.h>

enum { MOST = 24 * 4096 };

static uint64_t bits = 1;

double elements_noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

void elements_open(test_engine *e, double h) {
  test_engine_open(e);
  bits = 1;
  e->scene->fps = 1 / h;
  e->options.dt = h;
  e->options.until = 10;
}

static void particle(test_engine *e, double x, double y, double z, double rough) {
  uint32_t id = test_particle(e, x + rough * elements_noise(), y + rough * elements_noise(),
                              z + rough * elements_noise(), 0.02 * (1 + elements_noise()));
  for (int c = 0; c < 3; c++) e->scene->particles.velocity[3 * (id - 1) + (size_t)c] = 20 * rough * elements_noise();
}

/* ---- a sheet of triangles with struts along its sides ---- */

typedef struct sheet {
  size_t triangles, edges;
  uint32_t triangle[MOST], edge[MOST];
} sheet;

static sheet paper;

static void add_edge(uint32_t i, uint32_t j) {
  paper.edge[2 * paper.edges] = i;
  paper.edge[2 * paper.edges++ + 1] = j;
}

hk_plugin_spec *elements_sheet(test_engine *e, uint32_t side, double rough) {
  paper.triangles = paper.edges = 0;
  for (uint32_t q = 0; q < side * side; q++) particle(e, 0.1 * (q % side), 0.1 * (q / side), 0, rough);
  for (uint32_t j = 0; j < side; j++)
    for (uint32_t i = 0; i < side; i++) {
      uint32_t a = j * side + i + 1, *t = paper.triangle + 3 * paper.triangles;
      if (i + 1 < side) add_edge(a, a + 1);
      if (j + 1 < side) add_edge(a, a + side);
      if (i + 1 == side || j + 1 == side) continue;
      memcpy(t, (uint32_t[]){a, a + 1, a + side + 1, a, a + side + 1, a + side}, 6 * sizeof *t);
      paper.triangles += 2;
    }
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "fixture:area_springs");
  test_tuples(e, force, "triangles", 3, paper.triangle, paper.triangles);
  test_tuples(e, force, "edges", 2, paper.edge, paper.edges);
  return force;
}

void elements_stiffen(test_engine *e, hk_plugin_spec *force, double k, double damping, double edge_k) {
  test_number(e, force, "k", k);
  test_number(e, force, "damping", damping);
  test_number(e, force, "edge_k", edge_k);
}

/* ---- a blob: a cube of cells, six tetrahedra around the diagonal of each ---- */

static uint32_t tetrahedron[MOST];

static size_t list_tetrahedra(uint32_t side) {
  static const int way[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const uint32_t step[3] = {1, side, side * side};
  size_t count = 0;
  for (uint32_t q = 0; q < side * side * side; q++) {
    if (q % side + 1 == side || q / side % side + 1 == side || q / side / side + 1 == side) continue;
    for (int w = 0; w < 6; w++, count++) {
      uint32_t *t = tetrahedron + 4 * count;
      t[0] = q + 1;
      for (int m = 0; m < 3; m++) t[m + 1] = t[m] + step[way[w][m]];
    }
  }
  return count;
}

/* `swelling`: rest volumes over those of the cube. */
hk_plugin_spec *elements_blob(test_engine *e, uint32_t side, double rough, double swelling, double k, double damping) {
  static double rest[MOST / 4];
  for (uint32_t q = 0; q < side * side * side; q++)
    particle(e, 0.1 * (q % side), 0.1 * (q / side % side), 0.1 * (q / side / side), rough);
  size_t count = list_tetrahedra(side);
  for (size_t t = 0; t < count; t++) rest[t] = (t % 6 < 3 ? 1 : -1) * swelling * 1e-3 / 6;
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "fixture:volume_springs");
  test_tuples(e, force, "tetrahedra", 4, tetrahedron, count);
  test_list(e, force, "rest", rest, count);
  test_number(e, force, "k", k);
  test_number(e, force, "damping", damping);
  return force;
}

void elements_gravity(test_engine *e) { test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -9.81); }
