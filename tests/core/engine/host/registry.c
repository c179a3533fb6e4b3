/* Plugins of other times: tables shorter or longer than the host's, and other interfaces. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* A particle of 2 kg, pulled by 1 N for 1 s: the constant force is integrated without error but for rounding. */
static void assert_pulls(const char *fixture) {
  test_engine e;
  test_engine_open(&e);
  uint32_t id = test_particle(&e, 0, 0, 0, 2);
  test_plugin(&e, HK_FORCE, fixture);
  test_run(&e);
  test_advance(&e, 1);
  assert_true(fabs(test_position(&e, id)[0] - 0.25) < 1e-12);
  assert_true(fabs(test_velocity(&e, id)[0] - 0.5) < 1e-12);
  test_engine_close(&e);
}

static void a_table_that_has_grown_since_is_filled_up_with_nothing(void **state) {
  (void)state;
  assert_pulls("fixture:short_table");
  test_engine e;
  test_engine_open(&e);
  const hk_force_tables *force = hk_force_of(test_plugin(&e, HK_FORCE, "fixture:short_table")->plugin);
  assert_non_null(force->own.energy);
  assert_null(force->own.rates);
  assert_null(force->own.facets);
  assert_null(force->elements.list);
  assert_null(force->implicit.jacobian);
  assert_null(force->steps.update);
  assert_null(force->steps.accepted);
  test_engine_close(&e);
}

static void of_a_longer_table_the_host_takes_what_it_knows(void **state) {
  (void)state;
  assert_pulls("fixture:long_table");
  test_engine e;
  test_engine_open(&e);
  const hk_force_tables *force = hk_force_of(test_plugin(&e, HK_FORCE, "fixture:long_table")->plugin);
  assert_non_null(force->bounds.stiffness_bound);
  assert_null(force->bounds.longest_step); /* of a facet that was shorter then */
  test_engine_close(&e);
}

/* Rows of fields have grown in the minor version 1. */
static void rows_of_fields_may_be_those_of_minor_0(void **state) {
  (void)state;
  assert_pulls("fixture:minor_zero");
}

static void a_plugin_of_the_first_interface_is_refused_in_one_sentence(void **state) {
  (void)state;
  test_engine e;
  const hk_plugin *plugin;
  test_engine_open(&e);
  hk_error error = {0};
  assert_int_equal(
      hk_registry_find(&e.registry, HK_FORCE, HK_BUILD "/tests/fixtures/first_abi.so", true, &plugin, &error),
      HK_FAILED);
  assert_non_null(strstr(error.text, "it was built for plugin interface 1.0 and this hooke has 3.5: build it again"));
  assert_non_null(strstr(error.text, "first_abi.so"));
  test_engine_close(&e);
}

/* By the folder's list: the first that suits, and no more plugins are opened than are looked at. */
static bool suits(const hk_plugin *plugin, const void *context) {
  return (plugin->solver->flags & HK_SOLVES_UNSYMMETRIC) == *(const unsigned *)context;
}

static void the_installations_order_of_preference_decides(void **state) {
  (void)state;
  test_engine e;
  const hk_plugin *plugin;
  unsigned unsymmetric = 0;
  test_engine_open(&e);
  assert_int_equal(hk_registry_prefer(&e.registry, HK_SOLVER, suits, &unsymmetric, &plugin, &e.error), HK_OK);
  assert_int_equal(e.registry.count, 1);
  unsymmetric = HK_SOLVES_UNSYMMETRIC;
  assert_int_equal(hk_registry_prefer(&e.registry, HK_SOLVER, suits, &unsymmetric, &plugin, &e.error), HK_OK);
  assert_true(plugin->solver->flags & HK_SOLVES_UNSYMMETRIC);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_table_that_has_grown_since_is_filled_up_with_nothing),
      cmocka_unit_test(of_a_longer_table_the_host_takes_what_it_knows),
      cmocka_unit_test(rows_of_fields_may_be_those_of_minor_0),
      cmocka_unit_test(a_plugin_of_the_first_interface_is_refused_in_one_sentence),
      cmocka_unit_test(the_installations_order_of_preference_decides),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
