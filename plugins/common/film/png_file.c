/* Rendered pictures are smooth along a row: what the "sub" filter leaves of them are runs (ISO/IEC 15948, 9.2), which
 * deflate_runs.h writes. */
#include "plugins/common/film/png_file.h"
#include "plugins/common/film/deflate_runs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { STRIP = 32 /* rows of a block: its tokens stay in the cache */, SUB = 1 };

static void big_endian(unsigned char *into, uint32_t v) {
  for (int k = 0; k < 4; k++) into[k] = (unsigned char)(v >> (24 - 8 * k));
}

/* Bytes of a chunk; their first four are its name. */
static bool write_chunk(FILE *file, const unsigned char *bytes, size_t count) {
  unsigned char length[4], sum[4];
  big_endian(length, (uint32_t)(count - 4));
  big_endian(sum, (uint32_t)crc32(crc32(0, NULL, 0), bytes, (uInt)count));
  return fwrite(length, 1, 4, file) == 4 && fwrite(bytes, 1, count, file) == count && fwrite(sum, 1, 4, file) == 4;
}

static bool write_head(FILE *file, int width, int height) {
  static const unsigned char signature[8] = {137, 'P', 'N', 'G', 13, 10, 26, 10};
  unsigned char header[17] = {'I', 'H', 'D', 'R', [12] = 8 /* bits */, [13] = 2 /* red, green, blue */};
  big_endian(header + 4, (uint32_t)width), big_endian(header + 8, (uint32_t)height);
  return fwrite(signature, 1, 8, file) == 8 && write_chunk(file, header, sizeof header);
}

/* The differences of the four bytes, each for itself. */
static uint32_t bytes_minus(uint32_t a, uint32_t b) {
  const uint32_t high = 0x80808080;
  return ((a | high) - (b & ~high)) ^ ((a ^ ~b) & high);
}

/* A row of pixels as the differences to those on their left; a byte beyond the row is written to as well. */
static void filter_row(const unsigned char *rgba, int width, unsigned char *into) {
  uint32_t left = 0, here;
  *into++ = SUB;
  for (int k = 0; k < width; k++, left = here) {
    memcpy(&here, rgba + 4 * (size_t)k, 4);
    uint32_t difference = bytes_minus(here, left);
    memcpy(into + 3 * (size_t)k, &difference, 4);
  }
}

/* What a strip needs: its bytes, their tokens, and a chunk. */
typedef struct strip {
  size_t row; /* bytes of one */
  unsigned char *bytes, *chunk;
  uint16_t *token;
} strip;

static bool open_strip(strip *s, int width) {
  s->row = 3 * (size_t)width + 1;
  s->bytes = malloc(s->row * STRIP + 1);
  s->token = malloc(s->row * STRIP * sizeof *s->token);
  s->chunk = malloc(hk_runs_room(s->row * STRIP));
  return s->bytes && s->token && s->chunk;
}

static bool write_strips(FILE *file, int width, int height, const unsigned char *rgba, strip *s) {
  hk_bits bits = {0};
  unsigned long sum = adler32(0, NULL, 0);
  for (int top = 0; top < height; top += STRIP) {
    int rows = height - top < STRIP ? height - top : STRIP;
    bool last = top + rows == height;
    for (int k = 0; k < rows; k++)
      filter_row(rgba + (size_t)(height - 1 - top - k) * (size_t)width * 4, width, s->bytes + (size_t)k * s->row);
    sum = adler32(sum, s->bytes, (uInt)((size_t)rows * s->row));
    memcpy(s->chunk, "IDAT", 4);
    bits.at = s->chunk + 4;
    if (top == 0) hk_bits_add(&bits, 0x0178, 16); /* of zlib, RFC 1950: no dictionary, the fastest */
    hk_runs_write(&bits, s->token, hk_runs_find(s->bytes, (size_t)rows * s->row, s->token), last);
    if (last) hk_bits_fill(&bits), big_endian(bits.at, (uint32_t)sum), bits.at += 4;
    if (!write_chunk(file, s->chunk, (size_t)(bits.at - s->chunk))) return false;
  }
  return true;
}

int hk_png_write(const char *path, int width, int height, const unsigned char *rgba, char *why, size_t size) {
  strip s = {0};
  bool room = open_strip(&s, width);
  FILE *file = room ? fopen(path, "wb") : NULL;
  bool written = file && write_head(file, width, height) && write_strips(file, width, height, rgba, &s) &&
                 write_chunk(file, (const unsigned char *)"IEND", 4);
  if (!written) snprintf(why, size, "%s", room ? strerror(errno) : "no memory for the picture");
  if (file && fclose(file) != 0 && written) {
    snprintf(why, size, "%s", strerror(errno));
    written = false;
  }
  free(s.bytes), free(s.token), free(s.chunk);
  return written ? 0 : -1;
}
