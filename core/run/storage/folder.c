/* The output folder. A hidden list in it names the scene and every file that its run wrote there; a new run of the same
 * scene removes exactly those. Files that are not on the list are never touched. No link below the folder is followed,
 * and none to the folder that hooke chooses itself: somebody else may have put it there. A run that goes on from a
 * checkpoint removes nothing: its files are in a folder of their own below, named by the step. The list is locked as
 * long as a run writes; the system lets go of it with the process, however that ends. */
#define _GNU_SOURCE /* O_PATH */
#include "core/run/storage/storage.h"
#include "core/engine/base/base.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct listed {
  char *name, *owner; /* owner NULL: the run itself, or an earlier part of it */
  uint64_t hash;      /* of the name: a film has a hundred thousand */
} listed;

struct hk_folder {
  char path[PATH_MAX / 2];
  bool named;     /* by the user */
  int descriptor; /* of the folder; -1 until the first file is requested */
  FILE *list;     /* NULL until the first file is requested */
  size_t count;
  struct listed *file; /* of this run */
  char *scene;
  struct timespec released;      /* when the list was written last, at the release */
  const char *const (*taken)[2]; /* options and the files that they name; NULL: none */
  char part[32]; /* subfolder of a run that goes on, "from-step-1200/"; "": none, and earlier files are removed */
};

static const char list_name[] = ".hooke-files";

#ifdef O_PATH
enum { HOLD = O_PATH | O_DIRECTORY | O_CLOEXEC }; /* needs no right to list the folder */
#else
enum { HOLD = O_RDONLY | O_DIRECTORY | O_CLOEXEC };
#endif

static hk_status io_error(hk_error *error, const char *doing, const char *path) {
  return hk_error_set(error, errno == ENOMEM ? HK_NO_MEMORY : HK_IO, "cannot %s %s: %s", doing, path,
                      hk_file_reason(errno));
}

hk_folder *hk_folder_open(const char *out, const char *scene, hk_error *error) {
  hk_folder *f = calloc(1, sizeof *f);
  if (f) f->scene = hk_string_copy(scene);
  if (f) f->descriptor = -1, f->named = out != NULL;
  if (!f || !f->scene) {
    hk_folder_close(f);
    hk_error_set(error, HK_NO_MEMORY, "no memory for the output folder");
    return NULL;
  }
  int length = snprintf(f->path, sizeof f->path, out ? "%s" : "out/%s", out ? out : scene);
  bool nameless = !out && (*scene == 0 || strcmp(scene, ".") == 0 || strcmp(scene, "..") == 0);
  if (length > 0 && length < (int)sizeof f->path && !nameless) return f;
  hk_error_set(error, HK_BAD_PARAM,
               nameless ? "'%s' names no output folder: name one with --out"
               : length ? "the name of the output folder is too long"
                        : "--out: the folder has no name",
               scene);
  hk_folder_close(f);
  return NULL;
}

void hk_folder_release(hk_folder *f) {
  struct stat info;
  if (!f) return;
  if (f->list && fstat(fileno(f->list), &info) == 0) f->released = info.st_mtim;
  if (f->list) fclose(f->list);
  if (f->descriptor >= 0) close(f->descriptor);
  f->list = NULL;
  f->descriptor = -1;
}

void hk_folder_close(hk_folder *f) {
  if (!f) return;
  hk_folder_release(f);
  for (size_t k = 0; k < f->count; k++) {
    free(f->file[k].name);
    free(f->file[k].owner);
  }
  free(f->file);
  free(f->scene);
  free(f);
}

static bool safe_name(const char *name) {
  if (*name == '/' || *name == 0 || strchr(name, '\n')) return false;
  for (const char *part = name; part; part = strchr(part, '/')) {
    part += *part == '/';
    if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == 0)) return false;
  }
  return true;
}

static int open_folder(int at, const char *name) { return openat(at, name, HOLD | O_NOFOLLOW); }

/* Opens, and with `make` makes, the folder of the last slash of `path`, below `at`, past no link. The rest of the path
 * goes to `last`. -1 with errno. */
static int open_parent(int at, const char *path, bool make, const char **last) {
  char part[PATH_MAX];
  int folder = open_folder(at, ".");
  for (const char *slash; folder >= 0 && (slash = strchr(path, '/')); path = slash + 1) {
    size_t length = (size_t)(slash - path);
    if (length == 0) continue;
    snprintf(part, sizeof part, "%.*s", (int)length, path);
    bool made = !make || mkdirat(folder, part, 0777) == 0 || errno == EEXIST;
    int inner = made ? open_folder(folder, part) : -1, cause = errno;
    close(folder);
    errno = cause;
    folder = inner;
  }
  *last = path;
  return folder;
}

static void remove_below(int folder, const char *name) {
  const char *last, *inner = strrchr(name, '/');
  int parent = open_parent(folder, name, false, &last);
  if (parent < 0) return;
  unlinkat(parent, last, 0);
  close(parent);
  if (!inner) return;
  char above[PATH_MAX];
  snprintf(above, sizeof above, "%.*s", (int)(inner - name), name);
  parent = open_parent(folder, above, false, &last);
  if (parent < 0) return;
  unlinkat(parent, last, AT_REMOVEDIR); /* only when it is empty */
  close(parent);
}

static void remove_listed(const hk_folder *f, FILE *list) {
  char line[PATH_MAX / 2];
  while (fgets(line, sizeof line, list)) {
    line[strcspn(line, "\n")] = 0;
    if (safe_name(line)) remove_below(f->descriptor, line);
  }
}

/* The list in the folder; -1 with errno. A pipe does not block, and is refused as what it is. */
static int open_list(const hk_folder *f, int flags) {
  struct stat info;
  int list = openat(f->descriptor, list_name, flags | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  if (list < 0 || (fstat(list, &info) == 0 && S_ISREG(info.st_mode))) return list;
  close(list);
  errno = ENOTBLK;
  return -1;
}

/* Makes every folder on the way to the last slash of `path`, past links as they come. */
static bool make_parents(char *path) {
  bool made = true;
  for (char *slash = strchr(path + 1, '/'); slash && made; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    made = mkdir(path, 0777) == 0 || errno == EEXIST;
    *slash = '/';
  }
  return made;
}

/* Below the folder no link is followed; on the way to one that the user names they are the user's. */
static hk_status open_place(hk_folder *f, hk_error *error) {
  char path[PATH_MAX];
  const char *last;
  snprintf(path, sizeof path, "%s/", f->path);
  if (!f->named)
    f->descriptor = open_parent(AT_FDCWD, path, true, &last);
  else if (make_parents(path))
    f->descriptor = open(path, HOLD);
  if (f->descriptor >= 0) return HK_OK;
  if (errno == ELOOP || (errno == ENOTDIR && !f->named))
    return hk_error_set(error, HK_IO,
                        "cannot create the folder %s: a part of it is a link or a file; name a folder with --out",
                        f->path);
  return io_error(error, "create the folder", f->path);
}

static uint64_t hash_of(const char *name) { /* FNV-1a */
  uint64_t hash = 1469598103934665603u;
  for (; *name; name++) hash = (hash ^ (unsigned char)*name) * 1099511628211u;
  return hash;
}

static bool remember(hk_folder *f, const char *name, const char *owner) {
  listed *grown = realloc(f->file, (f->count + 1) * sizeof *grown);
  listed new = {.name = hk_string_copy(name), .hash = hash_of(name)};
  if (owner) new.owner = hk_string_copy(owner);
  if (grown) f->file = grown;
  bool fine = grown && new.name && (new.owner || !owner);
  if (fine)
    f->file[f->count++] = new;
  else
    free(new.name), free(new.owner);
  return fine;
}

/* The files of an earlier part of this run, which are its own too. */
static bool remember_listed(hk_folder *f) {
  char line[PATH_MAX / 2];
  bool fine = true;
  while (fine && fgets(line, sizeof line, f->list)) {
    line[strcspn(line, "\n")] = 0;
    fine = remember(f, line, NULL);
  }
  return fine;
}

/* Opens the list, which no other run may have open. */
static hk_status lock_list(hk_folder *f, const char *path, hk_error *error) {
  int file = open_list(f, O_RDWR | O_CREAT);
  f->list = file < 0 ? NULL : fdopen(file, "r+");
  if (!f->list) {
    hk_status status = io_error(error, "write", path);
    if (file >= 0) close(file);
    return status;
  }
  if (flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return HK_OK; /* not every file system has locks */
  return hk_error_set(error, HK_IO, "another run is writing to %s: wait for its end, or name another folder with --out",
                      f->path);
}

/* A new list, in place of the old one and under its lock. */
static hk_status clear_list(hk_folder *f, hk_error *error) {
  rewind(f->list);
  if (ftruncate(fileno(f->list), 0) != 0 || fprintf(f->list, "%s\n", f->scene) < 0 || fflush(f->list) != 0)
    return io_error(error, "write", list_name);
  return HK_OK;
}

/* Goes on with the list of the run's earlier part. */
static hk_status keep_list(hk_folder *f, hk_error *error) {
  if (!remember_listed(f)) return hk_error_set(error, HK_NO_MEMORY, "no memory for the list of files");
  return fseek(f->list, 0, SEEK_END) == 0 ? HK_OK : io_error(error, "write", list_name);
}

/* Removes the files of an earlier run of this scene and begins a new list, or goes on with the old one. */
static hk_status begin_list(hk_folder *f, hk_error *error) {
  char path[PATH_MAX], owner[256] = "";
  hk_status status = open_place(f, error);
  if (status != HK_OK) return status;
  snprintf(path, sizeof path, "%s/%s", f->path, list_name);
  status = lock_list(f, path, error);
  if (status != HK_OK) return status;
  bool old = fgets(owner, sizeof owner, f->list);
  owner[strcspn(owner, "\n")] = 0;
  if (old && strcmp(owner, f->scene) != 0)
    return hk_error_set(error, HK_IO, "%s holds the output of the scene '%s': name another folder with --out", f->path,
                        owner);
  if (old && *f->part) return keep_list(f, error);
  if (old) remove_listed(f, f->list);
  return clear_list(f, error);
}

/* The list is still that of this run: a new one writes it anew. */
static bool is_ours(hk_folder *f) {
  struct stat info;
  return fstat(fileno(f->list), &info) == 0 && info.st_mtim.tv_sec == f->released.tv_sec &&
         info.st_mtim.tv_nsec == f->released.tv_nsec && fseek(f->list, 0, SEEK_END) == 0;
}

bool hk_folder_restore(hk_folder *f) {
  hk_error ignored = {0};
  if (!f || f->count == 0) return false;
  if (f->list) return true;
  if (open_place(f, &ignored) == HK_OK && lock_list(f, list_name, &ignored) == HK_OK && is_ours(f)) return true;
  hk_folder_release(f);
  return false;
}

static const listed *find_listed(const hk_folder *f, const char *name) {
  uint64_t hash = hash_of(name);
  for (size_t k = f->count; k-- > 0;)
    if (f->file[k].hash == hash && strcmp(f->file[k].name, name) == 0) return &f->file[k];
  return NULL;
}

/* One file, one writer: of two, the second would write over what the first has written. */
static hk_status check_owner(const listed *file, const char *given, const char *owner, hk_error *error) {
  static const char *const own[] = {"summary.json", "measures.csv"};
  for (size_t k = 0; owner && k < sizeof own / sizeof *own; k++)
    if (strcmp(given, own[k]) == 0)
      return hk_error_set(error, HK_BAD_PARAM, "'%s': hooke itself writes %s: name another file", owner, given);
  if (!file || !file->owner || !owner || strcmp(file->owner, owner) == 0) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "'%s': the output '%s' writes %s as well: give one of them another name",
                      owner, file->owner, given);
}

static hk_status add_to_list(hk_folder *f, const char *name, const char *owner, hk_error *error) {
  if (!remember(f, name, owner)) return hk_error_set(error, HK_NO_MEMORY, "no memory for the list of files");
  if (fprintf(f->list, "%s\n", name) < 0 || fflush(f->list) != 0) return io_error(error, "write", list_name);
  return HK_OK;
}

const char *hk_folder_place(const hk_folder *f) { return f ? f->path : NULL; }

void hk_folder_go_on(hk_folder *f, size_t step) { snprintf(f->part, sizeof f->part, "from-step-%zu/", step); }

void hk_folder_spare(hk_folder *f, const char *const (*taken)[2]) { f->taken = taken; }

/* Whether an option names that file, by whatever path: the file would be written twice, and one of them be lost. */
static hk_status check_taken(const hk_folder *f, const char *owner, const char *name, hk_error *error) {
  char path[PATH_MAX], writer[128];
  snprintf(path, sizeof path, "%s/%s", f->path, name);
  snprintf(writer, sizeof writer, owner ? "output '%s'" : "the run", owner);
  hk_status status = HK_OK;
  for (size_t k = 0; f->taken && f->taken[k][0] && status == HK_OK; k++)
    status = hk_target_differs((const char *const[]){f->taken[k][0], writer},
                               (const char *const[]){f->taken[k][1], path}, error);
  return status;
}

/* The folder at the request of its first file. What the run writes at its end is compared now. */
static hk_status begin(hk_folder *f, hk_error *error) {
  hk_status status = begin_list(f, error);
  if (status == HK_OK) status = check_taken(f, NULL, list_name, error);
  if (status == HK_OK) status = check_taken(f, NULL, "summary.json", error);
  if (status != HK_OK) hk_folder_release(f);
  return status;
}

hk_status hk_folder_path(hk_folder *f, const char *owner, const char *given, char *buffer, size_t size,
                         hk_error *error) {
  char name[PATH_MAX / 2];
  struct stat info;
  if (!safe_name(given) || snprintf(name, sizeof name, "%s%s", f->part, given) >= (int)sizeof name)
    return hk_error_set(error, HK_BAD_PARAM, "'%s' is not a file name inside the output folder", given);
  hk_status status = f->list ? HK_OK : begin(f, error);
  if (status != HK_OK) return status;
  if (snprintf(buffer, size, "%s/%s", f->path, name) >= (int)size)
    return hk_error_set(error, HK_IO, "the path %s/%s is too long", f->path, name);
  const char *last;
  const listed *file = find_listed(f, name);
  status = check_owner(file, given, owner, error);
  if (status == HK_OK) status = check_taken(f, owner, name, error);
  if (status != HK_OK) return status;
  int parent = open_parent(f->descriptor, name, true, &last);
  if (parent < 0) return io_error(error, "create the folder of", buffer);
  bool exists = fstatat(parent, last, &info, AT_SYMLINK_NOFOLLOW) == 0;
  close(parent);
  if (exists && !file)
    return hk_error_set(error, HK_IO, "%s is not from a run of this scene: move it, or name another folder with --out",
                        buffer);
  return file ? HK_OK : add_to_list(f, name, owner, error);
}
