#include "plugins/common/lettering/lettering.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { ROOM = 2048 };

static hk_letter_stroke stroke[ROOM], other[ROOM];

static double width_of(const char *text) {
  double width;
  hk_letters(text, stroke, ROOM, &width);
  return width;
}

/* No two of them look alike, and none is the box of what is not known. */
static void each_character_of_ascii_has_a_shape_of_its_own(void **state) {
  (void)state;
  double width;
  for (int c = '!'; c <= '~'; c++) {
    size_t count = hk_letters((char[]){(char)c, 0}, stroke, ROOM, &width);
    assert_in_range(count, 1, 200);
    for (int d = '!'; d < c; d++) {
      size_t have = hk_letters((char[]){(char)d, 0}, other, ROOM, &width);
      assert_false(have == count && memcmp(stroke, other, count * sizeof *stroke) == 0);
    }
    size_t box = hk_letters("\u20ac", other, ROOM, &width);
    assert_false(box == count && memcmp(stroke, other, count * sizeof *stroke) == 0);
  }
}

/* Within the font's height, and within the width that is said. */
static void strokes_are_where_the_text_is(void **state) {
  (void)state;
  static const char *const texts[] = {"speed m/s", "gjpqy|", "1.25", "N/m\u00b2", "\u2265 3", "force: a_b, [N]", ""};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    double width;
    size_t count = hk_letters(texts[k], stroke, ROOM, &width);
    for (size_t i = 0; i < count; i++)
      for (int end = 0; end < 2; end++) {
        const double *at = end ? stroke[i].b : stroke[i].a;
        assert_true(at[0] >= 0 && at[0] <= width + 1e-12 && at[1] >= -2 && at[1] <= HK_LETTER_HEIGHT);
      }
  }
  assert_float_equal(width_of(""), 0, 0);
}

static void widths_are_those_of_the_letters_and_digits_are_equal(void **state) {
  (void)state;
  assert_true(width_of("ill") < width_of("abc"));
  for (char c = '0'; c <= '9'; c++) assert_float_equal(width_of((char[]){c, 0}), 4, 0);
  assert_float_equal(width_of("1.5"), 4 + 2 + 1 + 2 + 4, 1e-12); /* a point is one wide */
}

/* A decimal point is a square of one unit on the line, a gap away from both digits. */
static void decimal_points_are_seen(void **state) {
  (void)state;
  double width, low = 99, high = 0;
  size_t all = hk_letters("1.5", stroke, ROOM, &width), ends = hk_letters("1", other, ROOM, &width);
  for (size_t k = ends; k < ends + 4; k++) {
    low = fmin(low, stroke[k].a[0]), high = fmax(high, stroke[k].a[0]);
    assert_in_range(stroke[k].a[1], 0, 1);
  }
  assert_true(all > ends + 4);
  assert_float_equal(low, 6, 0);
  assert_float_equal(high, 7, 0);
}

/* hk_scale_ticks keeps texts apart by a letter, 6, by the number of their letters. */
static void numbers_are_hardly_wider_than_their_letters_as_digits(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int k = 0; k < 20000; k++) {
    char text[32];
    double width;
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    double part = (double)(seed >> 11) / 9007199254740992.0;
    snprintf(text, sizeof text, "%.*g", k % 9 + 1, (k & 1 ? -1 : 1) * pow(10, 600 * part - 300));
    assert_in_range(hk_letters_of_number(text, stroke, ROOM, &width), 1, ROOM);
    assert_true(width <= 6 * (double)strlen(text) - 2 + 3);
  }
}

/* The last stroke of a power is above the middle of the digits before it. */
static void powers_of_ten_are_raised(void **state) {
  (void)state;
  double width;
  size_t count = hk_letters_of_number("-1.5e-07", stroke, ROOM, &width);
  assert_true(stroke[count - 1].a[1] >= 4 && stroke[count - 1].b[1] >= 4);
  count = hk_letters_of_number("150", stroke, ROOM, &width);
  size_t same = hk_letters("150", other, ROOM, &width);
  assert_int_equal(count, same);
  assert_memory_equal(stroke, other, count * sizeof *stroke);
}

static void no_more_strokes_are_written_than_there_is_room_for(void **state) {
  (void)state;
  double width;
  stroke[7].a[0] = -77;
  assert_int_equal(hk_letters("many letters", stroke, 7, &width), 7);
  assert_float_equal(stroke[7].a[0], -77, 0);
  hk_letters("\xff\xfe broken \xe2", stroke, ROOM, &width);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_character_of_ascii_has_a_shape_of_its_own),
      cmocka_unit_test(strokes_are_where_the_text_is),
      cmocka_unit_test(widths_are_those_of_the_letters_and_digits_are_equal),
      cmocka_unit_test(decimal_points_are_seen),
      cmocka_unit_test(numbers_are_hardly_wider_than_their_letters_as_digits),
      cmocka_unit_test(powers_of_ten_are_raised),
      cmocka_unit_test(no_more_strokes_are_written_than_there_is_room_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
