/* What is written is what libpng reads, pixel for pixel: smooth pictures, noise, runs of every length, strips that are
 * not full, and bytes so unevenly frequent that a Huffman code without a limit is longer than PNG allows. */
#include "plugins/common/film/png_file.h"
#include "plugins/common/film/deflate_runs.h"
#include "tests/support/command.h"

#include <png.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

static unsigned noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (unsigned)(*seed >> 40);
}

typedef unsigned char (*paint)(int x, int y, int c, uint64_t *seed);

static unsigned char smooth(int x, int y, int c, uint64_t *seed) {
  (void)seed;
  return (unsigned char)(40 * c + x / 5 + y / 3);
}

static unsigned char any(int x, int y, int c, uint64_t *seed) {
  (void)x, (void)y, (void)c;
  return (unsigned char)noise(seed);
}

static unsigned char flat(int x, int y, int c, uint64_t *seed) {
  (void)x, (void)y, (void)c, (void)seed;
  return 77;
}

/* Runs of 1, 2, 3, ... equal pixels. */
static unsigned char bars(int x, int y, int c, uint64_t *seed) {
  (void)y, (void)seed;
  int bar = 0;
  for (int begin = 0; begin <= x; begin += ++bar) continue;
  return (unsigned char)(bar * 37 + c);
}

/* From left to right each bit makes a step of one more or none: differences of 0 and rare ones. */
static unsigned char steps(int x, int y, int c, uint64_t *seed) {
  (void)y, (void)c;
  return (unsigned char)(noise(seed) % 50 ? 3 : x);
}

static void check(int width, int height, paint of) {
  size_t size = (size_t)width * (size_t)height * 4, row = (size_t)width * 4;
  unsigned char *rgba = malloc(size), *read = malloc(size);
  uint64_t seed = 7;
  char why[256] = "", path[PATH_MAX];
  snprintf(path, sizeof path, "%s", test_write("picture.png", ""));
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      for (int c = 0; c < 4; c++) rgba[row * (size_t)y + 4 * (size_t)x + (size_t)c] = c < 3 ? of(x, y, c, &seed) : 9;
  if (hk_png_write(path, width, height, rgba, why, sizeof why) != 0) fail_msg("%s", why);
  png_image image = {.version = PNG_IMAGE_VERSION};
  assert_true(png_image_begin_read_from_file(&image, path));
  assert_int_equal(image.width, width);
  assert_int_equal(image.height, height);
  image.format = PNG_FORMAT_RGBA;
  if (!png_image_finish_read(&image, NULL, read, 0, NULL)) fail_msg("%d x %d: %s", width, height, image.message);
  for (int y = 0; y < height; y++)
    for (size_t k = 0; k < row; k++)
      if (k % 4 < 3 && read[row * (size_t)(height - 1 - y) + k] != rgba[row * (size_t)y + k])
        fail_msg("%d x %d: byte %zu of row %d from below differs", width, height, k, y);
  free(rgba), free(read);
}

static void pictures_are_read_as_they_were(void **state) {
  (void)state;
  static const paint paints[] = {smooth, any, flat, bars, steps};
  static const int sizes[][2] = {{1, 1}, {2, 3}, {3, 1}, {16, 32}, {160, 90}, {641, 33}, {1, 100}, {2000, 5}};
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
    for (size_t p = 0; p < sizeof paints / sizeof *paints; p++) check(sizes[s][0], sizes[s][1], paints[p]);
}

/* Smooth pictures become small: zlib at its best takes half of this. */
static void smooth_pictures_are_small(void **state) {
  (void)state;
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s", test_write("picture.png", ""));
  check(640, 360, smooth);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  assert_in_range(ftell(file), 100, 640 * 360 * 3 / 8);
  fclose(file);
}

/* Numbers of Fibonacci make the deepest trees: of 25 bytes 24 bits, which are brought down to 15. */
static void codes_have_15_bits_at_most(void **state) {
  (void)state;
  enum { BYTES = 25 };
  size_t count = 0, of[BYTES] = {1, 1};
  for (int b = 2; b < BYTES; b++) of[b] = of[b - 1] + of[b - 2];
  for (int b = 0; b < BYTES; b++) count += of[b];
  unsigned char *bytes = malloc(count), *read = malloc(count), *packed = malloc(hk_runs_room(count) + 2);
  uint16_t *token = malloc(count * sizeof *token);
  uint64_t seed = 3;
  for (size_t b = 0, k = 0; b < BYTES; b++)
    for (size_t l = 0; l < of[b]; l++) bytes[k++] = (unsigned char)b;
  for (size_t k = count - 1; k > 0; k--) { /* shuffled: runs are few */
    size_t other = noise(&seed) % (k + 1);
    unsigned char here = bytes[k];
    bytes[k] = bytes[other], bytes[other] = here;
  }
  for (size_t k = 0; k < count; k++) token[k] = bytes[k];
  hk_bits bits = {.at = packed};
  hk_runs_write(&bits, token, count, true);
  hk_bits_fill(&bits);
  z_stream z = {.next_in = packed, .avail_in = (uInt)(bits.at - packed), .next_out = read, .avail_out = (uInt)count};
  assert_int_equal(inflateInit2(&z, -15), Z_OK);
  assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
  assert_int_equal(z.total_out, count);
  assert_memory_equal(read, bytes, count);
  inflateEnd(&z);
  free(bytes), free(read), free(packed), free(token);
}

static void a_full_or_missing_folder_is_named(void **state) {
  (void)state;
  const unsigned char pixel[4] = {0};
  char why[256];
  assert_int_equal(hk_png_write("/nowhere/at/all.png", 1, 1, pixel, why, sizeof why), -1);
  assert_string_equal(why, "No such file or directory");
  if (access("/dev/full", W_OK) != 0) return;
  assert_int_equal(hk_png_write("/dev/full", 1, 1, pixel, why, sizeof why), -1);
  assert_string_equal(why, "No space left on device");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pictures_are_read_as_they_were),
      cmocka_unit_test(smooth_pictures_are_small),
      cmocka_unit_test(codes_have_15_bits_at_most),
      cmocka_unit_test(a_full_or_missing_folder_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
