/* Planes of a picture against the formula of BT.601, and the same with every width of vectors. */
#include "plugins/common/film/yuv_picture.h"
#include "core/engine/base/base.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 70, HEIGHT = 6, N = WIDTH * HEIGHT };

static void fill(unsigned char *rgba) {
  uint64_t seed = 7;
  for (size_t k = 0; k < 4 * N; k++) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    rgba[k] = seed >> 62 == 0 ? 0 : seed >> 62 == 1 ? 255 : (unsigned char)(seed >> 40);
  }
}

/* Roundings of the sum, 0.5, and of its coefficients, 3 x 255 x 0.5/65536 = 0.006. */
static void assert_near(unsigned char found, double exact) { assert_true(fabs(found - exact) < 0.51); }

static void planes_are_those_of_bt601(void **state) {
  (void)state;
  unsigned char rgba[4 * N], planes[N * 3 / 2];
  fill(rgba);
  hk_yuv_picture(2, WIDTH, HEIGHT, rgba, planes);
  for (size_t y = 0; y < HEIGHT; y++)
    for (size_t x = 0; x < WIDTH; x++) {
      const unsigned char *p = rgba + 4 * (WIDTH * (HEIGHT - 1 - y) + x);
      assert_near(planes[WIDTH * y + x], 16 + 219.0 / 255 * (0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]));
    }
  for (size_t y = 0; y < HEIGHT / 2; y++)
    for (size_t x = 0; x < WIDTH / 2; x++) {
      double mean[3] = {0};
      for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
          mean[c] += rgba[4 * (WIDTH * (HEIGHT - 1 - 2 * y - k / 2) + 2 * x + k % 2) + c] / 4.0;
      double light = 0.299 * mean[0] + 0.587 * mean[1] + 0.114 * mean[2];
      assert_near(planes[N + WIDTH / 2 * y + x], 128 + 224.0 / 255 * (mean[2] - light) / 1.772);
      assert_near(planes[N + N / 4 + WIDTH / 2 * y + x], 128 + 224.0 / 255 * (mean[0] - light) / 1.402);
    }
}

static void all_widths_give_the_same_planes(void **state) {
  (void)state;
  unsigned char rgba[4 * N], first[N * 3 / 2], planes[N * 3 / 2];
  fill(rgba);
  hk_yuv_picture(2, WIDTH, HEIGHT, rgba, first);
  for (int lanes = 4; lanes <= hk_processor_lanes(); lanes *= 2) {
    hk_yuv_picture(lanes, WIDTH, HEIGHT, rgba, planes);
    assert_memory_equal(first, planes, sizeof first);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(planes_are_those_of_bt601),
      cmocka_unit_test(all_widths_give_the_same_planes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
