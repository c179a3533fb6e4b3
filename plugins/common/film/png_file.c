/* A PNG file (its specification, third edition) of red, green and blue, by the filter "sub": rendered pictures are
 * smooth along a row, and what it leaves of them are runs. With run_coder this takes a third of the time of libpng and
 * zlib (level 1, Z_RLE), which was a fifth of the whole film's, for files of about the same size. */
#include "plugins/common/film/png_file.h"

#include "plugins/common/film/run_coder.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { CHUNK = 1 << 16, EVERY = 8 /* rows: of the sample */ };

static void put_number(uint8_t *at, uint32_t number) {
  for (int k = 0; k < 4; k++) at[k] = (uint8_t)(number >> (24 - 8 * k));
}

static void write_chunk(FILE *file, const char *type, const uint8_t *data, size_t bytes) {
  uint8_t head[8], tail[4];
  put_number(head, (uint32_t)bytes);
  memcpy(head + 4, type, 4);
  uLong sum = crc32(crc32(0, NULL, 0), head + 4, 4);
  put_number(tail, (uint32_t)(bytes ? crc32(sum, data, (uInt)bytes) : sum));
  fwrite(head, 1, sizeof head, file);
  if (bytes) fwrite(data, 1, bytes, file);
  fwrite(tail, 1, sizeof tail, file);
}

static void write_head(FILE *file, int width, int height) {
  static const uint8_t signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  uint8_t data[13] = {[8] = 8, [9] = 2}; /* bits of a colour; red, green and blue */
  put_number(data, (uint32_t)width), put_number(data + 4, (uint32_t)height);
  fwrite(signature, 1, sizeof signature, file);
  write_chunk(file, "IHDR", data, sizeof data);
}

/* The filter's number, and of each pixel what it has more than the one before, modulo 256: four bytes at a time, of
 * which the next pixel covers the last. The row has room for one byte more. */
static void filter(const uint8_t *rgba, int width, uint8_t *row) {
  const uint32_t high = 0x80808080;
  uint32_t before = 0;
  *row++ = 1;
  for (int x = 0; x < width; x++, row += 3) {
    uint32_t here;
    memcpy(&here, rgba + 4 * (size_t)x, sizeof here);
    uint32_t difference = ((here | high) - (before & ~high)) ^ ((here ^ ~before) & high);
    memcpy(row, &difference, sizeof difference);
    before = here;
  }
}

typedef struct png {
  FILE *file;
  int width, height;
  const uint8_t *rgba; /* the bottom row first */
  uint8_t *row, *out;
  hk_run_coder coder;
} png;

static const uint8_t *pixels(const png *p, int row) {
  return p->rgba + (size_t)(p->height - 1 - row) * (size_t)p->width * 4;
}

/* The data of a zlib stream, RFC 1950, in chunks. */
static void write_rows(png *p) {
  size_t bytes = 3 * (size_t)p->width + 1;
  for (int y = 0; y < p->height; y += EVERY) {
    filter(pixels(p, y), p->width, p->row);
    hk_run_coder_sample(&p->coder, p->row, bytes);
  }
  uint8_t *at = p->out;
  uLong sum = adler32(0, NULL, 0);
  *at++ = 0x78, *at++ = 0x01; /* deflate with a window of 32 KiB, fast */
  at = hk_run_coder_begin(&p->coder, at);
  for (int y = 0; y < p->height; y++) {
    filter(pixels(p, y), p->width, p->row);
    sum = adler32(sum, p->row, (uInt)bytes);
    at = hk_run_coder_row(&p->coder, p->row, bytes, at);
    if (at - p->out < CHUNK) continue;
    write_chunk(p->file, "IDAT", p->out, (size_t)(at - p->out));
    at = p->out;
  }
  at = hk_run_coder_end(&p->coder, at);
  put_number(at, (uint32_t)sum);
  write_chunk(p->file, "IDAT", p->out, (size_t)(at + 4 - p->out));
}

static bool write_all(png *p) {
  size_t bytes = 3 * (size_t)p->width + 1;
  p->row = malloc(bytes + 8), p->out = malloc(CHUNK + 2 * bytes + 1024);
  bool fine = p->row && p->out;
  if (fine) {
    write_head(p->file, p->width, p->height);
    write_rows(p);
    write_chunk(p->file, "IEND", NULL, 0);
  }
  free(p->row), free(p->out);
  return fine;
}

int hk_png_write(const char *path, int width, int height, const unsigned char *rgba, char *why, size_t size) {
  png p = {.file = fopen(path, "wb"), .width = width, .height = height, .rgba = rgba};
  if (!p.file) {
    snprintf(why, size, "%s", strerror(errno));
    return -1;
  }
  errno = 0;
  bool memory = write_all(&p), fine = !ferror(p.file);
  int cause = errno;
  if (fclose(p.file) != 0 && fine) fine = false, cause = errno;
  if (memory && fine) return 0;
  snprintf(why, size, "%s", memory ? strerror(cause) : "no memory for the picture");
  return -1;
}
