/* Figures of a corrector: in the summary as text and JSON, and a run whose figure is beyond its limit is not ok. */
#include "core/run/report/report.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void run(test_engine *e, double figure, hk_summary *s) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 1);
  test_plugin(e, HK_FORCE, "gravity");
  hk_plugin_spec *pacer = test_plugin(e, HK_CORRECTOR, "fixture:pacer");
  test_number(e, pacer, "figure", figure);
  e->options.integrator = "leapfrog";
  e->options.dt = 1e-2;
  e->scene->duration = 0.1;
  test_run(e);
  test_advance(e, 0.1);
  assert_int_equal(hk_run_close(e->run, &e->error), HK_OK);
  hk_run_summary(e->run, s);
}

static void a_figure_beyond_its_limit_is_not_ok(void **state) {
  (void)state;
  for (int sign = -1; sign <= 1; sign += 2)
    for (int beyond = 0; beyond < 2; beyond++) {
      test_engine e;
      hk_summary s;
      run(&e, sign * (beyond ? 1.25 : 0.75), &s);
      assert_int_equal(s.verdict, beyond ? HK_INACCURATE : HK_VERDICT_OK);
      const char *words = sign < 0 ? "pacer: width is -1.25 m, and 1 is the most that is ok"
                                   : "pacer: width is 1.25 m, and 1 is the most that is ok";
      if (beyond && !strstr(s.reason, words)) fail_msg("'%s' in: %s", words, s.reason);
      test_engine_close(&e);
    }
}

static char *printed(const hk_summary *s, bool json) {
  static char text[16384];
  memset(text, 0, sizeof text);
  FILE *f = fmemopen(text, sizeof text - 1, "w");
  assert_non_null(f);
  if (json)
    hk_report_json(f, s);
  else
    hk_report_text(f, s, NULL);
  fclose(f);
  return text;
}

static void figures_are_in_the_summary(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  run(&e, 0.5, &s);
  assert_non_null(strstr(printed(&s, false), "  pacer             width 0.5 m, first 9.81 m/s^2\n"));
  assert_non_null(strstr(printed(&s, true), "\"figures\":{\"width\":0.5,\"first\":9.8"));
  assert_non_null(strstr(printed(&s, true), ",\"unknown\":null}"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_figure_beyond_its_limit_is_not_ok),
      cmocka_unit_test(figures_are_in_the_summary),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
