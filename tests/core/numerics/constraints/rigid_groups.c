/* Free rigid groups, which are kept group by group, move as where all equations are solved together, to rounding; to
 * the same bits for any width of vectors and number of threads; and long steps go over to the other way. */
#include "core/numerics/constraints/constraints.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 400 };

/* `each` groups of four, three and two particles of unlike masses and shapes, under a pull to the origin; `chained`:
 * with two bars in a row, which are no group. */
static void scene(test_engine *e, int each, bool chained, double spin) {
  uint32_t edge[MOST][2];
  size_t edges = 0;
  test_engine_open(e);
  for (int g = 0; g < 3 * each; g++) {
    int size = 4 - g % 3;
    uint32_t first = (uint32_t)e->scene->particles.n + 1;
    for (int k = 0; k < size; k++)
      test_particle(e, 3 * g + (k == 1) + 0.3 * sin(g), 1.5 * (k == 2), (k == 3) + 0.1 * cos(7 * g),
                    1 + 0.3 * k + g % 2);
    for (uint32_t i = 0; i < (uint32_t)size; i++) {
      const double *x = e->scene->particles.position + 3 * (first + i - 1);
      double *v = e->scene->particles.velocity + 3 * (first + i - 1);
      v[0] = -spin * x[1], v[1] = spin * (x[0] - 3 * g), v[2] = 0.1 * g;
      for (uint32_t j = i + 1; j < (uint32_t)size; j++, edges++) edge[edges][0] = first + j, edge[edges][1] = first + i;
    }
  }
  for (int k = 0; k < 3; k++) test_particle(e, 50 + k, 60, 0, 1);
  uint32_t last = (uint32_t)e->scene->particles.n;
  for (uint32_t k = 0; chained && k < 2; k++, edges++) edge[edges][0] = last - k, edge[edges][1] = last - k - 1;
  hk_plugin_spec *bars = test_plugin(e, HK_CONSTRAINT, "bars");
  test_edges(e, bars, (const uint32_t(*)[2])edge, edges);
  hk_plugin_spec *central = test_plugin(e, HK_FORCE, "central");
  test_number(e, central, "strength", 3);
  test_number(e, central, "power", 1);
  e->scene->dt = 1e-3;
  test_run(e);
}

/* What rides on a group has the place and the velocity of its carriers at the ends of steps, too. */
static void riders_go_with_their_groups(void **state) {
  (void)state;
  test_engine e;
  uint32_t edge[6][2];
  size_t edges = 0;
  const double w[4] = {1.5, 0.25, -1, 0.25};
  test_engine_open(&e);
  for (uint32_t k = 0; k < 4; k++) {
    test_particle(&e, k == 1, k == 2, k == 3, 1);
    e.scene->particles.velocity[3 * k] = k == 3 ? 2 : 0;
    for (uint32_t j = 0; j < k; j++, edges++) edge[edges][0] = j + 1, edge[edges][1] = k + 1;
  }
  hk_rider r = {.particle = test_particle(&e, 0, 0, 0, 0), .carriers = 4, .carrier = {1, 2, 3, 4}};
  memcpy(r.weight, w, sizeof w);
  assert_int_equal(hk_scene_add_rider(e.scene, &r, &e.error), HK_OK);
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])edge, edges);
  e.options.integrator = "leapfrog";
  e.scene->dt = 1e-3;
  test_run(&e);
  assert_non_null(e.run->dynamics.constraints->groups);
  test_advance(&e, 0.05);
  const double *x = e.run->state.X, *v = x + 15;
  for (int c = 0; c < 3; c++) {
    double place = 0, speed = 0;
    for (int k = 0; k < 4; k++) place += w[k] * x[3 * k + c], speed += w[k] * v[3 * k + c];
    assert_true(fabs(x[12 + c] - place) < 1e-14 && fabs(v[12 + c] - speed) < 1e-14);
  }
  test_engine_close(&e);
}

static void groups_move_as_where_all_is_solved_together(void **state) {
  (void)state;
  double end[2][6 * MOST], lambda[2][MOST];
  size_t bodies = 3 * 5 * 9, distances = 15 * (6 + 3 + 1);
  for (int chained = 0; chained < 2; chained++) {
    test_engine e;
    scene(&e, 15, chained, 3);
    assert_true((e.run->dynamics.constraints->groups == NULL) == chained);
    test_advance(&e, 0.5);
    assert_true(e.run->state.model.n == bodies + 3);
    memcpy(end[chained], e.run->state.X, 3 * bodies * sizeof(double));
    memcpy(end[chained] + 3 * bodies, e.run->state.X + 3 * (bodies + 3), 3 * bodies * sizeof(double));
    memcpy(lambda[chained], e.run->dynamics.constraints->lambda, distances * sizeof(double));
    double violation;
    assert_int_equal(hk_constraints_violation(&e.run->dynamics, &violation), HK_OK);
    assert_true(violation < 4e-13); /* of places up to 130 m */
    test_engine_close(&e);
  }
  /* 500 steps, each rounded by some 1e-14 m of 130 m, and speeds up to 200 m/s */
  for (size_t k = 0; k < 6 * bodies; k++)
    if (!(fabs(end[0][k] - end[1][k]) < 2e-10)) fail_msg("%zu: %.15g and %.15g", k, end[0][k], end[1][k]);
  for (size_t k = 0; k < distances; k++) /* multipliers, N: impulses of 1e-13 m/s over h */
    if (!(fabs(lambda[0][k] - lambda[1][k]) < 1e-7 * (1 + fabs(lambda[1][k]))))
      fail_msg("%zu: %.15g and %.15g N", k, lambda[0][k], lambda[1][k]);
}

static void results_have_the_same_bits_for_any_width_and_threads(void **state) {
  (void)state;
  double end[4][6 * MOST];
  const int lanes[4] = {2, 4, 8, 2}, threads[4] = {1, 1, 1, 3}, most = hk_processor_lanes();
  size_t size = 0;
  for (int k = 0; k < 4; k++) {
    test_engine e;
    test_engine_open(&e);
    test_engine_close(&e);
    scene(&e, 11, false, 3);
    hk_run_close(e.run, NULL);
    hk_run_destroy(e.run);
    e.run = NULL;
    e.options.lanes = lanes[k] < most ? lanes[k] : most;
    e.options.threads = threads[k];
    test_run(&e);
    test_advance(&e, 0.1);
    size = 6 * e.run->state.model.n;
    memcpy(end[k], e.run->state.X, size * sizeof(double));
    test_engine_close(&e);
    if (k) assert_memory_equal(end[0], end[k], size * sizeof(double));
  }
}

/* Where bodies turn by 1.1 rad a step, more than the matrix of the start allows, distances hold all the same. */
static void long_steps_are_solved_together(void **state) {
  (void)state;
  test_engine e;
  scene(&e, 2, false, 1100);
  test_advance(&e, 0.01);
  double violation;
  assert_int_equal(hk_constraints_violation(&e.run->dynamics, &violation), HK_OK);
  assert_true(violation < 1e-11);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(riders_go_with_their_groups),
      cmocka_unit_test(groups_move_as_where_all_is_solved_together),
      cmocka_unit_test(results_have_the_same_bits_for_any_width_and_threads),
      cmocka_unit_test(long_steps_are_solved_together),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
