/* Files and clocks of a plugin: see outside.h. */
#define _GNU_SOURCE 1
#include "tools/native/common/outside.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>

static struct {
  atomic_size_t files;
  double ahead; /* s */
} outside;

void hk_outside_shift(double seconds) { outside.ahead = seconds; }

size_t hk_outside_files(void) { return atomic_load(&outside.files); }

static void count(void) { atomic_fetch_add(&outside.files, 1); }

/* ---- files ---- */

static FILE *our_fopen(const char *path, const char *mode) {
  count();
  return fopen(path, mode);
}

static FILE *our_freopen(const char *path, const char *mode, FILE *file) {
  count();
  return freopen(path, mode, file);
}

static FILE *our_popen(const char *command, const char *mode) {
  count();
  return popen(command, mode);
}

static DIR *our_opendir(const char *path) {
  count();
  return opendir(path);
}

static int our_open(const char *path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  int mode = flags & O_CREAT ? va_arg(list, int) : 0;
  va_end(list);
  count();
  return open(path, flags, mode);
}

static int our_openat(int folder, const char *path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  int mode = flags & O_CREAT ? va_arg(list, int) : 0;
  va_end(list);
  count();
  return openat(folder, path, flags, mode);
}

static int our_creat(const char *path, mode_t mode) {
  count();
  return creat(path, mode);
}

static int our_socket(int domain, int type, int protocol) {
  count();
  return socket(domain, type, protocol);
}

/* ---- clocks ---- */

static time_t our_time(time_t *at) {
  time_t now = time(NULL) + (time_t)outside.ahead;
  if (at) *at = now;
  return now;
}

static int our_clock_gettime(clockid_t which, struct timespec *at) {
  int failed = clock_gettime(which, at);
  at->tv_sec += (time_t)outside.ahead;
  return failed;
}

static int our_gettimeofday(struct timeval *at, void *zone) {
  int failed = gettimeofday(at, zone);
  at->tv_sec += (time_t)outside.ahead;
  return failed;
}

static int our_timespec_get(struct timespec *at, int base) {
  int got = timespec_get(at, base);
  at->tv_sec += (time_t)outside.ahead;
  return got;
}

static clock_t our_clock(void) { return clock() + (clock_t)(outside.ahead * CLOCKS_PER_SEC); }

const hk_import hk_outside_calls[] = {{"fopen", (uintptr_t)our_fopen},
                                      {"fopen64", (uintptr_t)our_fopen},
                                      {"freopen", (uintptr_t)our_freopen},
                                      {"popen", (uintptr_t)our_popen},
                                      {"opendir", (uintptr_t)our_opendir},
                                      {"open", (uintptr_t)our_open},
                                      {"open64", (uintptr_t)our_open},
                                      {"openat", (uintptr_t)our_openat},
                                      {"openat64", (uintptr_t)our_openat},
                                      {"creat", (uintptr_t)our_creat},
                                      {"socket", (uintptr_t)our_socket},
                                      {"time", (uintptr_t)our_time},
                                      {"clock_gettime", (uintptr_t)our_clock_gettime},
                                      {"gettimeofday", (uintptr_t)our_gettimeofday},
                                      {"timespec_get", (uintptr_t)our_timespec_get},
                                      {"clock", (uintptr_t)our_clock},
                                      {NULL, 0}};
