/* What methods state of their stages are their steps. */
#include "tests/support/varied_scenes.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static const double start[VARIED_PARAMETERS] = {50, 0.7, 2, 0.3};

/* 200 steps add up roundings of 1e-16 each, and those of implicit methods algebraic errors of up to 1e-12 m/s. The
 * length of a step changes on the way, and an acceleration that leapfrog carries over is then evaluated anew. */
static void steps_taken_again_are_those_of_the_method(void **state) {
  (void)state;
  for (size_t m = 0; m < VARIED_ALL; m++) {
    varied_runs r;
    varied_open(&r, varied_tetrahedron, varied_method[m], start, 0, 2e-3);
    varied_run(&r, 0.4013);
    assert_true(r.s->step[r.s->steps - 1].h != r.s->step[0].h);
    varied_tangents kept = {.n = 4};
    hk_error error = {0};
    assert_int_equal(hk_sensitivity_tangents(r.s, r.by, 0, varied_keep_tangents, &kept, &error), HK_OK);
    for (size_t e = 0; e < 24; e++)
      if (!(fabs(kept.X[e] - r.base.run->state.X[e]) < (m < VARIED_METHODS ? 1e-13 : 200e-12)))
        fail_msg("%s: %g", varied_method[m], kept.X[e] - r.base.run->state.X[e]);
    varied_close(&r);
  }
}

/* As of a method that states its stages wrongly. */
static void other_steps_than_those_of_the_method_are_found(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, varied_tetrahedron, "leapfrog", start, 0, 2e-3);
  hk_stages_facet wrong = *r.s->method;
  wrong.v_end[0] += 1e-3;
  wrong.v_end[1] -= 1e-3;
  r.s->method = &wrong;
  hk_error error = {0};
  test_advance(&r.base, 0.4);
  assert_int_equal(hk_sensitivity_finish(r.s, &error), HK_FAILED);
  varied_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_taken_again_are_those_of_the_method),
      cmocka_unit_test(other_steps_than_those_of_the_method_are_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
