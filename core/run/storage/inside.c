/* Opening files whose name comes from a script. A file counts as inside a folder when its real path is, whatever links
 * led there; nothing is said of files outside, not even whether they exist. Pipes and devices, which may block or never
 * end, are no plain files. */
#include "core/run/storage/storage.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The real path of the file or, where there is none, of the nearest folder above it. */
static bool nearest_path(const char *path, char real[PATH_MAX]) {
  char above[PATH_MAX];
  if (snprintf(above, sizeof above, "%s", path) >= (int)sizeof above) return false;
  while (!realpath(above, real)) {
    char *slash = strrchr(above, '/');
    if (slash == above || (errno != ENOENT && errno != ENOTDIR)) return false;
    if (!slash) return realpath(".", real) != NULL;
    *slash = 0;
  }
  return true;
}

static bool is_inside(const char *real, const char *folder) {
  char place[PATH_MAX];
  if (!folder || !realpath(folder, place)) return false;
  size_t length = strcmp(place, "/") == 0 ? 0 : strlen(place);
  return strncmp(real, place, length) == 0 && (real[length] == '/' || real[length] == 0);
}

static bool is_allowed(const char *path, const char *const *within) {
  char real[PATH_MAX];
  bool inside = false;
  if (!nearest_path(path, real)) return false;
  for (; *within && !inside; within++) inside = is_inside(real, *within);
  return inside;
}

FILE *hk_file_read(const char *path, const char *const *within) {
  struct stat info;
  char real[PATH_MAX];
  if (!within) return fopen(path, "rb");
  if (!is_allowed(path, within)) {
    errno = EXDEV;
    return NULL;
  }
  if (!realpath(path, real)) return NULL;
  int descriptor = open(real, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  FILE *file = NULL;
  if (descriptor < 0) return NULL;
  if (fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode))
    file = fdopen(descriptor, "rb");
  else
    errno = ENOTBLK;
  if (file) return file;
  int cause = errno;
  close(descriptor);
  errno = cause;
  return NULL;
}

const char *hk_file_reason(int cause) {
  if (cause == EXDEV)
    return "it is outside the folders that a scene may read, its own and scripts/lib; --trust lifts this for scenes "
           "that "
           "you trust";
  return cause == ENOTBLK ? "it is not a plain file" : strerror(cause);
}
