/* Writing a file completely or not at all: it is written under a temporary name and then renamed. */
#include "core/run/storage/files.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

hk_status hk_io_error(hk_error *error, const char *doing, const char *path) {
  return hk_error_set(error, errno == ENOMEM ? HK_NO_MEMORY : HK_IO, "cannot %s %s: %s", doing, path,
                      errno ? hk_file_reason(errno) : "the file ends early");
}

/* Devices and pipes cannot be renamed onto; they are written directly. */
static bool plain_target(const char *path) {
  struct stat info;
  return stat(path, &info) != 0 || S_ISREG(info.st_mode);
}

FILE *hk_file_create(const char *path) {
  unlink(path);
  int descriptor = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  return descriptor < 0 ? NULL : fdopen(descriptor, "wb");
}

hk_status hk_write_file(const char *path, bool (*body)(FILE *, const void *), const void *what, hk_error *error) {
  char temporary[PATH_MAX];
  bool rename_it = plain_target(path);
  if (snprintf(temporary, sizeof temporary, rename_it ? "%s.part" : "%s", path) >= (int)sizeof temporary)
    return hk_error_set(error, HK_IO, "the path %s is too long", path);
  errno = 0;
  FILE *file = rename_it ? hk_file_create(temporary) : fopen(temporary, "wb");
  if (!file) return hk_io_error(error, "write", path);
  bool fine = body(file, what);
  fine = fclose(file) == 0 && fine;
  if (fine && rename_it) fine = rename(temporary, path) == 0;
  if (fine) return HK_OK;
  hk_status status = hk_io_error(error, "write", path);
  if (rename_it) unlink(temporary);
  return status;
}
