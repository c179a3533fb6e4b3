#include "plugins/common/colour/range.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double uniform(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

/* Texts as intervals on the bar, in letters: a letter apart, within the bar's length, and true. */
static void check_ticks(const hk_scale *s, double length) {
  hk_tick tick[HK_TICKS];
  size_t count = hk_scale_ticks(s, length, tick);
  double begin[HK_TICKS], end[HK_TICKS];
  assert_in_range(count, 2, HK_TICKS);
  for (size_t k = 0; k < count; k++) {
    double width = (double)strlen(tick[k].text), value = strtod(tick[k].text, NULL);
    begin[k] = tick[k].place * length - tick[k].align * width, end[k] = begin[k] + width;
    assert_true(begin[k] > -1e-9 && end[k] < length + 1e-9);
    /* The number written stands where the number is, to within 1 % of the bar. */
    assert_true(fabs(hk_scale_place(s, value) - tick[k].place) < 0.01);
    for (size_t j = 0; j < k; j++) {
      assert_true(begin[k] >= end[j] + 1 - 1e-9 || begin[j] >= end[k] + 1 - 1e-9);
      assert_string_not_equal(tick[j].text, tick[k].text);
    }
  }
}

static void scale_writes_two_ticks_or_more_that_never_meet(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int k = 0; k < 20000; k++) {
    double size = pow(10, 24 * uniform(&seed) - 12), middle = size * (2 * uniform(&seed) - 1);
    double width = size * pow(10, -6 * uniform(&seed));
    hk_scale s = {middle, middle + width, false};
    check_ticks(&s, fmax(hk_scale_least(&s), 10 + 30 * uniform(&seed)));
    s = (hk_scale){size, size * pow(10, 0.05 + 12 * uniform(&seed)), true};
    check_ticks(&s, fmax(hk_scale_least(&s), 10 + 30 * uniform(&seed)));
  }
}

static void scale_has_ticks_at_powers_of_ten(void **state) {
  (void)state;
  hk_scale s = {0.5, 2000, true};
  hk_tick tick[HK_TICKS];
  assert_int_equal(hk_scale_ticks(&s, 40, tick), 4); /* 1 and 1000 would touch the ends */
  static const char *const expected[] = {"0.5", "2000", "10", "100"};
  for (int k = 0; k < 4; k++) assert_string_equal(tick[k].text, expected[k]);
  assert_float_equal(hk_scale_place(&s, sqrt(0.5 * 2000)), 0.5, 1e-12);
  assert_float_equal(hk_scale_place(&s, -1), 0, 0);
  assert_true(isnan(hk_scale_place(&s, (double)INFINITY)));
}

static void range_leaves_out_the_outermost_per_cent(void **state) {
  (void)state;
  float number[1000];
  hk_scale s = {0};
  for (int k = 0; k < 1000; k++) number[k] = 3 + (float)(k * 7 % 1000) / 1000;
  number[500] = 1e9f, number[3] = -1e9f;
  assert_true(hk_range_choose(&s, number, 1000, false));
  assert_float_equal(s.low, 3.01, 0.002);
  assert_float_equal(s.high, 3.99, 0.002);
  assert_true(hk_range_choose(&s, number, 1000, true));
  assert_float_equal(s.high, 4, 1e-12);
  assert_float_equal(s.low, -4, 1e-12);
}

static void range_of_a_logarithm_takes_positive_numbers(void **state) {
  (void)state;
  float number[] = {0, -5, 2, 0.0123f, 4567, 0};
  hk_scale s = {.log = true};
  assert_true(hk_range_choose(&s, number, 6, false));
  assert_float_equal(s.low, 0.012, 1e-12);
  assert_float_equal(s.high, 4600, 1e-9);
  float none[] = {0, -1};
  assert_false(hk_range_choose(&s, none, 2, false));
  assert_true(s.low > 0 && s.high > s.low);
  float one[] = {7};
  assert_true(hk_range_choose(&s, one, 1, false));
  assert_true(s.low < 7 && s.high > 7);
  s.log = false;
  assert_false(hk_range_choose(&s, one, 0, false));
}

/* By more than one of 512 colours, on a scale from 0 to 1 and from 1 to 100. */
static void scale_saturates_beyond_the_colours_of_its_ends(void **state) {
  (void)state;
  static const struct {
    double least, most;
    bool log, below, above;
  } tries[] = {{0, 1, false, false, false},     {-0.0019, 1.0019, false, false, false},
               {-0.002, 1, false, true, false}, {0.5, 1.002, false, false, true},
               {-9, 9, false, true, true},      {1, -1, false, false, false},
               {1, 100, true, false, false},    {0, 100, true, true, false},
               {0.98, 100, true, true, false},  {-3, 102, true, true, true}};
  for (size_t k = 0; k < sizeof tries / sizeof *tries; k++) {
    hk_scale s = {tries[k].log ? 1 : 0, tries[k].log ? 100 : 1, tries[k].log};
    bool out[2];
    hk_scale_saturates(&s, tries[k].least, tries[k].most, 512, out);
    assert_int_equal(out[0], tries[k].below);
    assert_int_equal(out[1], tries[k].above);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(scale_writes_two_ticks_or_more_that_never_meet),
      cmocka_unit_test(scale_has_ticks_at_powers_of_ten),
      cmocka_unit_test(scale_saturates_beyond_the_colours_of_its_ends),
      cmocka_unit_test(range_leaves_out_the_outermost_per_cent),
      cmocka_unit_test(range_of_a_logarithm_takes_positive_numbers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
