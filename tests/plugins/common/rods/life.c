/* Rods through a run: folded, relaxing, dying and released, on any number of threads and on every path of instructions,
 * and without memory. */
#include "core/engine/contract/contract.h"
#include "plugins/common/rods/rod_set.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { EDGES = 12, STRANDS = 7 };

static const double pi = 3.14159265358979323846;

/* Wavy strands of different lengths, clamped at their first two particles, and with `twist` at their last two. */
static hk_plugin_spec *open_strands(test_engine *e, bool twist) {
  uint32_t edge[EDGES * STRANDS][2];
  size_t edges = 0;
  test_engine_open(e);
  for (uint32_t s = 0; s < STRANDS; s++) {
    uint32_t count = EDGES - s % 4;
    for (uint32_t k = 0; k <= count; k++) {
      uint32_t id = test_particle(e, 0.1 * k, 0.02 * sin(1.3 * k + s), 0.2 * s + 0.02 * cos(1.7 * k), 0.01);
      if (k > 0) edge[edges][0] = id - 1, edge[edges++][1] = id;
      if (k < 2 || (twist && k + 2 > count)) test_pin(e, HK_PIN_FIXED, id, NULL);
    }
  }
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, rods, (const uint32_t(*)[2])edge, edges);
  test_number(e, rods, "EI", 1e-3);
  test_number(e, rods, "GJ", 7e-4);
  if (twist) test_number(e, rods, "turn", 9);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 500);
  test_plugin(e, HK_FORCE, "gravity");
  e->options.dt = 1e-4;
  e->scene->duration = 0.5;
  return rods;
}

/* ---- paths and threads ---- */

/* The energy, forces and angles by another path have the very bits. */
static void paths_have_the_same_bits(void **state) {
  (void)state;
  for (int twist = 0; twist < 2; twist++)
    for (int ribbon = 0; ribbon < 2; ribbon++) {
      test_engine e;
      hk_plugin_spec *spec = open_strands(&e, twist);
      test_text(&e, spec, "rest", "straight");
      if (ribbon) test_number(&e, spec, "EI2", 3e-3);
      test_run(&e);
      hk_instance *instance = test_instance(&e, spec);
      hk_view view = force_view(&e, instance);
      hk_rods *rods = instance->self;
      double *F[4] = {NULL}, energy[4];
      int paths = 0;
      for (int p = 0, lanes = 2; lanes <= hk_processor_lanes(); p++, lanes *= 2, paths++) {
        F[p] = calloc(3 * view.n, sizeof *F[p]);
        rods->path = hk_rod_path_of(lanes);
        force_evaluate(instance, &view, F[p]);
        energy[p] = instance->plugin->force->energy(instance->self, &view);
      }
      for (int p = 1; p < paths; p++) {
        assert_true(energy[0] == energy[p] && energy[0] > 0);
        assert_memory_equal(F[0], F[p], 3 * view.n * sizeof(double));
      }
      for (int p = 0; p < paths; p++) free(F[p]);
      test_engine_close(&e);
    }
}

static void threads_have_the_same_bits(void **state) {
  (void)state;
  double *x[2];
  size_t n = 0;
  for (int t = 0; t < 2; t++) {
    test_engine e;
    open_strands(&e, true);
    e.options.threads = t == 0 ? 1 : 3;
    test_run(&e);
    test_advance(&e, 0.05);
    n = e.run->state.model.n;
    x[t] = malloc(3 * n * sizeof *x[t]);
    memcpy(x[t], e.run->state.X, 3 * n * sizeof *x[t]);
    test_engine_close(&e);
  }
  assert_memory_equal(x[0], x[1], 3 * n * sizeof(double));
  free(x[0]);
  free(x[1]);
}

/* ---- folds ---- */

static hk_plugin_spec *open_hairpin(test_engine *e, double gap) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 1), test_particle(e, 1, 0, 0, 1), test_particle(e, 0, gap, 0, 1);
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, rods, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  test_number(e, rods, "EI", 1);
  test_text(e, rods, "rest", "straight");
  e->options.dt = 1e-9;
  e->scene->duration = 1e-3;
  return rods;
}

static void a_fold_at_the_start_is_refused(void **state) {
  (void)state;
  test_engine e;
  open_hairpin(&e, 0);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "folded back on itself at particle 2"));
  test_engine_close(&e);
}

/* Finite at a fold, at edges without length and near to them; and a step that ends there is an error that says where.
 */
static void a_fold_in_a_run_ends_it(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_hairpin(&e, 0.1);
  test_run(&e);
  hk_instance *rods = test_instance(&e, spec);
  hk_view view = force_view(&e, rods);
  for (int k = 0; k < 40; k++) {
    double gap = k < 39 ? pow(10, -k / 2.) : 0, F[9], K[81], D[81];
    view.x = (const double[]){0, 0, 0, 1, 0, 0, 0, gap, 0};
    force_evaluate(rods, &view, F);
    force_matrices(rods, &view, K, D);
    for (int q = 0; q < 9; q++) assert_true(isfinite(F[q]));
    for (int q = 0; q < 81; q++) assert_true(isfinite(K[q]));
  }
  view.x = (const double[]){0, 0, 0, 1, 0, 0, 0, 1e-4, 0};
  assert_int_equal(hk_force_of(rods->plugin)->steps.accepted(rods->self, &view, 1e-3), HK_FAILED);
  assert_non_null(strstr(e.run->error.text, "folded back on itself at particle 2"));
  hk_error_clear(&e.run->error);
  view.x = (const double[]){0, 0, 0, 1, 0, 0, 1, 0, 0};
  assert_int_equal(hk_force_of(rods->plugin)->steps.accepted(rods->self, &view, 1e-3), HK_FAILED);
  assert_non_null(strstr(e.run->error.text, "no length"));
  view.x = (const double[]){0, 0, 0, 1, 0, 0, 0, 0.01, 0};
  assert_int_equal(hk_force_of(rods->plugin)->steps.accepted(rods->self, &view, 1e-3), HK_OK);
  test_engine_close(&e);
}

/* A helix of one wide turn, in one step from a straight line: the directors come round by 2 pi (1 - cos) against the
 * clamp, which is pi less or more than what was: an error, and none for a tenth of it. */
static void a_step_that_may_lose_a_turn_ends_the_run(void **state) {
  (void)state;
  for (int large = 0; large < 2; large++) {
    test_engine e;
    hk_plugin_spec *spec = open_strands(&e, true);
    test_text(&e, spec, "rest", "straight");
    test_run(&e);
    hk_instance *rods = test_instance(&e, spec);
    hk_view view = force_view(&e, rods);
    double *x = malloc(3 * view.n * sizeof *x), cosine = large ? 0.5 : 0.95, size = 0.1 * sqrt(1 - cosine * cosine);
    memcpy(x, view.x, 3 * view.n * sizeof *x);
    for (size_t k = 2; k + 2 < EDGES + 1; k++) { /* the first strand; edges turn by a whole turn in nine */
      double angle = 2 * pi * (double)(k - 1) / 9;
      x[3 * k] = x[3 * k - 3] + 0.1 * cosine;
      x[3 * k + 1] = x[3 * k - 2] + size * cos(angle), x[3 * k + 2] = x[3 * k - 1] + size * sin(angle);
    }
    view.x = x;
    assert_int_equal(hk_force_of(rods->plugin)->steps.accepted(rods->self, &view, 1e-3), large ? HK_FAILED : HK_OK);
    if (large) assert_non_null(strstr(e.run->error.text, "its number of turns would be a guess"));
    free(x);
    test_engine_close(&e);
  }
}

/* ---- bad input ---- */

static void refuse(const uint32_t (*edge)[2], size_t edges, const char *name, double value, const char *says) {
  test_engine e;
  test_engine_open(&e);
  for (int k = 0; k < 4; k++) test_particle(&e, k == 3 ? 2 : k, k == 1 ? 0.1 : 0, 0, 1); /* 3 and 4 in one place */
  hk_plugin_spec *rods = test_plugin(&e, HK_FORCE, "rods");
  test_edges(&e, rods, edge, edges);
  test_number(&e, rods, "EI", 1);
  if (name) test_number(&e, rods, name, value);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  if (!strstr(e.error.text, says)) print_error("%s\n", e.error.text);
  assert_non_null(strstr(e.error.text, says));
  test_engine_close(&e);
}

static void mistakes_are_named(void **state) {
  (void)state;
  const uint32_t good[][2] = {{1, 2}, {2, 3}}, star[][2] = {{2, 1}, {2, 3}}, back[][2] = {{1, 2}, {2, 1}},
                 none[][2] = {{1, 3}, {3, 4}};
  refuse(star, 2, NULL, 0, "numbers 1 and 2 meet at particle 2, but do not follow each other");
  refuse(back, 2, NULL, 0, "do not follow each other");
  refuse(none, 2, NULL, 0, "number 2, from particle 3 to 4, has no length");
  refuse(good, 2, NULL, 0, "needs a stiffness in twist above 0");
  refuse(good, 2, "EI2", 2, "needs a stiffness in twist above 0");
}

/* ---- births and deaths ---- */

/* A ring loses a particle: what is left is a rod of one piece, with its rest shape and twist. */
static void a_ring_that_opens_keeps_its_joints(void **state) {
  (void)state;
  enum { RING = 8 };
  test_engine e;
  uint32_t edge[RING][2], map[RING];
  double F[2][3 * RING], x[3 * RING];
  test_engine_open(&e);
  for (uint32_t k = 0; k < RING; k++) {
    test_particle(&e, cos(2 * pi * k / RING), sin(2 * pi * k / RING), 0.1 * sin(3. * k), 1);
    edge[k][0] = k + 1, edge[k][1] = (k + 1) % RING + 1;
    map[k] = k == 2 ? UINT32_MAX : k > 2 ? k - 1 : k;
  }
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "rods");
  test_edges(&e, spec, (const uint32_t(*)[2])edge, RING);
  test_number(&e, spec, "EI", 1);
  test_number(&e, spec, "GJ", 1);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *rods = test_instance(&e, spec);
  hk_view view = force_view(&e, rods);
  memcpy(x, view.x, sizeof x);
  assert_int_equal(((hk_rods *)rods->self)->batch[0].ring, true);
  memmove(x + 6, x + 9, 15 * sizeof *x);
  hk_model model = *view.model;
  uint32_t id[] = {1, 2, 4, 5, 6, 7, 8};
  model.id = id, model.n = RING - 1;
  view.model = &model, view.x = x, view.n = view.acting = RING - 1;
  assert_int_equal(hk_instance_remap(rods, map, RING, &view, 6 * RING - 5, &e.error), HK_OK);
  force_evaluate(rods, &view, F[0]); /* at rest */
  for (int q = 0; q < 3 * (RING - 1); q++) assert_true(fabs(F[0][q]) < 1e-13);
  assert_int_equal(((hk_rods *)rods->self)->batch[0].edges, RING - 2);
  x[18] += 0.1; /* particle 8, between 7 and 1: joints across the end of the list */
  force_evaluate(rods, &view, F[1]);
  assert_true(fabs(F[1][18]) > 0.1 && fabs(F[1][0]) > 0.01 && fabs(F[1][3]) > 0.01);
  assert_true(force_gradient_error(rods, &view) < 10 * FORCE_DIFFERENCES);
  test_engine_close(&e);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    hk_plugin_spec *rods = open_strands(&e, true);
    test_text(&e, rods, "jacobian", "exact");
    e.options.allocations = k + 1;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 8);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(paths_have_the_same_bits),
      cmocka_unit_test(threads_have_the_same_bits),
      cmocka_unit_test(a_fold_at_the_start_is_refused),
      cmocka_unit_test(a_fold_in_a_run_ends_it),
      cmocka_unit_test(a_step_that_may_lose_a_turn_ends_the_run),
      cmocka_unit_test(mistakes_are_named),
      cmocka_unit_test(a_ring_that_opens_keeps_its_joints),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
