/* The output folder. A hidden list in it names the scene and every file that its run wrote there; a new run of the same
 * scene removes exactly those. Files that are not on the list are never touched. */
#include "core/storage/storage.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct hk_folder {
  char path[PATH_MAX / 2];
  FILE *list; /* NULL until the first file is requested */
  size_t count;
  char **name; /* files of this run */
  char *scene;
};

static const char list_name[] = ".hooke-files";

static hk_status io_error(hk_error *error, const char *doing, const char *path) {
  return hk_error_set(error, HK_IO, "cannot %s %s: %s", doing, path, strerror(errno));
}

hk_folder *hk_folder_open(const char *out, const char *scene, hk_error *error) {
  hk_folder *f = calloc(1, sizeof *f);
  if (f) f->scene = hk_string_copy(scene);
  if (!f || !f->scene) {
    hk_folder_close(f);
    hk_error_set(error, HK_NO_MEMORY, "no memory for the output folder");
    return NULL;
  }
  int length = snprintf(f->path, sizeof f->path, out ? "%s" : "out/%s", out ? out : scene);
  if (length > 0 && length < (int)sizeof f->path) return f;
  hk_error_set(error, HK_BAD_PARAM,
               length ? "the name of the output folder is too long" : "--out: the folder has no name");
  hk_folder_close(f);
  return NULL;
}

void hk_folder_close(hk_folder *f) {
  if (!f) return;
  if (f->list) fclose(f->list);
  for (size_t k = 0; k < f->count; k++) free(f->name[k]);
  free(f->name);
  free(f->scene);
  free(f);
}

/* Makes every folder on the way to the last slash of `path`. */
static int make_parents(char *path) {
  for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    int failed = mkdir(path, 0777) != 0 && errno != EEXIST;
    *slash = '/';
    if (failed) return -1;
  }
  return 0;
}

static bool safe_name(const char *name) {
  if (*name == '/' || *name == 0 || strchr(name, '\n')) return false;
  for (const char *part = name; part; part = strchr(part, '/')) {
    part += *part == '/';
    if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == 0)) return false;
  }
  return true;
}

static void remove_listed(const hk_folder *f, FILE *list) {
  char line[PATH_MAX / 2], path[PATH_MAX];
  while (fgets(line, sizeof line, list)) {
    line[strcspn(line, "\n")] = 0;
    if (!safe_name(line)) continue;
    snprintf(path, sizeof path, "%s/%s", f->path, line);
    unlink(path);
    char *slash = strrchr(path, '/');
    if (slash > path + strlen(f->path)) {
      *slash = 0;
      rmdir(path); /* removes the folder only when it is empty */
    }
  }
}

/* Removes the files of an earlier run of this scene, and begins a new list. */
static hk_status begin_list(hk_folder *f, hk_error *error) {
  char path[PATH_MAX], owner[256] = "";
  snprintf(path, sizeof path, "%s/%s", f->path, list_name);
  if (make_parents(path) != 0) return io_error(error, "create the folder", f->path);
  FILE *old = fopen(path, "r");
  if (old) {
    if (fgets(owner, sizeof owner, old)) owner[strcspn(owner, "\n")] = 0;
    bool ours = strcmp(owner, f->scene) == 0;
    if (ours) remove_listed(f, old);
    fclose(old);
    if (!ours)
      return hk_error_set(error, HK_IO, "%s holds the output of the scene '%s': name another folder with --out",
                          f->path, owner);
  }
  f->list = fopen(path, "w");
  if (!f->list || fprintf(f->list, "%s\n", f->scene) < 0 || fflush(f->list) != 0) return io_error(error, "write", path);
  return HK_OK;
}

static bool is_listed(const hk_folder *f, const char *name) {
  for (size_t k = f->count; k-- > 0;)
    if (strcmp(f->name[k], name) == 0) return true;
  return false;
}

static hk_status add_to_list(hk_folder *f, const char *name, hk_error *error) {
  char **grown = realloc(f->name, (f->count + 1) * sizeof *grown), *copy = hk_string_copy(name);
  if (grown) f->name = grown;
  if (!grown || !copy) {
    free(copy);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the list of files");
  }
  f->name[f->count++] = copy;
  if (fprintf(f->list, "%s\n", name) < 0 || fflush(f->list) != 0) return io_error(error, "write", list_name);
  return HK_OK;
}

hk_status hk_folder_path(hk_folder *f, const char *name, char *buffer, size_t size, hk_error *error) {
  struct stat info;
  if (!safe_name(name))
    return hk_error_set(error, HK_BAD_PARAM, "'%s' is not a file name inside the output folder", name);
  hk_status status = f->list ? HK_OK : begin_list(f, error);
  if (status != HK_OK) return status;
  if (snprintf(buffer, size, "%s/%s", f->path, name) >= (int)size)
    return hk_error_set(error, HK_IO, "the path %s/%s is too long", f->path, name);
  if (make_parents(buffer) != 0) return io_error(error, "create the folder of", buffer);
  if (lstat(buffer, &info) == 0) {
    if (is_listed(f, name)) return HK_OK;
    return hk_error_set(error, HK_IO, "%s is not from a run of this scene: move it, or name another folder with --out",
                        buffer);
  }
  return add_to_list(f, name, error);
}
