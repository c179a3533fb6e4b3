/* Frames are added behind the head, and counted in it at the end. */
#include "tools/native/formats/pc2.h"

#include "tools/native/formats/bytes.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES_AT = 28 };

bool hk_pc2_open(hk_pc2 *p, const char *path, const hk_frame_data *first, char *why, size_t size) {
  *p = (hk_pc2){.n = first->n, .id = malloc((first->n + 1) * sizeof *p->id)};
  if (!p->id) return hk_whole_failed(ENOMEM, why, size);
  memcpy(p->id, first->id, first->n * sizeof *p->id);
  if (!hk_whole_open(&p->file, path, why, size)) return false;
  FILE *file = p->file.stream;
  fwrite("POINTCACHE2", 1, 12, file);
  hk_put_little(file, 1, 4);
  hk_put_little(file, first->n, 4);
  hk_put_little(file, hk_bits_single(0), 4);
  hk_put_little(file, hk_bits_single(1), 4);
  hk_put_little(file, 0, 4);
  return hk_whole_check(&p->file) || hk_whole_failed(p->file.cause, why, size);
}

bool hk_pc2_fits(const hk_pc2 *p, const hk_frame_data *s) {
  return s->n == p->n && memcmp(s->id, p->id, s->n * sizeof *p->id) == 0;
}

bool hk_pc2_add(hk_pc2 *p, const hk_frame_data *s, char *why, size_t size) {
  for (size_t k = 0; k < 3 * s->n; k++) hk_put_little(p->file.stream, hk_bits_single((float)s->x[k]), 4);
  p->samples++;
  return hk_whole_check(&p->file) || hk_whole_failed(p->file.cause, why, size);
}

bool hk_pc2_close(hk_pc2 *p, bool keep, char *why, size_t size) {
  if (p->file.stream && keep) {
    if (fseek(p->file.stream, SAMPLES_AT, SEEK_SET) != 0 && !p->file.cause) p->file.cause = errno; /* it writes, too */
    hk_put_little(p->file.stream, p->samples, 4);
  }
  bool fine = hk_whole_close(&p->file, keep, why, size);
  free(p->id);
  *p = (hk_pc2){0};
  return fine;
}
