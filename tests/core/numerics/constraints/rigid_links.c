/* Rigid groups that links join as trees move as where all equations are solved together, to rounding, whether links are
 * pairs of points or others, too; to the same bits
 * for any width of vectors and number of threads; long steps, and links that form a loop, go over to the other way. */
#include "core/numerics/constraints/constraints.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 1200, BODIES = 7 };

typedef struct list {
  uint32_t pair[MOST][2];
  size_t count;
} list;

static list bars, welds;

static void add(list *l, uint32_t p, uint32_t q) {
  l->pair[l->count][0] = p;
  l->pair[l->count++][1] = q;
}

static const double edge_length = 0.2;

/* A tetrahedron with its corner at x, of unlike masses; returns the id of its first particle. */
static uint32_t body(test_engine *e, double x, double y, double z) {
  uint32_t first = test_particle(e, x, y, z, 1);
  for (int k = 0; k < 3; k++)
    test_particle(e, x + edge_length * (k == 0), y + edge_length * (k == 1), z + edge_length * (k == 2), 1.3 + 0.4 * k);
  for (uint32_t i = 0; i < 4; i++)
    for (uint32_t j = 0; j < i; j++) add(&bars, first + j, first + i);
  return first;
}

/* A point of the body at (x, y, z) from its corner. */
static uint32_t point(test_engine *e, uint32_t body, double x, double y, double z) {
  const double *at = e->scene->particles.position + 3 * (size_t)(body - 1);
  hk_rider r = {.particle = test_particle(e, at[0] + x, at[1] + y, at[2] + z, 0), .carriers = 4};
  const double part[3] = {x / edge_length, y / edge_length, z / edge_length};
  for (uint32_t k = 0; k < 4; k++) {
    r.carrier[k] = body + k;
    r.weight[k] = k ? part[k - 1] : 1 - part[0] - part[1] - part[2];
  }
  assert_int_equal(hk_scene_add_rider(e->scene, &r, &e->error), HK_OK);
  return r.particle;
}

enum { TREES = 0, LOOP = 1, GUIDE = 2 };

/* Two trees. The first hangs from a pin: bodies in a row, joined by a point, by a point and a distance, and by three
 * distances, with a rod of two particles on a body in its middle, and a particle on a bar at its end.
 * The second is free: a body with two others. Beside them a body that is joined to nothing. LOOP: the first tree's
 * ends are joined, too; GUIDE: a point of the last body keeps its way along an edge of another one. */
static void scene(test_engine *e, int kind, double spin, double step) {
  uint32_t first[BODIES];
  bars.count = welds.count = 0;
  test_engine_open(e);
  for (int k = 0; k < BODIES; k++) first[k] = body(e, k < 4 ? k : k - 4.3, k < 4 ? 0.1 * k : 3, k == 6 ? 5 : 0.2 * k);
  uint32_t rod = test_particle(e, 2, 1, 0.4, 0.7), end = test_particle(e, 2, 1.5, 0.4, 0.9);
  uint32_t bob = test_particle(e, 4, 0.3, 0.1, 2), pin = test_particle(e, -0.5, 0, 0, 1);
  test_pin(e, HK_PIN_FIXED, pin, NULL);
  add(&bars, rod, end);
  add(&bars, bob, point(e, first[3], 0.2, 0.1, 0.1));
  add(&welds, pin, point(e, first[0], -0.5, 0, 0));
  add(&welds, rod, point(e, first[2], 0, 0.8, 0));
  for (int k = 0; k < 3; k++) {
    uint32_t here = point(e, first[k], 0.6, k == 2 ? 0.4 : 0.1, 0), there = point(e, first[k + 1], -0.4, 0, -0.2);
    add(k == 2 ? &bars : &welds, here, there);
    for (int n = 0; n < k; n++)
      add(&bars, point(e, first[k], 0.6, 0.1 + 0.5 * n, 0.5),
          point(e, first[k + 1], -0.4 + 0.2 * n, 0.5, -0.2 - 0.3 * n));
  }
  add(&welds, point(e, first[4], 0.5, 0, 0), point(e, first[5], -0.5, 0, -0.2));
  if (kind == LOOP) add(&bars, point(e, first[3], 0, 0.2, 0), end);
  for (size_t i = 0; i < 4 * BODIES; i++) {
    const double *x = e->scene->particles.position + 3 * i;
    double *v = e->scene->particles.velocity + 3 * i;
    v[0] = -spin * x[1], v[1] = spin * x[0], v[2] = 0;
  }
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])bars.pair, bars.count);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "weld"), (const uint32_t(*)[2])welds.pair, welds.count);
  const uint32_t way[4] = {first[5], first[6], first[5] + 1, first[5] + 2};
  if (kind == GUIDE) test_tuples(e, test_plugin(e, HK_CONSTRAINT, "guides"), "points", 4, way, 1);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 2, -9.81);
  e->options.integrator = "leapfrog";
  e->scene->dt = step;
  test_run(e);
}

static double violation_of(test_engine *e) {
  double violation;
  assert_int_equal(hk_constraints_violation(&e->run->dynamics, &violation), HK_OK);
  return violation;
}

static void compare_ways(int kind) {
  double end[2][6 * MOST];
  size_t size = 0;
  for (int together = 0; together < 2; together++) {
    test_engine e;
    scene(&e, kind, 0.5, 1e-3);
    assert_non_null(e.run->dynamics.constraints->groups);
    if (together) hk_rigid_groups_close(e.run->dynamics.constraints);
    size_t before = e.run->dynamics.count.factorizations;
    test_advance(&e, 0.5);
    assert_true((e.run->dynamics.count.factorizations > before + 100) == together);
    size = 6 * e.run->state.model.n;
    memcpy(end[together], e.run->state.X, size * sizeof(double));
    assert_true(violation_of(&e) < 1e-14);
    test_engine_close(&e);
  }
  /* 500 steps, each rounded by some 1e-15 m of 5 m, or that over h in m/s */
  for (size_t k = 0; k < size; k++)
    if (!(fabs(end[0][k] - end[1][k]) < 1e-10)) fail_msg("%zu: %.15g and %.15g", k, end[0][k], end[1][k]);
}

static void trees_move_as_where_all_is_solved_together(void **state) {
  (void)state;
  compare_ways(TREES);
}

static void trees_with_other_links_do_so_too(void **state) {
  (void)state;
  compare_ways(GUIDE);
}

static void loops_are_solved_together(void **state) {
  (void)state;
  test_engine e;
  scene(&e, LOOP, 0.5, 1e-3);
  assert_null(e.run->dynamics.constraints->groups);
  test_advance(&e, 0.01);
  assert_true(violation_of(&e) < 1e-14);
  test_engine_close(&e);
}

/* Bodies turn by more than a radian a step, too much for the matrix of the start. */
static void long_steps_are_solved_together(void **state) {
  (void)state;
  test_engine e;
  scene(&e, TREES, 70, 1 / 60.0);
  assert_non_null(e.run->dynamics.constraints->groups);
  size_t before = e.run->dynamics.count.factorizations;
  test_advance(&e, 2 / 60.0);
  assert_true(e.run->dynamics.count.factorizations > before);
  assert_true(violation_of(&e) < 1e-11);
  test_engine_close(&e);
}

static void results_have_the_same_bits_for_any_width(void **state) {
  (void)state;
  double end[3][6 * MOST];
  const int lanes[3] = {2, 4, 8}, most = hk_processor_lanes();
  for (int k = 0; k < 3; k++) {
    test_engine e;
    test_engine_open(&e);
    test_engine_close(&e);
    scene(&e, TREES, 0.5, 1e-3);
    hk_run_close(e.run, NULL);
    hk_run_destroy(e.run);
    e.run = NULL;
    e.options.lanes = lanes[k] < most ? lanes[k] : most;
    test_run(&e);
    test_advance(&e, 0.1);
    size_t size = 6 * e.run->state.model.n;
    memcpy(end[k], e.run->state.X, size * sizeof(double));
    test_engine_close(&e);
    assert_memory_equal(end[0], end[k], size * sizeof(double));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(trees_move_as_where_all_is_solved_together),
      cmocka_unit_test(trees_with_other_links_do_so_too),
      cmocka_unit_test(loops_are_solved_together),
      cmocka_unit_test(long_steps_are_solved_together),
      cmocka_unit_test(results_have_the_same_bits_for_any_width),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
