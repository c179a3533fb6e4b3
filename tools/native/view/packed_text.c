#include "tools/native/view/packed_text.h"

#include <stdlib.h>
#include <zlib.h>

static char *base64(const unsigned char *byte, size_t bytes, size_t *length) {
  static const char letter[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  *length = (bytes + 2) / 3 * 4;
  char *text = malloc(*length + 1), *at = text;
  if (!text) return NULL;
  for (size_t k = 0; k < bytes; k += 3) {
    size_t left = bytes - k;
    unsigned long three = (unsigned long)byte[k] << 16;
    if (left > 1) three |= (unsigned long)byte[k + 1] << 8;
    if (left > 2) three |= byte[k + 2];
    *at++ = letter[three >> 18];
    *at++ = letter[three >> 12 & 63];
    *at++ = left > 1 ? letter[three >> 6 & 63] : '=';
    *at++ = left > 2 ? letter[three & 63] : '=';
  }
  *at = 0;
  return text;
}

char *hk_packed_text(const void *byte, size_t bytes, size_t *length) {
  uLongf size = compressBound(bytes);
  unsigned char *small = malloc(size);
  char *text = NULL;
  if (small && compress2(small, &size, byte, bytes, 6) == Z_OK) text = base64(small, size, length);
  free(small);
  return text;
}
