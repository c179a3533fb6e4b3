#include "plugins/common/film/contact_sheet.h"

#include "plugins/common/film/png_file.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { GAP = 4 }; /* pixels between stills, white */

/* Where the lowest stills begin. */
static int base_of(const hk_contact_sheet *s) { return s->footer > 0 ? s->footer + GAP : 0; }

hk_status hk_contact_sheet_open(hk_contact_sheet *s, const hk_host *host, size_t count, size_t frames, int width,
                                int height, int footer) {
  *s = (hk_contact_sheet){
      .host = host, .count = count < frames ? count : frames, .frames = frames, .full_width = width, .footer = footer};
  if (s->count == 0) return HK_OK;
  s->columns = (int)ceil(sqrt((double)s->count));
  s->rows = ((int)s->count + s->columns - 1) / s->columns;
  s->width = width / s->columns > 0 ? width / s->columns : 1;
  s->height = height / s->columns > 0 ? height / s->columns : 1;
  s->out_width = s->columns * (s->width + GAP) - GAP, s->out_height = base_of(s) + s->rows * (s->height + GAP) - GAP;
  size_t bytes = (size_t)s->out_width * (size_t)s->out_height * 4;
  s->rgba = host->allocate(host, bytes);
  if (!s->rgba) return host->fail(host, HK_NO_MEMORY, "no memory for a sheet of %zu stills", s->count);
  memset(s->rgba, 255, bytes);
  return HK_OK;
}

/* The number of the j-th still's picture. */
static size_t picture_of(const hk_contact_sheet *s, size_t j) {
  return s->count == 1 ? 0 : (j * (s->frames - 1) + (s->count - 1) / 2) / (s->count - 1);
}

/* A pixel of a still is the mean of those that it stands for. */
static void shrink(const hk_contact_sheet *s, const unsigned char *from, unsigned char *to) {
  int n = s->columns, area = n * n;
  for (int y = 0; y < s->height; y++)
    for (int x = 0; x < s->width; x++)
      for (int c = 0; c < 3; c++) {
        int sum = area / 2;
        for (int v = 0; v < n; v++)
          for (int u = 0; u < n; u++)
            sum += from[((size_t)(n * y + v) * (size_t)s->full_width + (size_t)(n * x + u)) * 4 + (size_t)c];
        to[((size_t)y * (size_t)s->out_width + (size_t)x) * 4 + (size_t)c] = (unsigned char)(sum / area);
      }
}

bool hk_contact_sheet_wants(const hk_contact_sheet *s, size_t k) {
  return s->taken < s->count && k == picture_of(s, s->taken);
}

void hk_contact_sheet_fill_footer(hk_contact_sheet *s, const unsigned char *rgba, int width) {
  for (int y = 0; y < s->footer; y++)
    for (int x = 0; x < s->out_width; x++) {
      int from = x < width ? x : width - 1;
      memcpy(s->rgba + ((size_t)y * (size_t)s->out_width + (size_t)x) * 4,
             rgba + ((size_t)y * (size_t)width + (size_t)from) * 4, 4);
    }
}

void hk_contact_sheet_take(hk_contact_sheet *s, const unsigned char *rgba) {
  int column = (int)s->taken % s->columns, row = s->rows - 1 - (int)s->taken / s->columns;
  size_t at =
      (size_t)(base_of(s) + row * (s->height + GAP)) * (size_t)s->out_width + (size_t)column * (size_t)(s->width + GAP);
  shrink(s, rgba, s->rgba + 4 * at);
  s->taken++;
}

hk_status hk_contact_sheet_write(const hk_contact_sheet *s, const char *name) {
  char path[PATH_MAX], why[256];
  if (s->count == 0) return HK_OK;
  hk_status status = s->host->path(s->host, name, path, sizeof path);
  if (status != HK_OK) return status;
  if (hk_png_write(path, s->out_width, s->out_height, s->rgba, why, sizeof why) == 0) return HK_OK;
  return s->host->fail(s->host, HK_IO, "cannot write %s: %s", path, why);
}

void hk_contact_sheet_free(hk_contact_sheet *s) {
  if (s->host) s->host->release(s->host, s->rgba);
  *s = (hk_contact_sheet){0};
}
