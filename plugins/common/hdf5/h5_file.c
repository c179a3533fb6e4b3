/* HDF5's single-writer mode (SWMR) writes its metadata in an order in which a reader sees a whole file at every moment:
 * children before parents. Its virtual file layer lets us keep these writes until a commit, which applies them so:
 *
 *   1. what lies behind the end of the last commit, to which nothing refers yet;
 *   2. the superblock, which says how long the file is now;
 *   3. the changes of what was there, in the library's order.
 *
 * A crash between two writes leaves the file of the last commit, or one that is longer at its end. The superblock's
 * mark "open for writing", because of which readers refuse a file whose writer was killed, is left out: what it warns
 * of does not happen here. */
#define _GNU_SOURCE
#include "plugins/common/hdf5/h5_file.h"

#include "plugins/common/hdf5/h5_checksum.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

typedef struct write_ahead {
  haddr_t at;
  size_t size, first; /* of its bytes, in `bytes` */
} write_ahead;

struct hk_h5_file {
  hid_t id, driver;
  int file;
  char *path, *part; /* its name, and what it is called until it is sealed: PATH.part; NULL then */
  int cause;
  haddr_t end, committed; /* of the addresses in use; of what is on file */
  size_t count, room, size, capacity;
  write_ahead *ahead;
  char *bytes;
};

typedef struct driver_file {
  H5FD_t base; /* first member: the library's part */
  hk_h5_file *of;
} driver_file;

static hk_h5_file *file_of(const H5FD_t *f) { return ((const driver_file *)(const void *)f)->of; }

/* ---- writing to the file ---- */

static bool put(hk_h5_file *f, const char *bytes, size_t size, haddr_t at) {
  while (size > 0) {
    ssize_t count = pwrite(f->file, bytes, size, (off_t)at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      f->cause = count < 0 ? errno : ENOSPC;
      return false;
    }
    bytes += count, size -= (size_t)count, at += (haddr_t)count;
  }
  return true;
}

enum { FIRST, SUPERBLOCK, REST };

static int phase_of(const hk_h5_file *f, const write_ahead *w) {
  if (w->at == 0) return SUPERBLOCK;
  return w->at >= f->committed ? FIRST : REST;
}

static bool apply(hk_h5_file *f, int phase) {
  bool fine = true;
  for (size_t k = 0; k < f->count && fine; k++)
    if (phase_of(f, &f->ahead[k]) == phase)
      fine = put(f, f->bytes + f->ahead[k].first, f->ahead[k].size, f->ahead[k].at);
  return fine;
}

/* A file that is shorter than its superblock says is refused by readers. */
static bool stretch(hk_h5_file *f) {
  if (f->end <= f->committed || ftruncate(f->file, (off_t)f->end) == 0) return true;
  f->cause = errno;
  return false;
}

static bool apply_all(hk_h5_file *f) {
  if (f->cause) return false;
  if (!apply(f, FIRST) || !stretch(f) || !apply(f, SUPERBLOCK) || !apply(f, REST)) return false;
  if (f->end > f->committed) f->committed = f->end;
  f->count = f->size = 0;
  return true;
}

/* ---- the driver ---- */

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t access, haddr_t most) {
  hk_h5_file *const *f = H5Pget_driver_info(access);
  driver_file *made = f ? calloc(1, sizeof *made) : NULL;
  (void)name, (void)flags, (void)most;
  if (made) made->of = *f;
  return made ? &made->base : NULL;
}

static herr_t driver_close(H5FD_t *f) {
  free(f);
  return 0;
}

static herr_t driver_query(const H5FD_t *f, unsigned long *features) {
  (void)f;
  *features =
      H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_SUPPORTS_SWMR_IO;
  return 0;
}

static haddr_t driver_end(const H5FD_t *f, H5FD_mem_t type) {
  (void)type;
  return file_of(f)->end;
}

static herr_t driver_set_end(H5FD_t *f, H5FD_mem_t type, haddr_t end) {
  (void)type;
  file_of(f)->end = end;
  return 0;
}

/* The overlap of [a, a + size) with what was written ahead is taken from there. */
static void overlay(const hk_h5_file *f, const write_ahead *w, haddr_t at, size_t size, char *to) {
  haddr_t begin = w->at > at ? w->at : at, end = w->at + w->size < at + size ? w->at + w->size : at + size;
  if (begin < end) memcpy(to + (begin - at), f->bytes + w->first + (begin - w->at), (size_t)(end - begin));
}

static herr_t driver_read(H5FD_t *driver, H5FD_mem_t type, hid_t transfer, haddr_t at, size_t size, void *to) {
  const hk_h5_file *f = file_of(driver);
  (void)type, (void)transfer;
  memset(to, 0, size);
  for (size_t got = 0; got < size;) {
    ssize_t count = pread(f->file, (char *)to + got, size - got, (off_t)(at + got));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return -1;
    if (count == 0) break; /* the rest was written ahead */
    got += (size_t)count;
  }
  for (size_t k = 0; k < f->count; k++) overlay(f, &f->ahead[k], at, size, to);
  return 0;
}

static void *grown(void *memory, size_t *room, size_t need, size_t item) {
  size_t count = need + need / 2 + 64;
  void *larger = realloc(memory, count * item);
  if (larger) *room = count;
  return larger;
}

/* Bytes 8 and 11 of a superblock are its version and the marks of who has the file open; its last 4 are the checksum of
 * the others (HDF5 File Format Specification 3.0, II.A, superblock version 3). */
static void leave_mark_out(char *superblock, size_t size) {
  if (size < 48 || superblock[8] != 3) return;
  superblock[11] = 0;
  uint32_t sum = hk_h5_checksum(superblock, 44);
  for (int k = 0; k < 4; k++) superblock[44 + k] = (char)(sum >> 8 * k & 0xff);
}

static herr_t driver_write(H5FD_t *driver, H5FD_mem_t type, hid_t transfer, haddr_t at, size_t size, const void *from) {
  hk_h5_file *f = file_of(driver);
  (void)type, (void)transfer;
  if (f->count == f->room) {
    void *more = grown(f->ahead, &f->room, f->count + 1, sizeof *f->ahead);
    if (!more) return -1;
    f->ahead = more;
  }
  if (f->size + size > f->capacity) {
    void *more = grown(f->bytes, &f->capacity, f->size + size, 1);
    if (!more) return -1;
    f->bytes = more;
  }
  memcpy(f->bytes + f->size, from, size);
  if (at == 0) leave_mark_out(f->bytes + f->size, size);
  f->ahead[f->count++] = (write_ahead){at, size, f->size};
  f->size += size;
  return 0;
}

static const H5FD_class_t driver = {
#if H5_VERSION_GE(1, 13, 0)
    .version = H5FD_CLASS_VERSION,
    .value = (H5FD_class_value_t)600, /* 512 to 65535 are for other drivers than the library's */
#endif
    .name = "hooke",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(hk_h5_file *),
    .open = driver_open,
    .close = driver_close,
    .query = driver_query,
    .get_eoa = driver_end,
    .set_eoa = driver_set_end,
    .get_eof = driver_end,
    .read = driver_read,
    .write = driver_write,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

/* ---- the file ---- */

static void release(hk_h5_file *f) {
  if (f->driver > 0) H5FDunregister(f->driver);
  if (f->file >= 0) close(f->file);
  if (f->file >= 0 && f->part) unlink(f->part);
  free(f->path);
  free(f->part);
  free(f->ahead);
  free(f->bytes);
  free(f);
}

static hid_t access_by(hk_h5_file *f) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (access < 0) return -1;
  if (H5Pset_driver(access, f->driver, &f) >= 0 && H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0)
    return access;
  H5Pclose(access);
  return -1;
}

/* Under the name of its part, and past no link; what has that name was left by a process that was killed. A device is
 * written directly. */
static bool open_part(hk_h5_file *f, const char *path) {
  size_t size = strlen(path) + sizeof ".part";
  struct stat info;
  if (lstat(path, &info) == 0 && (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode))) {
    f->file = open(path, O_RDWR | O_NOFOLLOW | O_CLOEXEC);
    return f->file >= 0;
  }
  f->path = strdup(path);
  f->part = malloc(size);
  if (!f->path || !f->part) return false;
  snprintf(f->part, size, "%s.part", path);
  unlink(f->part);
  f->file = open(f->part, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  return f->file >= 0;
}

hk_h5_file *hk_h5_create(const char *path) {
  hk_h5_file *f = calloc(1, sizeof *f);
  if (!f) return NULL;
  H5dont_atexit(); /* all is closed here, and after a lack of memory HDF5 1.10 crashes in what it does at exit */
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* messages are made here */
  f->id = f->file = -1;
  open_part(f, path);
  int cause = errno;
  if (f->file >= 0) {
    f->driver = H5FDregister(&driver);
    hid_t access = f->driver > 0 ? access_by(f) : -1;
    hid_t create = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_obj_track_times(create, false); /* of the root group: the same run has the same file */
    f->id = access < 0 ? -1 : H5Fcreate(path, H5F_ACC_TRUNC, create, access);
    H5Pclose(create);
    if (access >= 0) H5Pclose(access);
    cause = EIO;
  }
  if (f->id >= 0) return f;
  release(f);
  errno = cause;
  return NULL;
}

hid_t hk_h5_id(const hk_h5_file *f) { return f->id; }

int hk_h5_cause(const hk_h5_file *f) { return f->cause; }

static bool library(hk_h5_file *f, herr_t result) {
  if (result < 0 && !f->cause) f->cause = EIO;
  return result >= 0;
}

/* The file gets its name when it is one. */
static bool give_name(hk_h5_file *f) {
  if (!f->part) return true;
  if (rename(f->part, f->path) != 0) {
    f->cause = errno;
    return false;
  }
  free(f->part);
  f->part = NULL;
  return true;
}

bool hk_h5_seal(hk_h5_file *f) { return library(f, H5Fstart_swmr_write(f->id)) && hk_h5_commit(f) && give_name(f); }

bool hk_h5_commit(hk_h5_file *f) { return library(f, H5Fflush(f->id, H5F_SCOPE_LOCAL)) && apply_all(f); }

void hk_h5_close(hk_h5_file *f, int *cause) {
  library(f, H5Fclose(f->id));
  apply_all(f);
  *cause = f->cause;
  release(f);
}
