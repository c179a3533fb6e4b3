/* Births and deaths: nothing may assume a constant number of particles. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* A chain of `n` particles one metre apart with springs between neighbours. */
static hk_plugin_spec *chain(test_engine *e, uint32_t n) {
  uint32_t edge[64][2];
  for (uint32_t i = 0; i < n; i++) test_particle(e, i, 0, 0, 1);
  for (uint32_t i = 0; i + 1 < n; i++) edge[i][0] = i + 1, edge[i][1] = i + 2;
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, n - 1);
  test_number(e, springs, "k", 100);
  return springs;
}

static void births_append_new_ids_and_keep_the_old(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  chain(&e, 3);
  hk_plugin_spec *emitter = test_plugin(&e, HK_SOURCE, "fixture:spout");
  test_number(&e, emitter, "every", 0.25);
  e.options.dt = 1.0 / 64;
  e.scene->fps = 4;
  test_run(&e);
  test_advance(&e, 1);
  const hk_view *view = hk_run_view(e.run);
  assert_int_equal(view->n, 3 + 4); /* at t = 0, 0.25, 0.5, 0.75 */
  for (size_t i = 0; i < view->n; i++) assert_int_equal(view->model->id[i], i + 1);
  assert_true(fabs(test_position(&e, 2)[0] - 1) < 1e-12); /* springs at rest: nothing moved them */
  assert_int_equal((uintptr_t)e.run->state.X % 64, 0);
  test_engine_close(&e);
}

static void deaths_close_ranks_and_take_their_springs(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  hk_plugin_spec *springs = chain(&e, 5);
  hk_plugin_spec *emitter = test_plugin(&e, HK_SOURCE, "fixture:spout");
  test_number(&e, emitter, "every", 100);
  test_number(&e, emitter, "lifetime", 0.4);
  e.options.dt = 1.0 / 64;
  test_run(&e);
  test_advance(&e, 1);
  const hk_view *view = hk_run_view(e.run);
  assert_int_equal(view->n, 5 + 1 - 2);
  assert_int_equal(view->model->id[0], 3); /* 1 and 2 died */
  assert_null(test_position(&e, 1));
  const hk_param *edges = hk_spec_param(springs, "edges", &e.error);
  assert_non_null(edges);
  const hk_tuples *left = hk_param_in(edges, test_instance(&e, springs)->self);
  assert_int_equal(left->count, 2);
  assert_int_equal(left->index[0], 0);
  assert_int_equal(view->model->element_list[0].elements.node.count, 2);
  test_engine_close(&e);
}

/* What the springs do to the others does not change when a particle that hangs on none is born before and dies. */
static void strangers_do_not_disturb(void **state) {
  (void)state;
  double with[3], without[3];
  for (int births = 0; births < 2; births++) {
    test_engine e;
    test_engine_open(&e);
    chain(&e, 4);
    e.scene->particles.position[0] = -0.5;
    if (births) test_number(&e, test_plugin(&e, HK_SOURCE, "fixture:spout"), "every", 10);
    e.options.integrator = "symplectic_euler"; /* keeps no history that a birth would restart */
    e.options.dt = 1.0 / 480;
    test_run(&e);
    test_advance(&e, 0.5);
    memcpy(births ? with : without, test_position(&e, 1), sizeof with);
    test_engine_close(&e);
  }
  assert_memory_equal(with, without, sizeof with); /* the same operations in the same order: bitwise */
}

static void newborn_without_mass_is_refused(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_number(&e, test_plugin(&e, HK_SOURCE, "fixture:spout"), "mass", -1);
  test_run(&e);
  assert_int_equal(hk_run_advance(e.run, 1, &e.error), HK_FAILED);
  assert_non_null(strstr(e.error.text, "spout: a newborn's mass must be positive"));
  test_engine_close(&e);
}

static void a_scene_may_begin_empty_with_a_source(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_plugin(&e, HK_FORCE, "gravity");
  test_number(&e, test_plugin(&e, HK_SOURCE, "fixture:spout"), "every", 0.1);
  test_run(&e);
  test_advance(&e, 1);
  assert_int_equal(hk_run_view(e.run)->n, 10);
  test_engine_close(&e);
}

/* Grains fall from a source while allocation k of the plugins fails, for every k until the run goes: a status and a
 * cause each time. Where births could not be told to all plugins, the summary asks none of them for an energy. */
static void without_memory_at_a_birth_the_run_ends_and_has_a_summary(void **state) {
  (void)state;
  hk_summary s;
  long k = 1, unknown = 0;
  for (bool went = false; !went; k++) {
    test_engine e;
    test_engine_open(&e);
    for (int i = 0; i < 3; i++) test_particle(&e, 0.19 * i, 0, 0, 1);
    hk_plugin_spec *grains = test_plugin(&e, HK_FORCE, "soft_spheres");
    test_number(&e, grains, "radius", 0.1);
    test_number(&e, grains, "stiffness", 100);
    hk_plugin_spec *spout = test_plugin(&e, HK_SOURCE, "fixture:spout");
    test_number(&e, spout, "every", 0.1);
    test_number(&e, spout, "lifetime", 0.15);
    e.options.dt = 1.0 / 64;
    e.options.integrator = "leapfrog";
    e.options.allocations = k;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    if (status == HK_OK) status = hk_run_advance(e.run, 0.4, &e.error);
    went = status == HK_OK;
    if (e.run) hk_run_summary(e.run, &s);
    unknown += e.run && !went && isnan(s.energy_last);
    if (!went && (status != HK_NO_MEMORY || !strstr(e.error.text, "no memory")))
      fail_msg("allocation %ld: status %d, %s", k, (int)status, e.error.text);
    test_engine_close(&e);
  }
  assert_true(k > 20 && unknown > 5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(births_append_new_ids_and_keep_the_old),
      cmocka_unit_test(deaths_close_ranks_and_take_their_springs),
      cmocka_unit_test(strangers_do_not_disturb),
      cmocka_unit_test(newborn_without_mass_is_refused),
      cmocka_unit_test(without_memory_at_a_birth_the_run_ends_and_has_a_summary),
      cmocka_unit_test(a_scene_may_begin_empty_with_a_source),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
