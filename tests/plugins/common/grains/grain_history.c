/* What contacts remember, as a damaged checkpoint may have it: a number of touches that are not there, or particles
 * that are not. The run ends with a sentence; nothing is forgotten in silence. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct touch { /* as hk_grain_touch */
  uint32_t self, other;
  double anchor[3];
} touch;

static hk_plugin_spec *spec[2];

/* Three spheres in a row that overlap, on a floor. */
static void open_row(test_engine *e) {
  static const char *const name[] = {"soft_spheres", "soft_walls"};
  test_engine_open(e);
  e->options.dt = 1e-3;
  for (int k = 0; k < 3; k++) test_particle(e, 0.19 * k, 0, 0.095, 1);
  for (int k = 0; k < 2; k++) {
    spec[k] = test_plugin(e, HK_FORCE, name[k]);
    test_number(e, spec[k], "radius", 0.1);
    test_number(e, spec[k], "stiffness", 1000);
  }
  test_run(e);
  test_advance(e, 0.01);
}

static void *field_of(test_engine *e, int plugin, const char *name) {
  hk_instance *instance = test_instance(e, spec[plugin]);
  for (const hk_field *f = instance->plugin->fields; f && f->name; f++)
    if (strcmp(f->name, name) == 0) return hk_field_in(f, instance->self);
  fail_msg("no field %s", name);
  return NULL;
}

static void expect_damaged(test_engine *e) {
  hk_error error = {0};
  if (hk_run_advance(e->run, 0.02, &error) != HK_FAILED || !strstr(error.text, "the checkpoint is damaged"))
    fail_msg("it went on: %s", error.text);
  test_engine_close(e);
}

static void a_number_of_touches_that_are_not_there_is_refused(void **state) {
  (void)state;
  static const int64_t number[] = {-1, 1000000, INT64_MAX, INT64_MIN};
  for (int plugin = 0; plugin < 2; plugin++)
    for (size_t k = 0; k < sizeof number / sizeof *number; k++) {
      test_engine e;
      open_row(&e);
      *(int64_t *)field_of(&e, plugin, "count") = number[k];
      expect_damaged(&e);
    }
}

/* Neither dead ones, nor in another order, in which those behind would not be found. */
static void touches_of_particles_that_are_not_there_are_refused(void **state) {
  (void)state;
  for (int plugin = 0; plugin < 2; plugin++)
    for (int how = 0; how < 3 - plugin; how++) {
      test_engine e;
      open_row(&e);
      hk_array *list = field_of(&e, plugin, "touches"), copy = *list;
      touch *item = list->item;
      assert_true(*(int64_t *)field_of(&e, plugin, "count") >= 3);
      if (how == 0) item[0].self = 77;
      if (how == 1) item[0].self = 3;
      if (how == 2) item[0].other = 77;                /* of spheres; walls are numbers */
      touch *read = malloc(copy.count * sizeof *read); /* a checkpoint is read into other memory */
      assert_non_null(read);
      memcpy(read, item, copy.count * sizeof *read);
      list->item = read;
      hk_error error = {0};
      bool refused = hk_run_advance(e.run, 0.02, &error) == HK_FAILED && strstr(error.text, "checkpoint is damaged");
      list->item = copy.item;
      free(read);
      if (!refused) fail_msg("plugin %d, %d: it went on: %s", plugin, how, error.text);
      test_engine_close(&e);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_number_of_touches_that_are_not_there_is_refused),
      cmocka_unit_test(touches_of_particles_that_are_not_there_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
