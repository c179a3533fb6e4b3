/* The computing times of plugins in a summary add up to the time of the steps, whatever the samples say. */
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static void start(test_engine *e) {
  test_engine_open(e);
  for (int i = 0; i < 3; i++) test_particle(e, i, 0, 0, 1);
  hk_plugin_spec *bars = test_plugin(e, HK_CONSTRAINT, "bars");
  test_edges(e, bars, (const uint32_t[][2]){{1, 2}}, 1);
  test_plugin(e, HK_FORCE, "gravity");
  hk_plugin_spec *drag = test_plugin(e, HK_FORCE, "drag");
  test_number(e, drag, "rate", 1);
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  e->scene->duration = 1;
  e->options.dt = 1e-2;
  test_run(e);
  test_advance(e, 1);
}

/* Of the plugins whose times are not within those of others; *integrator: its own. */
static double sum_of(test_engine *e, double *integrator) {
  hk_summary s = {0};
  double sum = 0;
  hk_run_summary(e->run, &s);
  for (size_t k = 0; k < s.plugins; k++) {
    const hk_plugin_time *p = &s.plugin[k];
    if (strcmp(p->kind, "integrator") == 0) *integrator = p->seconds;
    if (strcmp(p->kind, "solver") != 0 && strcmp(p->kind, "service") != 0) sum += p->seconds;
    assert_true(p->seconds >= 0);
  }
  return sum;
}

static void times_add_up_to_that_of_the_steps(void **state) {
  (void)state;
  test_engine e;
  double integrator = NAN;
  start(&e);
  double loop = e.run->loop.seconds;
  assert_true(fabs(sum_of(&e, &integrator) - loop) < 1e-9 * loop); /* rounding */
  /* As if every sample had waited for another program, half a second in a loop of some milliseconds. */
  hk_plugins *all = &e.run->plugins;
  for (size_t k = 0; k < all->kind[HK_FORCE].count; k++) all->kind[HK_FORCE].item[k]->seconds += 0.5;
  assert_true(fabs(sum_of(&e, &integrator) - loop) < 1e-9 * loop);
  assert_true(integrator == 0);
  all->kind[HK_CONSTRAINT].item[0]->seconds += 0.5;
  assert_true(fabs(sum_of(&e, &integrator) - loop) < 1e-9 * loop);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(times_add_up_to_that_of_the_steps)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
