/* A scene is a description: any number of runs can be made of it, and none changes it. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 6 };

/* A chain that hangs from its first particle, of which a source makes more. */
static void describe(test_engine *e, bool births) {
  uint32_t edges[N - 1][2] = {{0}};
  test_engine_open(e);
  for (uint32_t i = 0; i < N; i++) {
    test_particle(e, 0.1 * i, 0, 0, 0.02);
    if (i) edges[i - 1][0] = i, edges[i - 1][1] = i + 1;
  }
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_edges(e, test_plugin(e, HK_FORCE, "springs"), (const uint32_t(*)[2])edges, N - 1);
  test_number(e, e->scene->plugin[HK_FORCE].item[0], "k", 200);
  test_plugin(e, HK_FORCE, "gravity");
  if (births) test_number(e, test_plugin(e, HK_SOURCE, "fixture:spout"), "lifetime", 0.1);
  e->scene->duration = 0.5;
}

static hk_run *open_run(test_engine *e, const char *integrator) {
  hk_run_options options = e->options;
  hk_run *run = NULL;
  options.integrator = integrator;
  if (hk_run_open(e->scene, &options, &run, &e->error) != HK_OK) fail_msg("%s", e->error.text);
  return run;
}

static void advance(test_engine *e, hk_run *run, double t) {
  if (hk_run_advance(run, t, &e->error) != HK_OK) fail_msg("%s", e->error.text);
}

static double *copy_of(const hk_run *run) {
  double *X = malloc(run->state.size * sizeof *X);
  memcpy(X, run->state.X, run->state.size * sizeof *X);
  return X;
}

static void end(test_engine *e, hk_run *run) {
  assert_int_equal(hk_run_close(run, &e->error), HK_OK);
  hk_run_destroy(run);
}

/* Also where particles were born and died in the first run, and so lists of indices were remapped. */
static void a_scene_can_be_run_twice_with_the_same_bits(void **state) {
  (void)state;
  for (int births = 0; births < 2; births++) {
    test_engine e;
    describe(&e, births);
    hk_run *first = open_run(&e, NULL);
    advance(&e, first, 0.5);
    size_t size = first->state.size;
    double *X = copy_of(first);
    end(&e, first);
    hk_run *second = open_run(&e, NULL);
    advance(&e, second, 0.5);
    assert_int_equal(second->state.size, size);
    assert_memory_equal(second->state.X, X, size * sizeof *X);
    end(&e, second);
    free(X);
    test_engine_close(&e);
  }
}

/* In turns, at other steps and by other methods: each goes its own way, as it does alone. */
static void a_scene_can_be_in_two_runs_at_once(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "bdf2"};
  test_engine e;
  double *alone[2];
  describe(&e, true);
  for (int m = 0; m < 2; m++) {
    hk_run *run = open_run(&e, methods[m]);
    advance(&e, run, 0.5);
    alone[m] = copy_of(run);
    end(&e, run);
  }
  hk_run *both[2] = {open_run(&e, methods[0]), open_run(&e, methods[1])};
  for (int part = 1; part <= 10; part++)
    for (int m = 0; m < 2; m++) advance(&e, both[m], 3 * part / 60.0); /* at frames, where time is cut anyway */
  for (int m = 0; m < 2; m++) {
    assert_memory_equal(both[m]->state.X, alone[m], both[m]->state.size * sizeof(double));
    end(&e, both[m]);
    free(alone[m]);
  }
  test_engine_close(&e);
}

/* The bytes of the description and of every plugin's values. */
static uint64_t fingerprint(const hk_scene *scene) {
  uint64_t hash = 1469598103934665603u;
  const unsigned char *bytes = (const unsigned char *)scene;
  for (size_t k = 0; k < sizeof *scene; k++) hash = (hash ^ bytes[k]) * 1099511628211u;
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t p = 0; p < scene->plugin[kind].count; p++) {
      const hk_plugin_spec *spec = scene->plugin[kind].item[p];
      bytes = spec->values;
      for (size_t k = 0; k < spec->plugin->instance_size; k++) hash = (hash ^ bytes[k]) * 1099511628211u;
    }
  return hash;
}

static void a_run_leaves_the_scene_as_it_was(void **state) {
  (void)state;
  test_engine e;
  describe(&e, true);
  e.scene->frozen = true; /* as it is once a run has been made of it */
  uint64_t before = fingerprint(e.scene);
  hk_run *run = open_run(&e, "bdf2:tolerance=1e-4");
  advance(&e, run, 0.5);
  end(&e, run);
  assert_true(fingerprint(e.scene) == before);
  test_engine_close(&e);
}

/* Whatever a step needs has been opened before the first one. */
static void no_plugin_is_opened_inside_a_step(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "bdf2", "local_global", "dopri5"};
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
    test_engine e;
    describe(&e, false);
    hk_run *run = open_run(&e, methods[m]);
    size_t loaded = e.registry.count;
    advance(&e, run, 0.5);
    assert_int_equal(e.registry.count, loaded);
    end(&e, run);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_scene_can_be_run_twice_with_the_same_bits),
      cmocka_unit_test(a_scene_can_be_in_two_runs_at_once),
      cmocka_unit_test(a_run_leaves_the_scene_as_it_was),
      cmocka_unit_test(no_plugin_is_opened_inside_a_step),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
