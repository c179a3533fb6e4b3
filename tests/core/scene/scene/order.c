/* A cloth whose ids are shuffled gets the indices of its rows back, and nobody sees it: by id, everything is as in the
 * same cloth with ids in order, bit by bit, since sums have the same order. Also with births and deaths, from a
 * checkpoint, from a state table and in files. */
#include "tests/bench/delaunay.h"
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* STRIDE has no divisor in common with COUNT, so that place -> id is one to one. */
enum { SIDE = 48, COUNT = SIDE * SIDE, STRIDE = 1009, EDGES = 2 * SIDE * (SIDE - 1) };

static const double until = 0.1, half = 0.05;

static uint32_t id_of(size_t place, bool shuffled) { return 1 + (uint32_t)(shuffled ? place * STRIDE % COUNT : place); }

static void add_particles(test_engine *e, bool shuffled) {
  double x[3 * COUNT], v[3 * COUNT], mass[COUNT];
  uint32_t first;
  for (size_t k = 0; k < COUNT; k++) {
    size_t i = id_of(k, shuffled) - 1;
    for (size_t c = 0; c < 3; c++) x[3 * i + c] = v[3 * i + c] = 0;
    x[3 * i] = 0.02 * (double)(k % SIDE);
    x[3 * i + 1] = 0.02 * (double)(k / SIDE);
    v[3 * i + 2] = 0.1 * sin((double)k);
    mass[i] = 1e-3 * (1 + 0.1 * (double)(k % 7));
  }
  assert_int_equal(hk_scene_add_channel(e->scene, "heat", 1, NULL, -3, NULL, &e->error), HK_OK);
  assert_int_equal(hk_scene_add_particles(e->scene, COUNT, x, v, mass, 0, 0, &first, &e->error), HK_OK);
  for (size_t k = 0; k < COUNT; k++)
    assert_int_equal(hk_scene_set_channel(e->scene, "heat", id_of(k, shuffled), &(double){(double)k}, 1, &e->error),
                     HK_OK);
}

static void add_springs(test_engine *e, bool shuffled) {
  static uint32_t edge[EDGES][2];
  size_t edges = 0;
  for (size_t across = 0; across < 2; across++)
    for (size_t k = 0; k < COUNT; k++) {
      if (across ? k / SIDE + 1 == SIDE : k % SIDE + 1 == SIDE) continue;
      edge[edges][0] = id_of(k, shuffled);
      edge[edges++][1] = id_of(k + (across ? SIDE : 1), shuffled);
    }
  assert_int_equal(edges, EDGES);
  assert_int_equal(hk_scene_add_edges(e->scene, EDGES, (const uint32_t(*)[2])edge, &e->error), HK_OK);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, EDGES);
  test_number(e, springs, "k", 100);
  test_number(e, springs, "damping", 0.01);
}

/* Gravity acts on the first row alone. */
static void describe(test_engine *e, bool shuffled, bool births) {
  test_engine_open(e);
  add_particles(e, shuffled);
  add_springs(e, shuffled);
  hk_plugin_spec *gravity = test_plugin(e, HK_FORCE, "gravity");
  gravity->only = calloc(SIDE, sizeof *gravity->only);
  gravity->only_count = SIDE;
  for (size_t k = 0; k < SIDE; k++) gravity->only[k] = id_of(k, shuffled) - 1;
  test_pin(e, HK_PIN_FIXED, id_of(COUNT - 1, shuffled), NULL);
  test_pin(e, HK_PIN_LINE, id_of(COUNT - SIDE, shuffled), (const double[]){0, 0, 1});
  if (births) test_number(e, test_plugin(e, HK_SOURCE, "fixture:spout"), "lifetime", 0.013);
  e->scene->duration = until;
  e->options.dt = 1e-3;
  e->options.integrator = "leapfrog";
}

static void assert_same(test_engine *a, test_engine *b, bool shuffled) {
  const hk_state *s = &a->run->state, *t = &b->run->state;
  assert_int_equal(s->model.n, t->model.n);
  for (uint32_t k = 0; k < s->model.n; k++) {
    uint32_t id = s->id[k], other = id <= COUNT ? id_of(id - 1, shuffled) : id, i;
    if (!hk_state_index(t, other, &i)) fail_msg("there is no particle %u", other);
    assert_memory_equal(s->X + 3 * k, t->X + 3 * i, 3 * sizeof(double));
    assert_memory_equal(s->X + 3 * (s->model.n + k), t->X + 3 * (t->model.n + i), 3 * sizeof(double));
    assert_true(s->X[6 * s->model.n + k] == t->X[6 * t->model.n + i]);
    assert_true(s->mass[k] == t->mass[i] && s->pin[k] == t->pin[i]);
  }
}

static void shuffled_ids_change_nothing(void **state) {
  (void)state;
  for (int births = 0; births < 2; births++) {
    test_engine ordered, shuffled;
    describe(&ordered, false, births);
    describe(&shuffled, true, births);
    test_run(&ordered);
    test_run(&shuffled);
    assert_null(ordered.run->state.by_id);
    assert_non_null(shuffled.run->state.by_id);
    test_advance(&ordered, until);
    test_advance(&shuffled, until);
    assert_same(&ordered, &shuffled, true);
    const hk_model *m = &shuffled.run->state.model;
    for (size_t k = 1; k < m->n; k++) assert_true(m->id[hk_model_nth(m, k)] > m->id[hk_model_nth(m, k - 1)]);
    if (births) assert_int_not_equal(m->n, COUNT);
    test_engine_close(&ordered);
    test_engine_close(&shuffled);
  }
}

static void a_run_goes_on_from_its_checkpoint(void **state) {
  (void)state;
  char path[512];
  snprintf(path, sizeof path, "%s/half.checkpoint", test_folder());
  for (int births = 0; births < 2; births++) {
    test_engine whole, first, second;
    describe(&whole, true, births);
    describe(&first, true, births);
    describe(&second, true, births);
    test_run(&whole);
    test_advance(&whole, until);
    test_run(&first);
    test_advance(&first, half);
    assert_int_equal(hk_run_save(first.run, path, &first.error), HK_OK);
    second.scene->start_file = strdup(path);
    test_run(&second);
    test_advance(&second, until);
    assert_same(&whole, &second, false);
    test_engine_close(&whole);
    test_engine_close(&first);
    test_engine_close(&second);
  }
}

/* The rows of a table have the order of ids, and a run that starts from them their numbers. */
static void tables_have_the_order_of_ids(void **state) {
  (void)state;
  char path[512], line[512];
  snprintf(path, sizeof path, "%s/state.csv", test_folder());
  test_engine first, second;
  describe(&first, true, false);
  describe(&second, true, false);
  test_run(&first);
  test_advance(&first, half);
  assert_int_equal(hk_run_write_state(first.run, path, &first.error), HK_OK);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  assert_non_null(fgets(line, sizeof line, file));
  for (unsigned long id = 1; id <= COUNT; id++) {
    assert_non_null(fgets(line, sizeof line, file));
    assert_int_equal(strtoul(line, NULL, 10), id);
  }
  fclose(file);
  second.scene->start_file = strdup(path);
  second.scene->trusted = true;
  test_run(&second);
  assert_same(&first, &second, false);
  test_engine_close(&first);
  test_engine_close(&second);
}

/* Most neighbours in a row of an unstructured mesh are joined, a third of all edges, where rows are about as wide as
 * the mean distance of particles; and no edge is longer than some rows of sqrt(n). */
static void rows_of_an_unstructured_mesh_follow_its_edges(void **state) {
  enum { N = 60, STEP = 1009 /* no divisor in common with N^2 */ };
  (void)state;
  delaunay d = delaunay_mesh(N);
  uint32_t(*pair)[2] = malloc(3 * d.n * sizeof *pair), first;
  size_t count = delaunay_pairs(&d, 0, pair), following = 0, reach = 0;
  double(*x)[3] = calloc(d.n, sizeof *x), *mass = malloc(d.n * sizeof *mass);
  test_engine e;
  test_engine_open(&e);
  for (size_t k = 0; k < d.n; k++) memcpy(x[k * STEP % d.n], d.x[k], sizeof d.x[k]), mass[k] = 1;
  assert_int_equal(hk_scene_add_particles(e.scene, d.n, x[0], NULL, mass, 0, 0, &first, &e.error), HK_OK);
  for (size_t s = 0; s < count; s++)
    for (int c = 0; c < 2; c++) pair[s][c] = (uint32_t)(pair[s][c] * STEP % d.n) + first;
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t(*)[2])pair, count);
  test_number(&e, springs, "k", 100);
  uint32_t *place = hk_scene_places(e.scene);
  assert_non_null(place);
  for (size_t s = 0; s < count; s++) {
    uint32_t a = place[pair[s][0] - first], b = place[pair[s][1] - first], apart = a < b ? b - a : a - b;
    following += apart == 1;
    reach = apart > reach ? apart : reach;
  }
  if (10 * following < 3 * count || reach > 5 * N)
    fail_msg("%zu of %zu edges follow the rows, reach %zu", following, count, reach);
  test_engine_close(&e);
  delaunay_free(&d);
  free(place), free(pair), free(x), free(mass);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shuffled_ids_change_nothing),
      cmocka_unit_test(a_run_goes_on_from_its_checkpoint),
      cmocka_unit_test(tables_have_the_order_of_ids),
      cmocka_unit_test(rows_of_an_unstructured_mesh_follow_its_edges),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
