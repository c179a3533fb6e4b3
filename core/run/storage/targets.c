/* What the user names to be written is tried before a run: that a folder is missing or full of somebody else's rights
 * is better known before an hour of computing than after. Nothing stays behind. */
#include "core/run/storage/storage.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A device or a pipe is not opened: whoever reads the pipe would see its end. */
static bool can_open(const char *path, const struct stat *info) {
  if (S_ISDIR(info->st_mode)) errno = EISDIR;
  return !S_ISDIR(info->st_mode) && access(path, W_OK) == 0;
}

/* A file beside the one that is meant, which will be renamed (write_file.c). */
static bool can_create(const char *path) {
  char trial[PATH_MAX];
  if (snprintf(trial, sizeof trial, "%s.part", path) >= (int)sizeof trial) {
    errno = ENAMETOOLONG;
    return false;
  }
  unlink(trial);
  int file = open(trial, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) return false;
  close(file);
  return unlink(trial) == 0;
}

hk_status hk_target_file(const char *option, const char *path, hk_error *error) {
  struct stat info;
  if (!*path) return hk_error_set(error, HK_BAD_PARAM, "%s: the file has no name", option);
  bool plain = stat(path, &info) != 0 || S_ISREG(info.st_mode);
  if (plain ? can_create(path) : can_open(path, &info)) return HK_OK;
  return hk_error_set(error, HK_IO, "%s: cannot write %s: %s%s", option, path, strerror(errno),
                      errno == ENOENT ? "; make its folder first" : "; name another file");
}

hk_status hk_target_spares(const char *option, const char *path, const char *source, hk_error *error) {
  struct stat target, read;
  if (!path || !source || stat(path, &target) != 0 || stat(source, &read) != 0) return HK_OK;
  if (target.st_dev != read.st_dev || target.st_ino != read.st_ino || !S_ISREG(target.st_mode)) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s is what is to be run; name another file", option, path);
}

/* The name of the file or folder that a path would make, without the slashes behind it, and its folder. */
static const char *split(const char *path, char name[PATH_MAX], struct stat *folder) {
  char above[PATH_MAX];
  size_t end = strlen(path);
  while (end > 1 && path[end - 1] == '/') end--;
  if (snprintf(above, sizeof above, "%.*s", (int)end, path) >= (int)sizeof above) return NULL;
  char *slash = strrchr(above, '/');
  snprintf(name, PATH_MAX, "%s", slash ? slash + 1 : above);
  if (slash) slash[slash == above] = 0;
  return stat(slash ? above : ".", folder) == 0 ? name : NULL;
}

static bool is_same(const struct stat *a, const struct stat *b) {
  return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

hk_status hk_target_differs(const char *const option[2], const char *const path[2], hk_error *error) {
  struct stat info[2];
  if (!path[0] || !path[1]) return HK_OK;
  bool exists[2] = {stat(path[0], &info[0]) == 0, stat(path[1], &info[1]) == 0}, same = false;
  if (exists[0] && exists[1]) {
    same = is_same(&info[0], &info[1]) && S_ISREG(info[0].st_mode); /* into a device or a pipe both may go */
  } else if (!exists[0] && !exists[1]) {
    char room[2][PATH_MAX];
    const char *name[2] = {split(path[0], room[0], &info[0]), split(path[1], room[1], &info[1])};
    same = name[0] && name[1] && strcmp(name[0], name[1]) == 0 && is_same(&info[0], &info[1]);
  }
  if (!same) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s is the file of %s as well, and one would be lost; name another file",
                      option[1], path[1], option[0]);
}

/* The path is cut to the part that exists. */
static bool existing_part(char *path, struct stat *info) {
  while (stat(path, info) != 0) {
    char *slash = strrchr(path, '/');
    if (errno != ENOENT && errno != ENOTDIR) return false;
    if (!slash || slash == path)
      strcpy(path, slash ? "/" : ".");
    else
      *slash = 0;
  }
  return true;
}

hk_status hk_target_folder(const char *option, const char *path, hk_error *error) {
  char part[PATH_MAX];
  struct stat info;
  if (!*path) return hk_error_set(error, HK_BAD_PARAM, "%s: the folder has no name", option);
  if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part)
    return hk_error_set(error, HK_BAD_PARAM, "%s: the name of the folder is too long", option);
  if (!existing_part(part, &info))
    return hk_error_set(error, HK_IO, "%s: cannot make the folder %s: %s", option, path, strerror(errno));
  if (!S_ISDIR(info.st_mode))
    return hk_error_set(error, HK_IO, "%s: cannot make the folder %s: %s is a file; name another folder", option, path,
                        part);
  if (access(part, W_OK | X_OK) == 0) return HK_OK;
  return hk_error_set(error, HK_IO, "%s: cannot write in %s: %s; name another folder", option, part, strerror(errno));
}
