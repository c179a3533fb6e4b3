/* Derivatives of functions of time: as good as the functions' own roundings allow at any time and for any speed, and
 * never wild at corners and jumps. */
#include "core/numerics/functions/functions.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.141592653589793;

typedef struct course {
  double (*at)(double t);
  double begin; /* s; it fails before */
  size_t calls;
} course;

static hk_status call(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                      size_t max_out, size_t *n_out, hk_error *error) {
  course *c = f->context;
  (void)caller, (void)n_in, (void)max_out;
  c->calls++;
  if (in[0] < c->begin) return hk_error_set(error, HK_SCRIPT, "too early");
  memcpy(out, (double[]){c->at(in[0]), 0, 1}, 3 * sizeof *out);
  *n_out = 3;
  return HK_OK;
}

static hk_derivative find(course *c, int order, hk_differences by, double t) {
  hk_function f = {.call = call, .context = c};
  hk_derivative d;
  hk_error error = {0};
  double at[HK_RESULTS] = {0};
  size_t got;
  c->begin = c->begin != 0 ? c->begin : -INFINITY;
  assert_int_equal(call(&f, NULL, &t, 1, at, HK_RESULTS, &got, &error), HK_OK);
  c->calls = 0;
  assert_int_equal(hk_derivative_find(&f, order, 0, &by, t, at, &d, &error), HK_OK);
  assert_true(d.value[1] == 0 && d.value[2] == 0);
  return d;
}

static hk_differences step_for(course *c, int order, double end) {
  hk_function f = {.call = call, .context = c};
  c->begin = -INFINITY;
  return hk_derivative_prepare(&f, order, 0, 0, end);
}

/* The phase of a clock that began long ago: its roundings are larger than those of t. */
static double shakes_since_long(double t) { return 0.01 * sin(2 * pi * 1000 * (t + 5.8943689)); }
static double shakes(double t) { return 0.01 * sin(2 * pi * 1000 * t); }
static double drifts(double t) { return 50 * sin(2 * pi * t / 36000); }
static double hums(double t) { return 1e-6 * cos(2 * pi * 40000 * t); }
static double orbits(double t) { return 1.5e11 * cos(2 * pi * t / 3.15e7); }
static double begins_to_shake(double t) { return t < 1000 ? 1e-5 * t * t : 10 + 0.01 * (1 - cos(2 * pi * 1000 * t)); }

/* The error is below its estimate, and both are below 1e-6 of the largest derivative; the bound is what the rounding of
 * w t leaves: eps w t divided by the best w h, some 1e-2, for 1 kHz at 2,000 s. */
static void is_good(course *c, int order, double w, double amplitude, double end, double bound) {
  hk_differences by = step_for(c, order, end);
  uint64_t random[4];
  hk_random_seed(random, 7);
  for (int k = 0; k < 1000; k++) {
    double t = end * hk_random_uniform(random), size = amplitude * pow(w, order);
    double right = c->at == hums || c->at == orbits ? (order == 1 ? -amplitude * w * sin(w * t) : -size * cos(w * t))
                                                    : (order == 1 ? size * cos(w * t) : -size * sin(w * t));
    hk_derivative d = find(c, order, by, t);
    double error = fabs(d.value[0] - right);
    if (error > 3 * d.error || error > bound * size || d.error > 100 * bound * size)
      fail_msg("order %d, t = %.17g: %g, right is %g, off by %g of %g, estimate %g, step %g", order, t, d.value[0],
               right, error / size, size, d.error / size, d.step);
  }
}

static void speeds_are_as_good_as_the_roundings_allow(void **state) {
  (void)state;
  is_good(&(course){.at = shakes}, 1, 2 * pi * 1000, 0.01, 2000, 1e-6);
  is_good(&(course){.at = shakes}, 1, 2 * pi * 1000, 0.01, 1, 1e-9);
  is_good(&(course){.at = drifts}, 1, 2 * pi / 36000, 50, 36000, 1e-9);
  is_good(&(course){.at = hums}, 1, 2 * pi * 40000, 1e-6, 1, 1e-7);
  is_good(&(course){.at = orbits}, 1, 2 * pi / 3.15e7, 1.5e11, 3e8, 1e-8);
}

static void accelerations_are_as_good_as_the_roundings_allow(void **state) {
  (void)state;
  is_good(&(course){.at = shakes}, 2, 2 * pi * 1000, 0.01, 2000, 1e-5);
  is_good(&(course){.at = drifts}, 2, 2 * pi / 36000, 50, 36000, 1e-7);
  is_good(&(course){.at = orbits}, 2, 2 * pi / 3.15e7, 1.5e11, 3e8, 1e-6);
}

/* The rounding of t + 5.9 is 4e-16 s; with the best step of 1e-4 s that is 4e-12 of the speed, and more a few times. */
static void the_roundings_of_the_function_itself_count(void **state) {
  (void)state;
  course c = {.at = shakes_since_long};
  double w = 2 * pi * 1000;
  hk_differences by = step_for(&c, 1, 0.02);
  for (int k = 0; k < 4000; k++) {
    double t = 5e-6 * k, right = 0.01 * w * cos(w * (t + 5.8943689));
    hk_derivative d = find(&c, 1, by, t);
    if (!(fabs(d.value[0] - right) < 1e-9 * 0.01 * w)) fail_msg("t = %g: %.17g, not %.17g", t, d.value[0], right);
  }
}

static void the_step_follows_what_begins_later(void **state) {
  (void)state;
  course c = {.at = begins_to_shake};
  hk_differences by = step_for(&c, 1, 1e6);
  for (double t = 1000.0005; t < 1001; t += 0.0625) {
    double w = 2 * pi * 1000, right = 0.01 * w * sin(w * t);
    assert_true(fabs(find(&c, 1, by, t).value[0] - right) < 1e-6 * 0.01 * w);
  }
}

static double corner(double t) { return 2 * fabs(t - 3); }
static double jump(double t) { return t < 3 ? 5 * t : 100 + 7 * t; }

/* Between the two slopes at a corner; beside a jump the slope of that side, however near. 1e-6: roundings of 120 m. */
static void corners_and_jumps_give_no_wild_speed(void **state) {
  static const double off[] = {1e-9, 1e-7, 1e-6, 1e-5, 2e-5, 1e-4, 1e-3};
  course bend = {.at = corner}, leap = {.at = jump};
  (void)state;
  for (size_t k = 0; k < sizeof off / sizeof *off; k++)
    for (int side = -1; side <= 1; side += 2) {
      double t = 3 + side * off[k];
      hk_differences by = step_for(&bend, 1, 6);
      assert_true(fabs(find(&bend, 1, by, t).value[0] - 2 * side) < 1e-6);
      double found = find(&leap, 1, step_for(&leap, 1, 6), t).value[0];
      if (!(fabs(found - (side < 0 ? 5 : 7)) < 1e-6)) fail_msg("beside a jump by %g: %.9g", side * off[k], found);
    }
  assert_true(fabs(find(&bend, 1, (hk_differences){1e-5, 0}, 3).value[0]) < 1e-9);
  assert_true(fabs(find(&leap, 1, (hk_differences){1e-5, 0}, 3).value[0] - 7) < 1e-6);
}

static double root(double t) { return t * sqrt(t); }

static void a_function_that_fails_before_its_start_has_a_speed_there(void **state) {
  (void)state;
  course c = {.at = root, .begin = 1};
  assert_true(fabs(find(&c, 1, (hk_differences){1e-5, 0}, 1).value[0] - 1.5) < 1e-8);
}

/* Rest and even motion are exact within roundings, and cost six calls. */
static double still(double t) { return 0 * t + 0.3; }
static void what_is_easy_is_cheap(void **state) {
  (void)state;
  course rest = {.at = still}, shaking = {.at = shakes};
  hk_differences by = step_for(&rest, 1, 10);
  double calls = 0;
  assert_true(find(&rest, 1, by, 5).value[0] == 0);
  assert_int_equal(rest.calls, 6);
  by = step_for(&shaking, 1, 10);
  for (int k = 0; k < 1000; k++) {
    find(&shaking, 1, by, 0.0101234 * k);
    calls += (double)shaking.calls;
  }
  if (!(calls < 8 * 1000)) fail_msg("%g calls", calls / 1000);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(speeds_are_as_good_as_the_roundings_allow),
      cmocka_unit_test(accelerations_are_as_good_as_the_roundings_allow),
      cmocka_unit_test(the_roundings_of_the_function_itself_count),
      cmocka_unit_test(the_step_follows_what_begins_later),
      cmocka_unit_test(corners_and_jumps_give_no_wild_speed),
      cmocka_unit_test(a_function_that_fails_before_its_start_has_a_speed_there),
      cmocka_unit_test(what_is_easy_is_cheap),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
