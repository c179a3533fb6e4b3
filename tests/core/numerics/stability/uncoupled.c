/* The spectrum of scenes whose particles stand alone: the same as by iteration, as far as that is sharp, against closed
 * forms, and left to the iteration where it cannot be had from blocks or the blocks are wrong. */
#include "core/numerics/stability/uncoupled.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Of more particles than are taken at once, the last one of them the stiffest. */
static void open_cloud(test_engine *e, size_t n) {
  test_engine_open(e);
  for (size_t i = 0; i < n; i++)
    test_particle(e, sin((double)i), cos(1.7 * (double)i), 0.3 * sin(3 * (double)i), i + 1 < n ? 2 : 0.1);
  for (size_t c = 0; c < 3 * n; c++) e->scene->particles.velocity[c] = sin(1.3 * (double)c);
  e->options.dt = 1e-4;
}

static hk_plugin_spec *number(test_engine *e, const char *plugin, const char *name, double value) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, plugin);
  test_number(e, spec, name, value);
  return spec;
}

/* By blocks, and by iteration, which is never below and at most 6 % (of w) and 12.5 % + 0.03 w (of g) above. */
static void is_that_of_the_iteration(test_engine *e) {
  hk_spectrum blocks, iterated;
  test_run(e);
  hk_system *s = &e->run->dynamics.system;
  assert_true(hk_uncoupled_spectrum(s, &blocks));
  e->run->dynamics.queries.uncoupled = NULL;
  assert_int_equal(hk_spectrum_estimate(s, &iterated, &e->error), HK_OK);
  if (!(blocks.w_max <= iterated.w_max * (1 + 1e-7) && iterated.w_max <= 1.06 * blocks.w_max &&
        blocks.g_max <= iterated.g_max * (1 + 1e-7) && iterated.g_max <= 1.125 * blocks.g_max + 0.03 * blocks.w_max &&
        fabs(blocks.alpha - iterated.alpha) <= 1e-6 * blocks.g_max &&
        fabs(blocks.b_max - iterated.b_max) <= 1e-6 * iterated.b_max))
    fail_msg("w %.9g, %.9g; g %.9g, %.9g; b %.9g, %.9g; alpha %.9g, %.9g", blocks.w_max, iterated.w_max, blocks.g_max,
             iterated.g_max, blocks.b_max, iterated.b_max, blocks.alpha, iterated.alpha);
  test_engine_close(e);
}

static void blocks_and_iteration_agree(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    test_engine e;
    open_cloud(&e, k == 3 ? 3 : 700);
    hk_plugin_spec *pull = number(&e, "central", "strength", 3);
    test_number(&e, pull, "power", k == 1 ? -2 : 1);
    test_number(&e, pull, "softening", 0.3);
    if (k != 1) number(&e, "drag", "d", k == 2 ? 5 : 0.1);
    if (k == 2) test_vector(&e, number(&e, "magnetic", "ratio", 1), "B", 0, 0.5, 2);
    test_plugin(&e, HK_FORCE, "gravity");
    if (k == 3) test_pin(&e, HK_PIN_FIXED, 3, NULL);
    is_that_of_the_iteration(&e);
  }
}

/* w^2 = strength/m per particle and g = d/m, of the lightest one. */
static void spectrum_by_hand(void **state) {
  (void)state;
  test_engine e;
  hk_spectrum s;
  open_cloud(&e, 600);
  test_text(&e, number(&e, "central", "strength", 3), "per", "particle");
  hk_plugin_spec *drag = number(&e, "drag", "d", 0.2);
  drag->only = calloc(1, sizeof *drag->only);
  drag->only[0] = 599, drag->only_count = 1;
  test_run(&e);
  assert_true(hk_uncoupled_spectrum(&e.run->dynamics.system, &s));
  assert_true(fabs(s.w_max - sqrt(30)) < 1e-7 && fabs(s.g_max - 2) < 1e-7 && s.alpha == 0 && s.b_max == 0 &&
              s.rigorous);
  test_engine_close(&e);
}

static void refused(test_engine *e) {
  hk_spectrum s = {.w_max = 77};
  test_run(e);
  assert_true(!hk_uncoupled_spectrum(&e->run->dynamics.system, &s) && s.w_max == 77);
  test_engine_close(e);
}

/* Springs; a pin that slides; blocks of the wrong sign; forces beyond all numbers; all are for the iteration. */
static void what_is_not_alone_or_not_right_is_left_to_the_iteration(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    test_engine e;
    open_cloud(&e, 20);
    if (k == 3) test_particle(&e, 9, 0, 0, 1);
    test_number(&e, number(&e, "central", "strength", k == 3 ? 1e300 : 3), "power", k == 3 ? 20 : 1);
    if (k == 0) {
      hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
      test_edges(&e, springs, (const uint32_t[][2]){{1, 2}}, 1);
      test_number(&e, springs, "k", 5);
    }
    if (k == 1) test_pin(&e, HK_PIN_LINE, 2, (const double[3]){0, 0, 1});
    if (k == 2) test_plugin(&e, HK_FORCE, "fixture:wrong_jacobian");
    refused(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blocks_and_iteration_agree),
      cmocka_unit_test(spectrum_by_hand),
      cmocka_unit_test(what_is_not_alone_or_not_right_is_left_to_the_iteration),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
