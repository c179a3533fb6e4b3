/* The adjoint is the transpose of the tangents, up to rounding, whatever the number of steps between states kept. */
#include "tests/support/varied_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double start[VARIED_PARAMETERS] = {50, 0.7, 2, 0.3};

/* w . (dX/dp) of all tangents against the adjoint of w, relative to the sum of the sizes. */
static double mismatch(const char *method, size_t stride) {
  double w[24], slope[VARIED_PARAMETERS], worst = 0;
  varied_runs r;
  varied_open(&r, varied_tetrahedron, method, start, VARIED_PARAMETERS, 2e-3);
  varied_run(&r, 0.402);
  if (stride) { /* states are kept more seldom */
    r.s->stride *= stride;
    for (size_t k = 0; k * r.s->stride < r.s->steps; k++)
      memcpy(r.s->kept + k * 36, r.s->kept + k * stride * 36, 36 * sizeof *r.s->kept);
  }
  varied_tangents kept = {.numbers = VARIED_PARAMETERS * 36, .n = 4};
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_tangents(r.s, r.by, VARIED_PARAMETERS, varied_keep_tangents, &kept, &error), HK_OK);
  for (size_t e = 0; e < 24; e++) w[e] = cos(2.3 * (double)e);
  double back[24];
  memcpy(back, w, sizeof w);
  assert_int_equal(hk_sensitivity_adjoint(r.s, back, r.by, VARIED_PARAMETERS, slope, &error), HK_OK);
  for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
    double sum = 0, size = 0;
    for (size_t e = 0; e < 24; e++) {
      sum += w[e] * kept.last[36 * k + e];
      size += fabs(w[e] * kept.last[36 * k + e]);
    }
    worst = fmax(worst, fabs(sum - slope[k]) / size);
  }
  varied_close(&r);
  return worst;
}

static void adjoint_is_the_transpose_of_the_tangents(void **state) {
  (void)state;
  for (size_t m = 0; m < VARIED_METHODS; m++) {
    double off = mismatch(varied_method[m], 0);
    if (!(off < 1e-12)) fail_msg("%s: %g", varied_method[m], off);
  }
}

static void states_kept_more_seldom_change_nothing(void **state) {
  (void)state;
  assert_true(mismatch("leapfrog", 3) < 1e-12);
}

/* d(x_N)/d(v_0) of an oscillator, by the start: sin(N a) h/sin a of leapfrog, cos a = 1 - (h w)^2/2. */
static void oscillator(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0.1, 0, 0, 1);
  test_number(e, test_plugin(e, HK_FORCE, "central"), "strength", p[0]);
}

static void adjoint_gives_the_derivative_by_the_start(void **state) {
  (void)state;
  enum { N = 150 };
  const double h = 0.01, strength = 40, a = acos(1 - h * h * strength / 2);
  varied_runs r;
  varied_open(&r, oscillator, "leapfrog", (double[]){strength, 1, 1, 1}, 1, h);
  varied_run(&r, N * h);
  double X[6] = {1}, slope;
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_adjoint(r.s, X, r.by, 1, &slope, &error), HK_OK);
  assert_true(fabs(X[0] - cos(N * a)) < 1e-12);
  assert_true(fabs(X[3] - h * sin(N * a) / sin(a)) < 1e-12);
  double exact = -0.1 * N * sin(N * a) * h * h / (2 * sin(a));
  assert_true(fabs(slope - exact) < 1e-9 * fabs(exact));
  varied_close(&r);
}

/* By the values of a function of time at knots: together they are the derivative by a number. */
static void knots_share_the_derivative_by_a_number(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, varied_tetrahedron, "leapfrog", start, 1, 2e-3);
  varied_run(&r, 0.4);
  double values[5], number, slope, X[24] = {1, 0, 0.5};
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_adjoint(r.s, X, r.by, 1, &number, &error), HK_OK);
  for (size_t count = 2; count <= 5; count++) {
    double sum = 0, back[24] = {1, 0, 0.5};
    hk_knots knots = {.count = count, .begin = 0, .end = 0.4, .slope = values};
    r.by[0].knots = &knots;
    assert_int_equal(hk_sensitivity_adjoint(r.s, back, r.by, 1, &slope, &error), HK_OK);
    for (size_t k = 0; k < count; k++) sum += values[k];
    assert_true(fabs(sum - number) < 1e-12 * fabs(number));
    assert_true(fabs(slope - number) < 1e-12 * fabs(number));
    if (count == 5) assert_true(fabs(values[4]) < 0.1 * fabs(number)); /* late forces have hardly moved anything */
  }
  varied_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(adjoint_is_the_transpose_of_the_tangents),
      cmocka_unit_test(states_kept_more_seldom_change_nothing),
      cmocka_unit_test(adjoint_gives_the_derivative_by_the_start),
      cmocka_unit_test(knots_share_the_derivative_by_a_number),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
