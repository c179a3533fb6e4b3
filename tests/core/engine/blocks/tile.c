/* Several steps in one sweep: beside the same steps one by one, for any number of threads and of steps in a tile, with
 * elements within domains and across them; where a tile has one step; and a step that fails in the middle of a tile. */
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A particle is joined to one of the next NEAR. */
enum { N = 20000, NEAR = 900, STEPS = 77 }; /* two tiles and a part of one */
static const double h = 1e-4;

static uint64_t seed;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

static size_t below(size_t n) { return (size_t)((noise() + 1) / 2 * (double)n) % n; }

/* `reach`: every particle is joined to one of so many that follow it. */
static void add_springs(test_engine *e, size_t reach) {
  uint32_t(*edge)[2] = malloc(N * sizeof *edge);
  size_t count = 0;
  for (size_t i = 0; i + 1 < N; i++) {
    size_t j = i + 1 + below(reach);
    if (j >= N) continue;
    edge[count][0] = (uint32_t)i + 1, edge[count++][1] = (uint32_t)j + 1;
  }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, count);
  test_number(e, springs, "k", 100);
  test_number(e, springs, "damping", 0.3);
  free(edge);
}

static void add_triples(test_engine *e) {
  uint32_t(*triple)[3] = malloc(N * sizeof *triple);
  size_t count = 0;
  for (uint32_t i = 1; i + NEAR < N; i += 40, count++)
    triple[count][0] = i, triple[count][1] = i + NEAR, triple[count][2] = i + 1;
  test_tuples(e, test_plugin(e, HK_FORCE, "fixture:triples"), "triangles", 3, &triple[0][0], count);
  free(triple);
}

static void open_net(test_engine *e, const char *method, int threads, size_t reach) {
  double *x = malloc(3 * N * sizeof *x);
  uint32_t first;
  seed = 7;
  test_engine_open(e);
  e->scene->threads = threads;
  e->options.dt = h * (1 + 1e-9);
  e->options.until = e->scene->duration = STEPS * h;
  e->scene->fps = 1 / (STEPS * h);
  for (size_t k = 0; k < 3 * N; k++) x[k] = noise();
  assert_int_equal(hk_scene_add_particles(e->scene, N, x, NULL, NULL, 1, 0, &first, &e->error), HK_OK);
  for (uint32_t k = 1; k < N; k += 700) test_pin(e, HK_PIN_FIXED, k, NULL);
  add_springs(e, reach);
  add_triples(e);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.4);
  test_plugin(e, HK_INTEGRATOR, method);
  free(x);
}

static bool makes_tiles(test_engine *e) { return hk_evaluate_takes_several(&e->run->dynamics); }

static void do_nothing(void *context, double length) { (void)context, (void)length; }

/* The state after the run: n x 6 and the work. `one_by_one`: somebody looks at every step. `too_early`: steps follow
 * the one before by so many items too early. */
static double *state_after(const char *method, int threads, bool one_by_one, uint32_t too_early) {
  test_engine e;
  open_net(&e, method, threads, NEAR);
  test_run(&e);
  assert_true(makes_tiles(&e));
  if (one_by_one) e.run->loop.hooks.moved = do_nothing;
  hk_tile_order *order = &e.run->dynamics.tiles.order;
  for (size_t i = 0; i < order->items; i++) order->item[i].after -= too_early;
  test_advance(&e, STEPS * h);
  assert_int_equal(e.run->record.steps, STEPS);
  double *X = malloc((6 * N + 1) * sizeof *X);
  memcpy(X, e.run->state.X, (6 * N + 1) * sizeof *X);
  test_engine_close(&e);
  return X;
}

static double distance(const double *a, const double *b) {
  double off = 0;
  for (size_t k = 0; k < 6 * N; k++) off = fmax(off, fabs(a[k] - b[k]));
  return off;
}

/* Places and speeds are up to 1; sums of some ten terms are added in another order, in 77 steps. */
static void a_tile_is_its_steps(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "stoermer_wide2", "stoermer", "stoermer8"};
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
    double *tiles = state_after(methods[m], 1, false, 0), *steps = state_after(methods[m], 1, true, 0);
    print_message("%s: off by %.1e; work %.17g and %.17g J\n", methods[m], distance(tiles, steps), tiles[6 * N],
                  steps[6 * N]);
    assert_true(distance(tiles, steps) < 1e-13);
    assert_true(tiles[6 * N] != 0 && fabs(tiles[6 * N] - steps[6 * N]) < 1e-12 * fabs(steps[6 * N]));
    free(tiles);
    free(steps);
  }
}

/* A step that does not wait for what the one before has still to add is seen. */
static void a_tile_in_haste_is_not(void **state) {
  (void)state;
  double *hasty = state_after("leapfrog", 1, false, 1), *steps = state_after("leapfrog", 1, true, 0);
  assert_true(distance(hasty, steps) > 1e-9);
  free(hasty);
  free(steps);
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  double *one = state_after("leapfrog", 1, false, 0);
  for (int threads = 2; threads <= 7; threads += threads == 3 ? 4 : 1) {
    double *several = state_after("leapfrog", threads, false, 0);
    assert_memory_equal(several, one, (6 * N + 1) * sizeof *one);
    free(several);
  }
  free(one);
}

/* Steps are the same in tiles of any length: the run stops where it is told, and goes on. */
static void tiles_of_any_length_are_the_same(void **state) {
  (void)state;
  double *whole = state_after("leapfrog", 2, false, 0);
  test_engine e;
  open_net(&e, "leapfrog", 2, NEAR);
  test_run(&e);
  for (size_t steps = 1; steps < STEPS; steps += steps % 9 + 1) {
    e.run->loop.schedule.step_limit = steps;
    assert_int_equal(hk_loop_to(&e.run->loop, STEPS * h), HK_INTERRUPTED);
    assert_int_equal(e.run->record.steps, steps);
    assert_true(fabs(e.run->state.t - (double)steps * h) < 1e-9 * h);
    hk_error_clear(&e.run->error);
  }
  e.run->loop.schedule.step_limit = 0;
  test_advance(&e, STEPS * h);
  assert_memory_equal(e.run->state.X, whole, (6 * N + 1) * sizeof *whole);
  test_engine_close(&e);
  free(whole);
}

/* Springs from any particle to any other: a block is complete only at the end of a step. */
static void without_an_order_a_tile_has_one_step(void **state) {
  (void)state;
  test_engine e;
  open_net(&e, "leapfrog", 2, N);
  test_run(&e);
  assert_false(makes_tiles(&e));
  test_advance(&e, 3 * h);
  test_engine_close(&e);
}

/* Whether steps are taken at once does not depend on whether the run is compared with another. */
static void a_force_that_can_be_passed_by_is_looked_at_in_every_step(void **state) {
  (void)state;
  for (int compared = 0; compared < 2; compared++) {
    test_engine e;
    open_net(&e, "leapfrog", 2, NEAR);
    test_plugin(&e, HK_FORCE, "central");
    test_run(&e);
    if (compared) e.run->loop.hooks.moved = do_nothing;
    assert_true(makes_tiles(&e));
    assert_false(hk_tile_fits(&e.run->loop));
    test_engine_close(&e);
  }
}

enum variant {
  WHOLE_FORCE /* a force without parts, whose work is F.v */,
  LONG_SPRINGS /* each spans a third of the net */
};

/* The state after the run. */
static double *state_of(enum variant v, const char *method, int threads, bool one_by_one) {
  test_engine e;
  open_net(&e, method, threads, v == LONG_SPRINGS ? N / 3 : NEAR);
  if (v == WHOLE_FORCE) test_number(&e, test_plugin(&e, HK_FORCE, "fixture:weak_central"), "strength", 2);
  test_run(&e);
  /* steps that are under way at once would gain nothing */
  if (v == LONG_SPRINGS) assert_true(e.run->dynamics.tiles.order.depth < 4);
  assert_true(hk_tile_fits(&e.run->loop));
  if (one_by_one) e.run->loop.hooks.moved = do_nothing;
  test_advance(&e, STEPS * h);
  assert_int_equal(e.run->record.steps, STEPS);
  double *X = malloc((6 * N + 1) * sizeof *X);
  memcpy(X, e.run->state.X, (6 * N + 1) * sizeof *X);
  test_engine_close(&e);
  return X;
}

/* Steps are then taken one after another, each block begun for the next step when it is finished: bit by bit. */
static void assert_bits_in_a_tile(enum variant v) {
  static const char *const methods[] = {"leapfrog", "stoermer"};
  for (int m = 0; m < 2; m++) {
    double *steps = state_of(v, methods[m], 1, true);
    for (int threads = 1; threads <= 3; threads += 2) {
      double *tiles = state_of(v, methods[m], threads, false);
      assert_memory_equal(tiles, steps, (6 * N + 1) * sizeof *steps);
      free(tiles);
    }
    free(steps);
  }
}

static void beside_a_force_without_parts_a_tile_has_the_bits_of_its_steps(void **state) {
  (void)state;
  assert_bits_in_a_tile(WHOLE_FORCE);
}

static void steps_too_near_to_be_taken_at_once_keep_their_bits_in_a_tile(void **state) {
  (void)state;
  assert_bits_in_a_tile(LONG_SPRINGS);
}

/* m/s, of the fastest particle after 50 steps. */
static double speed_after_50(void) {
  test_engine e;
  double most = 0;
  open_net(&e, "leapfrog", 1, NEAR);
  e.options.step_limit = 50;
  test_run(&e);
  assert_int_equal(hk_run_advance(e.run, STEPS * h, &e.error), HK_INTERRUPTED);
  for (const double *v = e.run->state.X + 3 * N; v < e.run->state.X + 6 * N; v += 3)
    most = fmax(most, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  test_engine_close(&e);
  return sqrt(most);
}

/* A force that is infinite from some 50th step on: the run ends at the same step, with the state before it, as if the
 * steps were taken one by one. */
static void a_step_fails_in_a_tile(void **state) {
  (void)state;
  double limit = speed_after_50(), X[2], t[2];
  size_t steps[2];
  for (int one_by_one = 0; one_by_one < 2; one_by_one++) {
    test_engine e;
    open_net(&e, "leapfrog", 2, NEAR);
    test_number(&e, test_plugin(&e, HK_FORCE, "fixture:burst"), "limit", limit);
    test_run(&e);
    assert_true(makes_tiles(&e));
    if (one_by_one) e.run->loop.hooks.moved = do_nothing;
    assert_int_equal(hk_run_advance(e.run, STEPS * h, &e.error), HK_NOT_FINITE);
    steps[one_by_one] = e.run->record.steps, t[one_by_one] = e.run->state.t, X[one_by_one] = e.run->state.X[5000];
    print_message("after %zu steps: %s\n", steps[one_by_one], e.error.text);
    test_engine_close(&e);
  }
  assert_int_equal(steps[0], steps[1]);
  assert_true(steps[0] > 32 && steps[0] < 64 && t[0] == t[1] && fabs(X[0] - X[1]) < 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_tile_is_its_steps),
      cmocka_unit_test(a_tile_in_haste_is_not),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(tiles_of_any_length_are_the_same),
      cmocka_unit_test(without_an_order_a_tile_has_one_step),
      cmocka_unit_test(a_force_that_can_be_passed_by_is_looked_at_in_every_step),
      cmocka_unit_test(beside_a_force_without_parts_a_tile_has_the_bits_of_its_steps),
      cmocka_unit_test(steps_too_near_to_be_taken_at_once_keep_their_bits_in_a_tile),
      cmocka_unit_test(a_step_fails_in_a_tile),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
