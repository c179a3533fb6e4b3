/* PNG files as libpng reads them: every pixel is as it was, whatever the rows consist of. */
#include "plugins/common/film/png_file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <png.h>

static char path[] = "/tmp/hooke-png-XXXXXX";

static uint32_t next(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)(*state >> 33);
}

enum { NOISE, ONE_COLOUR, SLOPES, RUNS, ONE_ROW, KINDS };

/* RUNS: of equal pixels, of lengths about those where the codes of lengths change, 258 bytes among them. ONE_ROW: noise
 * in row 3, which is not in the sample that the code is made from. */
static void fill(unsigned char *rgba, int width, int height, int kind) {
  uint64_t state = 7;
  uint32_t colour = 0, left = 0;
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      unsigned char *p = rgba + 4 * ((size_t)y * (size_t)width + (size_t)x);
      if (kind == RUNS && left-- == 0) colour = next(&state), left = next(&state) % 180;
      uint32_t value = kind == NOISE                            ? next(&state)
                       : kind == RUNS                           ? colour
                       : kind == SLOPES                         ? (uint32_t)(x / 3 + (x * y / 50 << 8) + (y << 16))
                       : kind == ONE_ROW && y == height - 1 - 3 ? next(&state)
                                                                : 0x336699;
      memcpy(p, &value, sizeof value);
    }
}

/* Reads it with libpng, which checks all sums, and compares. Returns the size of the file. */
static long check(const unsigned char *rgba, int width, int height) {
  png_image image = {.version = PNG_IMAGE_VERSION};
  if (!png_image_begin_read_from_file(&image, path)) fail_msg("%s", image.message);
  assert_int_equal(image.width, width);
  assert_int_equal(image.height, height);
  image.format = PNG_FORMAT_RGB;
  unsigned char *rgb = malloc(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, NULL, rgb, 0, NULL)) fail_msg("%s", image.message);
  assert_int_equal(image.warning_or_error, 0);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      assert_memory_equal(rgb + 3 * ((size_t)y * (size_t)width + (size_t)x),
                          rgba + 4 * ((size_t)(height - 1 - y) * (size_t)width + (size_t)x), 3);
  free(rgb);
  FILE *file = fopen(path, "rb");
  fseek(file, 0, SEEK_END);
  long bytes = ftell(file);
  fclose(file);
  return bytes;
}

static void pictures_are_read_as_they_were(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {16, 16}, {87, 5}, {1280, 40}, {8192, 12}};
  char why[256];
  close(mkstemp(path));
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
    for (int kind = 0; kind < KINDS; kind++) {
      int width = sizes[k][0], height = sizes[k][1];
      size_t pixels = (size_t)width * (size_t)height;
      unsigned char *rgba = malloc(4 * pixels);
      fill(rgba, width, height, kind);
      assert_int_equal(hk_png_write(path, width, height, rgba, why, sizeof why), 0);
      long bytes = check(rgba, width, height);
      /* Noise cannot be made smaller; a run of 258 bytes is two bits or a few; 400 bytes are the file's head and code.
       */
      if (kind == NOISE) assert_true(bytes < 3.1 * (double)pixels + 600);
      if (kind == ONE_COLOUR) assert_true(bytes < (double)pixels / 100 + 10 * height + 400);
      free(rgba);
    }
  unlink(path);
}

/* Also where it fills up at the end, when the file is closed. */
static void pictures_that_cannot_be_written_are_said(void **state) {
  (void)state;
  unsigned char rgba[4 * 64] = {0};
  char why[256] = "";
  assert_int_equal(hk_png_write("/dev/full", 8, 8, rgba, why, sizeof why), -1);
  assert_string_equal(why, "No space left on device");
  assert_int_equal(hk_png_write("/nowhere/at/all", 8, 8, rgba, why, sizeof why), -1);
  assert_string_equal(why, "No such file or directory");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pictures_are_read_as_they_were),
      cmocka_unit_test(pictures_that_cannot_be_written_are_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
