/* In whole numbers of 1/65536, a row at a time, which gives the same picture on every machine. */
#include "plugins/common/film/yuv_picture.h"
#include "core/plugin/widest.h"

#include <stdint.h>

enum { ONE = 65536, HALF = ONE / 2 };

/* Those of Y, Cb and Cr; white has 235, grey 128 exactly. */
static const int32_t of_y[3] = {16829, 33039, 6416}, of_cb[3] = {-9714, -19070, 28784},
                     of_cr[3] = {28784, -24103, -4681};

HK_INLINE void light_row(size_t width, const unsigned char *rgba, unsigned char *y) {
  for (size_t k = 0; k < width; k++) {
    const unsigned char *p = rgba + 4 * k;
    y[k] = (unsigned char)((of_y[0] * p[0] + of_y[1] * p[1] + of_y[2] * p[2] + 16 * ONE + HALF) >> 16);
  }
}

/* Of two rows. */
HK_INLINE void colour_row(size_t pairs, const unsigned char *a, const unsigned char *b, unsigned char *cb,
                          unsigned char *cr) {
  for (size_t k = 0; k < pairs; k++) {
    int32_t sum[3];
    for (size_t c = 0; c < 3; c++) sum[c] = a[8 * k + c] + a[8 * k + 4 + c] + b[8 * k + c] + b[8 * k + 4 + c];
    cb[k] = (unsigned char)((of_cb[0] * sum[0] + of_cb[1] * sum[1] + of_cb[2] * sum[2] + 4 * (128 * ONE + HALF)) >> 18);
    cr[k] = (unsigned char)((of_cr[0] * sum[0] + of_cr[1] * sum[1] + of_cr[2] * sum[2] + 4 * (128 * ONE + HALF)) >> 18);
  }
}

HK_INLINE void all_rows(size_t width, size_t height, const unsigned char *rgba, unsigned char *into) {
  unsigned char *cb = into + width * height, *cr = cb + width * height / 4;
  for (size_t row = 0; row < height; row++) light_row(width, rgba + 4 * width * (height - 1 - row), into + width * row);
  for (size_t row = 0; row < height / 2; row++) {
    const unsigned char *below = rgba + 4 * width * (height - 2 - 2 * row);
    colour_row(width / 2, below, below + 4 * width, cb + width / 2 * row, cr + width / 2 * row);
  }
}

HK_VERSIONS(static void, convert, (size_t width, size_t height, const unsigned char *rgba, unsigned char *into),
            all_rows(width, height, rgba, into))

void hk_yuv_picture(int lanes, int width, int height, const unsigned char *rgba, unsigned char *into) {
  HK_WIDEST(lanes, convert)((size_t)width, (size_t)height, rgba, into);
}
