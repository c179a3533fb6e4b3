/* Segments: two of them, one after the other, are the run, and the chain rule through their derivatives gives its
 * tangents. */
#include "tests/support/varied_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 24, COLUMNS = N + 2 * VARIED_PARAMETERS };

static const double start[VARIED_PARAMETERS] = {50, 0.7, 2, 0.3};

/* out = J x, of the first columns, and what both knots of parameter p add where it is larger by 1. */
static void through(const double *J, const double *x, size_t p, double *out) {
  for (size_t i = 0; i < N; i++) {
    out[i] = J[(N + 2 * p) * N + i] + J[(N + 2 * p + 1) * N + i];
    for (size_t c = 0; c < N; c++) out[i] += J[c * N + i] * x[c];
  }
}

/* How far segments lead from the run's end, and their derivatives from its tangents, relative to the largest. */
static bool compare(const char *method, double *end_off, double *tangent_off) {
  static double first[COLUMNS * N], second[COLUMNS * N];
  double X[N], size = 0;
  varied_runs r;
  varied_open(&r, varied_tetrahedron, method, start, VARIED_PARAMETERS, 2e-3);
  varied_run(&r, 0.402);
  hk_error error = {0};
  varied_tangents kept = {.numbers = VARIED_PARAMETERS * 36, .n = 4};
  assert_int_equal(hk_sensitivity_tangents(r.s, r.by, VARIED_PARAMETERS, varied_keep_tangents, &kept, &error), HK_OK);
  memcpy(X, r.s->start, sizeof X);
  size_t middle = r.s->steps / 3;
  assert_int_equal(hk_sensitivity_segment(r.s, 0, middle, X, r.by, VARIED_PARAMETERS, first, &error), HK_OK);
  assert_int_equal(hk_sensitivity_segment(r.s, middle, r.s->steps, X, r.by, VARIED_PARAMETERS, second, &error), HK_OK);
  *end_off = *tangent_off = 0;
  for (size_t e = 0; e < N; e++) *end_off = fmax(*end_off, fabs(X[e] - r.s->loop->state->X[e]));
  for (size_t p = 0; p < VARIED_PARAMETERS; p++) {
    double change[N], between[N], last[N];
    hk_sensitivity_start(&r.by[p], 4, change);
    through(first, change, p, between);
    through(second, between, p, last);
    for (size_t e = 0; e < N; e++) {
      size = fmax(size, fabs(kept.last[36 * p + e]));
      *tangent_off = fmax(*tangent_off, fabs(last[e] - kept.last[36 * p + e]));
    }
  }
  *tangent_off /= size;
  bool carries = r.s->method->carries;
  varied_close(&r);
  return carries;
}

/* Rounding of 200 steps. A method that carries an acceleration over has it of other velocities than those of the step's
 * end, by a h/2; a segment evaluates it anew, and is off by what drags of some 1/s make of that in one step: (h/2)^2 =
 * 1e-6 times their rates. */
static void two_segments_are_the_run_and_its_tangents(void **state) {
  (void)state;
  for (size_t m = 0; m < VARIED_METHODS; m++) {
    double end_off, tangent_off;
    bool carries = compare(varied_method[m], &end_off, &tangent_off);
    double most = carries ? 1e-5 : 1e-12;
    if (!(end_off < most && tangent_off < 10 * most)) fail_msg("%s: %g %g", varied_method[m], end_off, tangent_off);
  }
}

/* How far derivatives are from those of a segment, and second ones from differences of these by the state (c) and by
 * the parameters at the knots with the state, relative to the largest. */
static void compare_curvature(const char *method, double *slope_off, double *bend_off) {
  static double J[COLUMNS * N], H[COLUMNS * COLUMNS], more[COLUMNS * N], less[COLUMNS * N], plain[COLUMNS * N];
  double X[N], Y[N], weight[N], largest = 0, steepest = 0;
  const double by = 1e-4; /* leaves by^2 of the fourth derivatives, and eps/by of rounding */
  varied_runs r;
  varied_open(&r, varied_tetrahedron, method, start, VARIED_PARAMETERS, 2e-3);
  varied_run(&r, 0.05);
  hk_error error = {0};
  size_t last = r.s->steps;
  for (size_t e = 0; e < N; e++) weight[e] = 1 + 0.3 * (double)(e % 5);
  memcpy(X, r.s->start, sizeof X);
  assert_int_equal(hk_sensitivity_curvature(r.s, 0, last, X, r.by, VARIED_PARAMETERS, NULL, weight, J, H, &error),
                   HK_OK);
  memcpy(Y, r.s->start, sizeof Y);
  assert_int_equal(hk_sensitivity_segment(r.s, 0, last, Y, r.by, VARIED_PARAMETERS, plain, &error), HK_OK);
  *slope_off = *bend_off = 0;
  for (size_t e = 0; e < N; e++) *slope_off = fmax(*slope_off, fabs(X[e] - Y[e]));
  for (size_t e = 0; e < COLUMNS * N; e++) {
    steepest = fmax(steepest, fabs(plain[e]));
    *slope_off = fmax(*slope_off, fabs(J[e] - plain[e]));
  }
  for (size_t c = 0; c < N; c++) {
    memcpy(X, r.s->start, sizeof X);
    memcpy(Y, r.s->start, sizeof Y);
    X[c] += by;
    Y[c] -= by;
    assert_int_equal(hk_sensitivity_segment(r.s, 0, last, X, r.by, VARIED_PARAMETERS, more, &error), HK_OK);
    assert_int_equal(hk_sensitivity_segment(r.s, 0, last, Y, r.by, VARIED_PARAMETERS, less, &error), HK_OK);
    for (size_t b = 0; b < COLUMNS; b++) {
      double sum = 0;
      for (size_t i = 0; i < N; i++) sum += weight[i] * (more[b * N + i] - less[b * N + i]) / (2 * by);
      largest = fmax(largest, fabs(sum));
      *bend_off = fmax(*bend_off, fabs(sum - H[c * COLUMNS + b]));
      assert_true(H[c * COLUMNS + b] == H[b * COLUMNS + c]);
    }
  }
  *slope_off /= steepest;
  *bend_off /= largest;
  varied_close(&r);
}

/* First derivatives to rounding; second ones by one-sided differences of exact products over 1e-7 of the scene's size,
 * whose next term is a part of some 1e-7. */
static void curvature_is_the_difference_of_derivatives(void **state) {
  (void)state;
  for (size_t m = 0; m < VARIED_METHODS; m++) {
    double slope_off, bend_off;
    compare_curvature(varied_method[m], &slope_off, &bend_off);
    if (!(slope_off < 1e-13 && bend_off < 2e-6)) fail_msg("%s: %g %g", varied_method[m], slope_off, bend_off);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(two_segments_are_the_run_and_its_tangents),
                                     cmocka_unit_test(curvature_is_the_difference_of_derivatives)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
