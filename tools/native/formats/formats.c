/* A file of a frame is opened, written and closed; what went wrong is one sentence. */
#define _GNU_SOURCE
#include "tools/native/formats/formats.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

FILE *hk_sequence_file(const char *path, const char *mode) {
  int file = open(path, O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
  FILE *stream = file < 0 ? NULL : fdopen(file, mode);
  if (file >= 0 && !stream) close(file);
  return stream;
}

bool hk_sequence_file_close(FILE *file, char *why, size_t size) {
  errno = 0;
  bool fine = fflush(file) == 0 && !ferror(file);
  int cause = errno;
  if (fclose(file) != 0 && fine) fine = false, cause = errno;
  if (!fine) snprintf(why, size, "%s", strerror(cause ? cause : EIO));
  return fine;
}

bool hk_sequence_write(const hk_sequence_format *format, const hk_frame_data *data, const char *path, char *why,
                       size_t size) {
  FILE *file = hk_sequence_file(path, "wb");
  if (!file) {
    snprintf(why, size, "%s", strerror(errno));
    return false;
  }
  format->write(file, data);
  return hk_sequence_file_close(file, why, size);
}
