/* Where a function of time varies between evaluations: pulses of any length below their distance, wherever they begin,
 * and not what evaluations follow. */
#include "core/numerics/functions/functions.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static const double gap = 1.0 / 60, end = 1;
enum { SAMPLES = 20000 };

static double distance(const void *context, double t) {
  (void)context;
  (void)t;
  return gap;
}

/* `of` at random times, as the run of a scene is sampled. */
static hk_rapid found_of(double (*of)(const double *, double), const double *how) {
  hk_sample *item = calloc(SAMPLES, sizeof *item);
  hk_samples list = {.item = item, .count = SAMPLES};
  hk_rapid found = {0};
  uint64_t bits = 88172645463325252u;
  double low = INFINITY, high = -INFINITY;
  assert_non_null(item);
  for (size_t k = 0; k < SAMPLES; k++) {
    bits ^= bits << 13, bits ^= bits >> 7, bits ^= bits << 17;
    item[k].t = ((double)k + (double)(bits >> 11) * 0x1p-53) * end / SAMPLES;
    item[k].value[0] = of(how, item[k].t);
    low = fmin(low, item[k].value[0]);
    high = fmax(high, item[k].value[0]);
  }
  list.range[0] = high - low;
  hk_rapid_find(&found, &list, distance, NULL);
  free(item);
  return found;
}

static double pulse(const double *how, double t) { return t >= how[0] && t <= how[0] + how[1] ? 1 : 0; }

/* A sample is 5e-5 s from the next one, 1/333 of the distance of evaluations. */
static void a_pulse_shorter_than_the_gap_is_found_wherever_it_begins(void **state) {
  (void)state;
  for (int k = 0; k < 200; k++) {
    double how[2] = {0.3 + 0.0137 * k / 200, gap * (0.02 + 0.97 * fmod(k * 0.618034, 1))};
    hk_rapid found = found_of(pulse, how);
    if (!found.varies || found.pieces != 1) fail_msg("%g s from %g s: %zu pieces", how[1], how[0], found.pieces);
    assert_true(found.piece[0][0] <= how[0] + 1e-9 && found.piece[0][1] >= how[0] + how[1] - 1e-9);
    assert_true(found.piece[0][1] - found.piece[0][0] < how[1] + 3e-4);
    assert_true(fabs(found.shortest - how[1]) < 3e-4);
  }
}

static double sine(const double *how, double t) { return sin(2 * 3.141592653589793 * how[0] * t + how[1]); }

static void what_is_followed_is_not_rapid(void **state) {
  (void)state;
  for (int k = 0; k < 40; k++) {
    double per_period = 4 + 0.5 * k, how[2] = {1 / (gap * per_period), 0.37 * k};
    if (found_of(sine, how).varies) fail_msg("a sine with %g evaluations in a period", per_period);
  }
}

static void a_vibration_is_found_in_all_its_length(void **state) {
  (void)state;
  for (int k = 0; k < 10; k++) {
    double per_period = 0.3 + 0.17 * k, how[2] = {1 / (gap * per_period), 0.37 * k};
    hk_rapid found = found_of(sine, how);
    assert_true(found.varies && found.pieces >= 1);
    double covered = 0;
    for (size_t p = 0; p < found.pieces; p++) covered += found.piece[p][1] - found.piece[p][0];
    if (!(covered > 0.9 * end)) fail_msg("%g evaluations in a period: %g s of %g s", per_period, covered, end);
    assert_true(found.shortest < gap * per_period);
  }
}

static double step(const double *how, double t) { return (t < how[0] ? -1 : 1) + how[1] * t; }

/* Samples that corner it: found_of's are too far apart. */
static hk_status call_step(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                           size_t max_out, size_t *n_out, hk_error *error) {
  (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = step(f->context, in[0]);
  *n_out = 1;
  return HK_OK;
}

static void a_jump_is_none_on_any_slope(void **state) {
  (void)state;
  for (int k = 0; k < 9; k++) {
    double how[2] = {0.437, 40.0 * (k - 4)};
    hk_function f = {.call = call_step, .context = how};
    hk_samples list;
    hk_rapid found = {0};
    hk_samples_take(&list, &f, 0, 1, 5000, 10000);
    hk_rapid_find(&found, &list, distance, NULL);
    hk_samples_free(&list);
    if (found.varies) fail_msg("on a slope of %g a jump is a pulse", how[1]);
  }
}

static hk_status step_twice(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                            size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = sin(in[0]) + (in[0] > 0.3) - 0.01 * (in[0] > 0.7123);
  *n_out = 1;
  return HK_OK;
}

static void jumps_are_cornered(void **state) {
  (void)state;
  hk_function f = {.call = step_twice};
  hk_samples list;
  double jump[4][2];
  hk_samples_take(&list, &f, 0, 1, 1000, 2000);
  assert_int_equal(hk_samples_jumps(&list, jump, 4), 2);
  static const double at[] = {0.3, 0.7123};
  for (int k = 0; k < 2; k++) assert_true(jump[k][0] <= at[k] && jump[k][1] > at[k] && jump[k][1] - jump[k][0] < 2e-12);
  hk_samples_free(&list);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pulse_shorter_than_the_gap_is_found_wherever_it_begins),
      cmocka_unit_test(what_is_followed_is_not_rapid),
      cmocka_unit_test(a_vibration_is_found_in_all_its_length),
      cmocka_unit_test(a_jump_is_none_on_any_slope),
      cmocka_unit_test(jumps_are_cornered),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
