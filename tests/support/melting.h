/* Scenes of what melts by the channel `temperature`, K. */
#ifndef TEST_MELTING_H
#define TEST_MELTING_H

#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* All particles are at T at the start. */
static inline void melting_channel(test_engine *e, double T) {
  assert_int_equal(hk_scene_add_channel(e->scene, "temperature", 1, &T, NAN, NULL, &e->error), HK_OK);
}

/* rate: K/s, of all particles. */
static inline void melting_warms(test_engine *e, double rate) {
  hk_plugin_spec *relax = test_plugin(e, HK_FORCE, "relax");
  test_text(e, relax, "channel", "temperature");
  test_number(e, relax, "growth", rate);
}

static inline void melting_follows(test_engine *e, hk_plugin_spec *spec, double softens, double range) {
  test_text(e, spec, "channel", "temperature");
  test_number(e, spec, "softens", softens);
  test_number(e, spec, "range", range);
}

/* The scene is refused when the plugin asks for a channel that is not there. */
static inline void melting_needs_its_channel(test_engine *e, hk_plugin_spec *spec) {
  test_text(e, spec, "channel", "warmth");
  assert_int_equal(hk_run_open(e->scene, &e->options, &e->run, &e->error), HK_BAD_PARAM);
  assert_non_null(strstr(e->error.text, "warmth"));
}

enum { MELTING_SIDE = 5 }; /* particles along a side of a sheet */

static inline uint32_t melting_sheet_at(uint32_t i, uint32_t j) { return MELTING_SIDE * i + j + 1; } /* its id */

/* A square sheet of triangles of 0.1 m in the plane z = 0, a surface of the scene, with the edges of scene:grid; column
 * i is at 230 + 10 i K. It is all of the particles so far. */
static inline hk_plugin_spec *melting_sheet(test_engine *e, const char *force, double softens, double range) {
  uint32_t triangle[2 * MELTING_SIDE * MELTING_SIDE][3], edge[2 * MELTING_SIDE * MELTING_SIDE][2], t = 0, g = 0;
  melting_channel(e, 0);
  for (uint32_t i = 0; i < MELTING_SIDE; i++)
    for (uint32_t j = 0; j < MELTING_SIDE; j++) {
      const double T = 230 + 10 * i;
      uint32_t id = test_particle(e, 0.1 * i, 0.1 * j, 0, 0.01), a = melting_sheet_at(i - 1, j - 1),
               b = a + MELTING_SIDE;
      assert_int_equal(hk_scene_set_channel(e->scene, "temperature", id, &T, 1, &e->error), HK_OK);
      if (i > 0) edge[g][0] = id - MELTING_SIDE, edge[g++][1] = id;
      if (j > 0) edge[g][0] = id - 1, edge[g++][1] = id;
      if (i == 0 || j == 0) continue;
      memcpy(triangle[t++], (uint32_t[]){a, b, id}, sizeof *triangle);
      memcpy(triangle[t++], (uint32_t[]){a, id, a + 1}, sizeof *triangle);
    }
  assert_int_equal(hk_scene_add_triangles(e->scene, t, (const uint32_t(*)[3])triangle, &e->error), HK_OK);
  assert_int_equal(hk_scene_add_edges(e->scene, g, (const uint32_t(*)[2])edge, &e->error), HK_OK);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, force);
  if (strstr(force, "springs"))
    test_edges(e, spec, (const uint32_t(*)[2])edge, g), test_number(e, spec, "k", 40);
  else
    test_tuples(e, spec, "triangles", 3, triangle[0], t), test_number(e, spec, "stiffness", 40);
  melting_follows(e, spec, softens, range);
  return spec;
}

#endif
