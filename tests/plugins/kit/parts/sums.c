/* Forces that go by parts (part_sums.c, particle_sums.c) in one scene: the pass over blocks is the sum of their own
 * `add`, and neither shows how many threads there are. */
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 96, N = SIDE * SIDE, CELLS = (SIDE - 1) * (SIDE - 1) }; /* nine blocks in three domains */

static uint64_t seed;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

/* Six times the volume of the tetrahedron of four ids. */
static double volume(const double (*x)[3], uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  double m[3][3];
  for (int k = 0; k < 3; k++)
    m[0][k] = x[b - 1][k] - x[a - 1][k], m[1][k] = x[c - 1][k] - x[a - 1][k], m[2][k] = x[d - 1][k] - x[a - 1][k];
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* A crumpled sheet; a tetrahedron on one cell in 17, and a joint on one in five. */
static void add_shapes(test_engine *e, uint32_t (*solid)[4], uint32_t (*joint)[3], size_t count[2]) {
  uint32_t(*triangle)[3] = malloc(2 * CELLS * sizeof *triangle), cell = 0, first;
  double(*x)[3] = malloc(N * sizeof *x);
  for (uint32_t i = 0; i < N; i++)
    for (int c = 0; c < 3; c++) x[i][c] = (c == 0 ? i % SIDE : c == 1 ? i / SIDE : 0) + 0.2 * noise();
  assert_int_equal(hk_scene_add_particles(e->scene, N, x[0], NULL, NULL, 1, 0, &first, &e->error), HK_OK);
  for (uint32_t i = 0; i < N - SIDE; i++) {
    uint32_t a = i + 1, b = a + 1, c = a + SIDE, d = c + 1;
    if (i % SIDE == SIDE - 1) continue;
    memcpy(triangle[2 * (size_t)cell], (uint32_t[3]){a, b, d}, sizeof *triangle);
    memcpy(triangle[2 * (size_t)cell + 1], (uint32_t[3]){a, d, c}, sizeof *triangle);
    double six = volume((const double(*)[3])x, a, b, d, c);
    if (++cell % 17 == 0 && fabs(six) > 0.1)
      memcpy(solid[count[0]++], six > 0 ? (uint32_t[4]){a, b, d, c} : (uint32_t[4]){a, d, b, c}, sizeof *solid);
    if (cell % 5 == 0) memcpy(joint[count[1]++], (uint32_t[3]){a, b, d}, sizeof *joint);
  }
  assert_int_equal(hk_scene_add_triangles(e->scene, 2 * CELLS, (const uint32_t(*)[3])triangle, &e->error), HK_OK);
  free(triangle);
  free(x);
}

static void add_elements(test_engine *e) {
  uint32_t(*solid)[4] = malloc(CELLS * sizeof *solid), (*joint)[3] = malloc(CELLS * sizeof *joint);
  size_t count[2] = {0};
  add_shapes(e, solid, joint, count);
  hk_plugin_spec *membrane = test_plugin(e, HK_FORCE, "membrane"), *hinges = test_plugin(e, HK_FORCE, "hinges");
  test_number(e, membrane, "stiffness", 10);
  test_number(e, membrane, "damping", 0.01);
  test_number(e, hinges, "rigidity", 0.1);
  test_number(e, hinges, "damping", 0.01);
  test_number(e, test_plugin(e, HK_FORCE, "quadratic_bending"), "rigidity", 0.1);
  hk_plugin_spec *body = test_plugin(e, HK_FORCE, "neo_hookean"), *bends = test_plugin(e, HK_FORCE, "angle_springs");
  test_tuples(e, body, "tetrahedra", 4, solid[0], count[0]);
  test_number(e, body, "E", 5);
  test_number(e, body, "damping", 0.1);
  test_tuples(e, bends, "joints", 3, joint[0], count[1]);
  test_number(e, bends, "k", 0.3);
  test_number(e, bends, "damping", 0.1);
  free(solid);
  free(joint);
}

static void open_all(test_engine *e, int threads) {
  seed = 11;
  test_engine_open(e);
  e->scene->threads = threads;
  e->options.dt = 1e-3;
  add_elements(e);
  test_vector(e, test_plugin(e, HK_FORCE, "wind"), "velocity", 1, 2, 3);
  test_number(e, test_plugin(e, HK_FORCE, "central"), "strength", 0.1);
  hk_plugin_spec *field = test_plugin(e, HK_FORCE, "magnetic"), *vortex = test_plugin(e, HK_FORCE, "vortex");
  test_vector(e, field, "B", 0, 0.5, 1);
  test_number(e, field, "charge", 0.2);
  test_number(e, vortex, "strength", 3);
  test_number(e, vortex, "rate", 0.1);
  test_text(e, test_plugin(e, HK_FORCE, "penalty"), "shape", "plane");
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  test_run(e);
  for (size_t k = 0; k < 3 * N; k++) e->run->state.X[3 * N + k] = noise();
}

/* Some forty terms a particle in another order. */
static void the_pass_is_the_sum_of_forces(void **state) {
  (void)state;
  test_engine e;
  open_all(&e, 2);
  hk_dynamics *d = &e.run->dynamics;
  hk_system *s = &d->system;
  double *a = calloc(3 * N + 8, sizeof *a), *b = calloc(3 * N, sizeof *b), *F = calloc(3 * N, sizeof *F);
  double largest = 0, off = 0;
  assert_int_equal(s->accelerations(s, s->t, s->X, s->X + 3 * N, NULL, a, a + 3 * N), HK_OK);
  for (size_t k = 0; k < s->split->forces; k++) {
    if (!d->tiles.chosen[k]) fail_msg("force %zu does not go by parts", k);
    assert_true(hk_query_force(d, k, s->X, N, F));
    for (size_t q = 0; q < 3 * N; q++) b[q] += F[q];
  }
  for (size_t q = 0; q < 3 * N; q++) largest = fmax(largest, fabs(b[q])), off = fmax(off, fabs(a[q] - b[q]));
  print_message("off by %.1e of the largest force\n", off / largest);
  assert_true(e.run->state.partition.domains == 3 && largest > 1 && off < 1e-14 * largest);
  free(a);
  free(b);
  free(F);
  test_engine_close(&e);
}

static void threads_leave_no_trace(void **state) {
  (void)state;
  double *X = NULL, *F = malloc(3 * N * sizeof *F), *kept = malloc(16 * 3 * N * sizeof *kept);
  for (int threads = 1; threads <= 5; threads += 2) {
    test_engine e;
    open_all(&e, threads);
    test_advance(&e, 8e-3);
    hk_dynamics *d = &e.run->dynamics;
    size_t bytes = e.run->state.size * sizeof *X;
    if (!X) X = memcpy(malloc(bytes), e.run->state.X, bytes);
    assert_memory_equal(X, e.run->state.X, bytes);
    for (size_t k = 0; k < d->split.forces; k++) { /* by `add` */
      assert_true(hk_query_force(d, k, d->system.X, N, F));
      if (threads == 1) memcpy(kept + k * 3 * N, F, 3 * N * sizeof *F);
      assert_memory_equal(kept + k * 3 * N, F, 3 * N * sizeof *F);
    }
    test_engine_close(&e);
  }
  free(X);
  free(F);
  free(kept);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_pass_is_the_sum_of_forces),
      cmocka_unit_test(threads_leave_no_trace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
