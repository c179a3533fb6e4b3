/* What melt publishes, and what it refuses: tables that do not rise, temperatures outside one. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *melt(test_engine *e, double h) {
  test_engine_open(e);
  assert_int_equal(hk_scene_add_channel(e->scene, "enthalpy", 1, &h, NAN, NULL, &e->error), HK_OK);
  test_particle(e, 0, 0, 0, 1);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "melt");
  test_text(e, spec, "channel", "enthalpy");
  test_number(e, spec, "viscosity", 4);
  test_number(e, spec, "capacity", 2);
  e->options.dt = 0.01;
  return spec;
}

static double published(test_engine *e, const char *name) {
  const hk_model *m = hk_run_view(e->run)->model;
  for (size_t k = 0; k < m->publications; k++)
    if (strcmp(m->published[k].name, name) == 0) return (*m->published[k].values)[0];
  fail_msg("%s is not published", name);
  return NAN;
}

/* A tenth of a second at 5 J/(kg s) after 280 K: 0.25 K more. */
static void it_publishes_the_present_state(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = melt(&e, -20);
  test_number(&e, spec, "solidus", 290);
  test_number(&e, spec, "latent", 100);
  test_number(&e, spec, "slope", 600);
  hk_plugin_spec *heating = test_plugin(&e, HK_FORCE, "heating");
  test_text(&e, heating, "channel", "enthalpy");
  test_number(&e, heating, "capacity", 2);
  test_number(&e, heating, "power", 5);
  test_run(&e);
  test_advance(&e, 0.1);
  double T = published(&e, "temperature"); /* of the last evaluation, at most a step before the end */
  assert_true(T <= 280.25 && T > 280.2 && published(&e, "molten") == 0);
  assert_true(fabs(published(&e, "local_viscosity") / (4 * exp(600 / T)) - 1) < 1e-12);
  test_engine_close(&e);
}

static void refuses(const double *T, const double *factor, size_t count, const char *sentence) {
  test_engine e;
  hk_plugin_spec *spec = melt(&e, 2 * 500);
  test_list(&e, spec, "temperatures", T, 2);
  test_list(&e, spec, "factors", factor, count);
  test_text(&e, spec, "outside", "refused");
  assert_int_not_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_OK);
  if (!strstr(e.error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e.error.text);
  test_engine_close(&e);
}

static void tables_that_cannot_be_are_refused(void **state) {
  (void)state;
  refuses((double[]){200, 400}, (double[]){1, 2}, 1, "factors: there are 1, and 2 temperatures");
  refuses((double[]){200, 200}, (double[]){1, 2}, 2, "temperatures: number 2, 200 K, is not above the one before");
  refuses((double[]){200, 400}, (double[]){1, 0}, 2, "factors: number 2 is 0, and a viscosity is above 0");
  refuses((double[]){200, 400}, (double[]){1, 2}, 2,
          "temperatures: particle 1 has 500 K at t = 0 s, outside the table from 200 to 400 K");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(it_publishes_the_present_state),
      cmocka_unit_test(tables_that_cannot_be_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
