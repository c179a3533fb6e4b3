/* Closed surfaces for the tests of forces on what they enclose: two octahedra, one of which may lose a corner, and a
 * bipyramid with more particles than full blocks take. */
#ifndef HK_TEST_CLOSED_SURFACES_H
#define HK_TEST_CLOSED_SURFACES_H

#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { PIECES = 2, N = 6 * PIECES, SIZE = 3 * N, FACES = 8, RING = 600 };

static const double VOLUME = 4.0 / 3; /* m^3, of the octahedron |x| + |y| + |z| = 1 m */

/* -1 to 1. */
static inline double noise(void) {
  static uint64_t bits = 1;
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-52 - 1;
}

static inline hk_status open_run(test_engine *e) { return hk_run_open(e->scene, &e->options, &e->run, &e->error); }

/* Corners -x, x, -y, y, -z, z. */
static inline void octahedron(uint32_t first, uint32_t face[FACES][3]) {
  for (uint32_t k = 0; k < FACES; k++) {
    uint32_t x = k & 1, y = 2 + (k >> 1 & 1), z = 4 + (k >> 2);
    bool turned = (x + y + z) % 2 == 0;
    face[k][0] = first + x, face[k][1] = first + (turned ? z : y), face[k][2] = first + (turned ? y : z);
  }
}

/* Two octahedra, at 0 and at (5, 0, 0), the second twice as large, and the force on them. */
static inline hk_plugin_spec *add_octahedra(test_engine *e, const char *force) {
  uint32_t face[PIECES * FACES][3];
  test_engine_open(e);
  for (uint32_t b = 0; b < PIECES; b++) {
    for (int k = 0; k < 6; k++) {
      double at[3] = {0};
      at[k / 2] = (k % 2 ? 1 : -1) * (1.0 + b);
      test_particle(e, 5 * b + at[0], at[1], at[2], 1 + 0.1 * k);
    }
    octahedron(6 * b + 1, face + FACES * b);
  }
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, force);
  test_tuples(e, spec, "triangles", 3, face[0], PIECES * FACES);
  e->options.dt = 1e-3;
  return spec;
}

/* A run of octahedra, and a state of theirs that may be changed. */
typedef struct bodies {
  test_engine e;
  hk_instance *force;
  hk_view view;
  double x[SIZE], v[SIZE];
} bodies;

static inline void run_bodies(bodies *b, const hk_plugin_spec *spec) {
  test_run(&b->e);
  b->force = test_instance(&b->e, spec);
  b->view = force_view(&b->e, b->force);
  memcpy(b->x, b->view.x, sizeof b->x);
  memset(b->v, 0, sizeof b->v);
  b->view.x = b->x, b->view.v = b->v;
}

static inline double energy_of(const bodies *b) { return b->force->plugin->force->energy(b->force->self, &b->view); }

/* Dead is a corner of the first body: it is open and feels nothing, and the other one goes on as before. */
static inline void assert_open_without_a_corner(bodies *b) {
  double F[SIZE], G[SIZE];
  force_evaluate(b->force, &b->view, F);
  uint32_t map[N], id[N];
  for (uint32_t i = 0; i < N; i++) map[i] = i == 2 ? UINT32_MAX : i - (i > 2), id[i] = i + 1 + (i > 1);
  memmove(b->x + 6, b->x + 9, (SIZE - 9) * sizeof *b->x), memmove(b->v + 6, b->v + 9, (SIZE - 9) * sizeof *b->v);
  hk_model model = *b->view.model;
  model.id = id, model.n = b->view.n = b->view.acting = N - 1, b->view.model = &model;
  assert_int_equal(hk_instance_remap(b->force, map, N, &b->view, 6 * N - 5, &b->e.error), HK_OK);
  force_evaluate(b->force, &b->view, G);
  for (int q = 0; q < 3 * 5; q++) assert_true(G[q] == 0);
  for (int q = 3 * 5; q < SIZE - 3; q++) assert_true(G[q] == F[q + 3] && F[q + 3] != 0);
}

/* A bipyramid of RING corners and two tips, and the force on it. */
static inline hk_plugin_spec *add_bipyramid(test_engine *e, const char *force) {
  static uint32_t face[2 * RING][3];
  test_engine_open(e);
  for (int k = 0; k < RING; k++) test_particle(e, cos(k * 6.28 / RING), sin(k * 6.28 / RING), 0, 1);
  test_particle(e, 0, 0, 1, 1), test_particle(e, 0, 0, -1, 1);
  for (uint32_t k = 0; k < RING; k++) {
    uint32_t next = (k + 1) % RING + 1;
    memcpy(face[2 * k], (uint32_t[]){k + 1, next, RING + 1}, sizeof *face);
    memcpy(face[2 * k + 1], (uint32_t[]){next, k + 1, RING + 2}, sizeof *face);
  }
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, force);
  test_tuples(e, spec, "triangles", 3, face[0], 2 * RING);
  return spec;
}

/* Two steps; refused: what the error says, or NULL. */
static inline void assert_steps(test_engine *e, bool implicit, const char *refused) {
  test_plugin(e, HK_INTEGRATOR, implicit ? "backward_euler" : "leapfrog");
  e->options.dt = 1e-3;
  test_run(e);
  hk_status status = hk_run_advance(e->run, 2e-3, &e->error);
  assert_int_equal(status, refused ? HK_BAD_PARAM : HK_OK);
  if (refused) assert_non_null(strstr(e->error.text, refused));
  test_engine_close(e);
}

/* Of a scene that `open` makes, each allocation of the start may fail. */
static inline void assert_no_memory_is_an_error(void (*open)(test_engine *)) {
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    open(&e);
    e.options.allocations = k + 1;
    hk_status status = open_run(&e);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 20);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

#endif
