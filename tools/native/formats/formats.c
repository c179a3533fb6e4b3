/* A file of a frame is opened, written and closed; what went wrong is one sentence. */
#define _GNU_SOURCE
#include "tools/native/formats/formats.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

bool hk_whole_failed(int cause, char *why, size_t size) {
  snprintf(why, size, "%s", strerror(cause ? cause : EIO));
  return false;
}

bool hk_whole_open(hk_whole_file *f, const char *path, char *why, size_t size) {
  f->stream = NULL, f->cause = 0;
  if (snprintf(f->path, sizeof f->path, "%s", path) >= (int)sizeof f->path)
    return hk_whole_failed(ENAMETOOLONG, why, size);
  snprintf(f->part, sizeof f->part, "%s.part", path);
  unlink(f->part);
  int file = open(f->part, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file >= 0) f->stream = fdopen(file, "wb");
  int cause = errno;
  if (file >= 0 && !f->stream) {
    close(file);
    unlink(f->part);
  }
  return f->stream || hk_whole_failed(cause, why, size);
}

bool hk_whole_check(hk_whole_file *f) {
  if (ferror(f->stream) && !f->cause) f->cause = errno ? errno : EIO;
  return f->cause == 0;
}

bool hk_whole_close(hk_whole_file *f, bool keep, char *why, size_t size) {
  if (!f->stream) return true;
  if (fflush(f->stream) != 0 && !f->cause) f->cause = errno;
  hk_whole_check(f);
  if (fclose(f->stream) != 0 && !f->cause) f->cause = errno;
  f->stream = NULL;
  if (keep && !f->cause && rename(f->part, f->path) == 0) return true;
  if (keep && !f->cause) f->cause = errno;
  unlink(f->part);
  return f->cause == 0 || hk_whole_failed(f->cause, why, size);
}

bool hk_sequence_write(const hk_sequence_format *format, const hk_frame_data *data, const char *path, char *why,
                       size_t size) {
  hk_whole_file file;
  if (!hk_whole_open(&file, path, why, size)) return false;
  format->write(file.stream, data);
  hk_whole_check(&file);
  return hk_whole_close(&file, true, why, size);
}

double hk_frame_middle(const hk_frame_data *s, double middle[3]) {
  double diagonal = 0;
  for (int c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < s->n; i++) low = fmin(low, s->x[3 * i + c]), high = fmax(high, s->x[3 * i + c]);
    middle[c] = s->n ? (low + high) / 2 : 0;
    diagonal = hypot(diagonal, s->n ? high - low : 0);
  }
  return diagonal;
}
