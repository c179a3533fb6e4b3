/* Lightness is CIE L* of sRGB; colour-blind eyes are those of Vienot, Brettel and Mollon 1999, who give the light that
 * reaches somebody without one kind of cone as a linear function of the light. */
#include "plugins/common/colour/colormap.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static double light_of(double byte) {
  double c = byte / 255;
  return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static double lightness(const double light[3]) {
  double y = 0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2];
  return 116 * (y > 216 / 24389.0 ? cbrt(y) : (24389 / 27.0 * y + 16) / 116) - 16;
}

static double lightness_at(uint8_t table[HK_MAP_SIZE][4], int k) {
  double light[3];
  for (int c = 0; c < 3; c++) light[c] = light_of(table[k][c]);
  return lightness(light);
}

static void colormaps_rise_evenly_in_lightness(void **state) {
  (void)state;
  uint8_t table[HK_MAP_SIZE][4];
  for (int map = 0; map < HK_MAP_DIVERGING; map++) {
    hk_colormap_fill((hk_colormap)map, 0, table);
    double low = lightness_at(table, 0), high = lightness_at(table, HK_MAP_SIZE - 1);
    assert_true(high - low > 60);
    for (int k = 0; k < HK_MAP_SIZE; k++) {
      double even = low + (high - low) * k / (HK_MAP_SIZE - 1);
      /* Grey is even in its bytes, whose lightness bends by 2.4 where it is black; inferno as published by 5. */
      assert_true(fabs(lightness_at(table, k) - even) < 6);
      /* Bytes are rounded: two neighbours may go back by half a byte of each colour, 0.4 of L* in dark colours. */
      if (k) assert_true(lightness_at(table, k) > lightness_at(table, k - 1) - 0.4);
      if (k >= 8) assert_true(lightness_at(table, k) > lightness_at(table, k - 8));
    }
  }
}

static void colormap_diverges_evenly_to_both_sides(void **state) {
  (void)state;
  uint8_t table[HK_MAP_SIZE][4];
  hk_colormap_fill(HK_MAP_DIVERGING, 0, table);
  for (int k = 8; k < HK_MAP_SIZE / 2; k++) {
    assert_true(lightness_at(table, k) > lightness_at(table, k - 8));
    assert_true(lightness_at(table, HK_MAP_SIZE - 1 - k) > lightness_at(table, HK_MAP_SIZE - 1 - k + 8));
  }
  assert_true(fabs(lightness_at(table, 0) - lightness_at(table, HK_MAP_SIZE - 1)) < 5);
}

/* Light as seen without long-wave and without middle-wave cones. */
static void without_cones(int kind, const uint8_t colour[4], double seen[3]) {
  static const double matrix[2][3][3] = {
      {{0.11238, 0.88762, 0}, {0.11238, 0.88762, 0}, {0.00401, -0.00401, 1}},
      {{0.29275, 0.70725, 0}, {0.29275, 0.70725, 0}, {-0.02234, 0.02234, 1}},
  };
  for (int r = 0; r < 3; r++) {
    seen[r] = 0;
    for (int c = 0; c < 3; c++) seen[r] += matrix[kind][r][c] * light_of(colour[c]);
  }
}

static void colormaps_are_told_apart_by_the_colour_blind(void **state) {
  (void)state;
  uint8_t table[HK_MAP_SIZE][4];
  for (int map = 0; map < HK_MAP_DIVERGING; map++)
    for (int kind = 0; kind < 2; kind++) {
      double last = -1, seen[3];
      hk_colormap_fill((hk_colormap)map, 0, table);
      for (int k = 0; k < HK_MAP_SIZE; k += 32) {
        without_cones(kind, table[k], seen);
        double now = lightness(seen);
        assert_true(now > last + 0.5); /* a just noticeable difference is about 1 in 16 steps of about 5 */
        last = now;
      }
    }
}

static void colormap_reverses_and_keeps_what_is_beyond(void **state) {
  (void)state;
  uint8_t forth[HK_MAP_SIZE][4], back[HK_MAP_SIZE][4], colour[4];
  hk_colormap_fill(HK_MAP_FIRE, 0, forth);
  hk_colormap_fill(HK_MAP_FIRE, 1, back);
  for (int k = 0; k < HK_MAP_SIZE; k++) assert_memory_equal(forth[k], back[HK_MAP_SIZE - 1 - k], 4);
  hk_colormap_colour(forth, -3, colour);
  assert_memory_equal(colour, forth[0], 4);
  hk_colormap_colour(forth, 1e300, colour);
  assert_memory_equal(colour, forth[HK_MAP_SIZE - 1], 4);
  hk_colormap_colour(back, (double)NAN, colour);
  assert_memory_equal(colour, ((uint8_t[]){0, 0, 0, 255}), 4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(colormaps_rise_evenly_in_lightness),
      cmocka_unit_test(colormap_diverges_evenly_to_both_sides),
      cmocka_unit_test(colormaps_are_told_apart_by_the_colour_blind),
      cmocka_unit_test(colormap_reverses_and_keeps_what_is_beyond),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
