/* Frames are added behind the head, and then counted in it. */
#include "tools/native/formats/pc2.h"

#include "tools/native/formats/bytes.h"
#include "tools/native/formats/formats.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES_AT = 28 };

static bool failed(char *why, size_t size) {
  snprintf(why, size, "%s", strerror(errno ? errno : EIO));
  return false;
}

bool hk_pc2_open(hk_pc2 *p, const char *path, const hk_frame_data *first, char *why, size_t size) {
  *p = (hk_pc2){.n = first->n, .id = malloc((first->n + 1) * sizeof *p->id)};
  if (!p->id) return failed(why, size);
  memcpy(p->id, first->id, first->n * sizeof *p->id);
  errno = 0;
  p->file = hk_sequence_file(path, "wb");
  if (!p->file) return failed(why, size);
  fwrite("POINTCACHE2", 1, 12, p->file);
  hk_put_little(p->file, 1, 4);
  hk_put_little(p->file, first->n, 4);
  hk_put_little(p->file, hk_bits_single(0), 4);
  hk_put_little(p->file, hk_bits_single(1), 4);
  hk_put_little(p->file, 0, 4);
  return fflush(p->file) == 0 || failed(why, size);
}

bool hk_pc2_fits(const hk_pc2 *p, const hk_frame_data *s) {
  return s->n == p->n && memcmp(s->id, p->id, s->n * sizeof *p->id) == 0;
}

bool hk_pc2_add(hk_pc2 *p, const hk_frame_data *s, char *why, size_t size) {
  errno = 0;
  fseek(p->file, 0, SEEK_END);
  for (size_t k = 0; k < 3 * s->n; k++) hk_put_little(p->file, hk_bits_single((float)s->x[k]), 4);
  if (fflush(p->file) != 0 || ferror(p->file)) return failed(why, size);
  fseek(p->file, SAMPLES_AT, SEEK_SET);
  hk_put_little(p->file, ++p->samples, 4);
  return (fflush(p->file) == 0 && !ferror(p->file)) || failed(why, size);
}

bool hk_pc2_close(hk_pc2 *p, char *why, size_t size) {
  bool fine = !p->file || hk_sequence_file_close(p->file, why, size);
  free(p->id);
  *p = (hk_pc2){0};
  return fine;
}
