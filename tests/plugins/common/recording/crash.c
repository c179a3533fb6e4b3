/* A process that ends at any write of a recording leaves all frames that were whole, and before the first no file:
 * this program's pwrite and ftruncate end a child process, or fail, at the k-th call, for every k. */
#define _GNU_SOURCE
#include "plugins/common/recording/reader.h"
#include "plugins/common/recording/recording.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { FRAMES = 4, MOST = 40 };

static long calls, ends_at, fails_at; /* 0: never */

static bool next_call_fails(void) {
  calls++;
  if (calls == ends_at) _exit(9);
  if (fails_at && calls >= fails_at) errno = ENOSPC;
  return fails_at && calls >= fails_at;
}

ssize_t pwrite(int file, const void *from, size_t size, off_t at) {
  return next_call_fails() ? -1 : (ssize_t)syscall(SYS_pwrite64, file, from, size, at);
}

int ftruncate(int file, off_t length) { return next_call_fails() ? -1 : (int)syscall(SYS_ftruncate, file, length); }

/* ---- the frames: particles come and go, so that cells are written anew ---- */

static double x[3 * MOST], v[3 * MOST], mass[MOST], heat[MOST], strain[MOST];
static uint32_t id[MOST], vertex[MOST], segment[MOST][2];
static uint8_t pin[MOST];
static hk_frame_array array = {.name = "heat", .width = 1, .value = heat};

static size_t count_at(int k) { return k < 2 ? 20 : (size_t)(20 + 3 * (k / 2)); }

static hk_frame_data data_at(int k) {
  hk_frame_data s = {
      .t = k / 10.0, .n = count_at(k), .x = x, .v = v, .mass = mass, .id = id, .pin = pin, .strain = strain};
  for (size_t i = 0; i < s.n; i++) {
    for (size_t c = 0; c < 3; c++) x[3 * i + c] = sin((double)(i * 3 + c) + k), v[3 * i + c] = cos((double)i * k);
    mass[i] = 1 + (double)i, id[i] = (uint32_t)(i + 1 + (size_t)(k / 2)), heat[i] = k + 0.1 * (double)i;
    strain[i] = 0.01 * (double)i;
  }
  s.cells = (hk_frame_cells){.vertices = s.n - 10, .segments = 9, .vertex = vertex, .segment = segment};
  for (uint32_t i = 0; i < 9; i++) segment[i][0] = i, segment[i][1] = i + 1;
  for (uint32_t i = 10; i < s.n; i++) vertex[i - 10] = i;
  s.arrays = 1, s.array = &array;
  return s;
}

static hk_frame frame_at(int k) {
  return (hk_frame){.index = (size_t)k, .fps = 10, .kinetic = k, .potential = -k / 3.0};
}

static char h5[64], xdmf[64];

static bool record(char *why, size_t size) {
  hk_frame_data first = data_at(0);
  hk_frame frame = frame_at(0);
  hk_recorder_setup setup = {.level = 1, .every = 1};
  hk_recorder *r = hk_recorder_open(h5, xdmf, &setup, &first, &frame, why, size);
  bool fine = r != NULL;
  for (int k = 0; k < FRAMES && fine; k++) {
    hk_frame_data s = data_at(k);
    frame = frame_at(k);
    fine = hk_recorder_add(r, &s, k % 2 == 0, &frame, why, size);
  }
  char late[256];
  return (!r || hk_recorder_close(r, fine ? "ok" : NULL, fine ? why : late, fine ? size : sizeof late)) && fine;
}

static void check_frame(const hk_recording *r, int k) {
  double got[3 * MOST];
  uint32_t ids[MOST], pairs[2 * MOST];
  hk_frame_data s = data_at(k);
  const hk_recorded_part *p = hk_recorded_part_of(r, (size_t)k);
  assert_int_equal(p->n, s.n);
  assert_true(r->time[k] == s.t);
  assert_true(hk_recording_moving(r, r->points, (size_t)k, 3, got));
  assert_memory_equal(got, s.x, 3 * s.n * sizeof *got);
  assert_true(hk_recording_moving(r, r->array[0].set, (size_t)k, 1, got));
  assert_memory_equal(got, heat, s.n * sizeof *got);
  assert_true(hk_recording_fixed(r, r->id, (size_t)k, H5T_NATIVE_UINT32, ids));
  assert_memory_equal(ids, data_at(k / 2 * 2).id, s.n * sizeof *ids);
  assert_true(hk_recording_segments(r, (size_t)k, pairs));
  assert_memory_equal(pairs, segment, sizeof segment[0] * 9);
}

/* The number of frames in the file, all of which are right; -1: it cannot be read. */
static int frames_on_file(void) {
  char why[256];
  hk_recording *r = hk_recording_open(h5, why, sizeof why);
  int frames = r ? (int)r->frames : -1;
  for (int k = 0; k < frames; k++) check_frame(r, k);
  hk_recording_close(r);
  return frames;
}

static void set_up(void) {
  snprintf(h5, sizeof h5, "/tmp/hooke-test-%d.h5", (int)getpid());
  snprintf(xdmf, sizeof xdmf, "/tmp/hooke-test-%d.xdmf", (int)getpid());
  calls = ends_at = fails_at = 0;
}

static void tear_down(void) {
  char part[80];
  const char *const made[] = {h5, xdmf};
  for (int k = 0; k < 2; k++) {
    snprintf(part, sizeof part, "%s.part", made[k]);
    remove(made[k]);
    remove(part);
  }
}

static void what_is_written_is_read(void **state) {
  char why[256] = "";
  (void)state;
  set_up();
  if (!record(why, sizeof why)) fail_msg("%s", why);
  assert_int_equal(frames_on_file(), FRAMES);
  hk_recording *r = hk_recording_open(h5, why, sizeof why);
  assert_string_equal(r->verdict, "ok");
  for (int k = 0; k < FRAMES; k++) assert_int_equal(r->frame[k].changed, k % 2 == 0);
  hk_recording_close(r);
  tear_down();
}

static void a_process_that_ends_at_any_write_leaves_the_frames_before(void **state) {
  char why[256];
  int last = -1, seen[FRAMES + 1] = {0};
  (void)state;
  set_up();
  assert_true(record(why, sizeof why));
  long all = calls;
  for (long k = 1; k <= all; k++) {
    remove(h5);
    pid_t child = fork();
    if (child == 0) {
      calls = 0, ends_at = k;
      record(why, sizeof why);
      _exit(0);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 9);
    int frames = frames_on_file();
    if (frames < 0 && access(h5, F_OK) == 0) fail_msg("ended at write %ld of %ld: the file is none yet", k, all);
    if (frames < last) fail_msg("ended at write %ld of %ld: %d frames, %d before", k, all, frames, last);
    last = frames;
    if (frames >= 0) seen[frames]++;
  }
  for (int k = 0; k <= FRAMES; k++) assert_true(seen[k] > 0); /* each was once the last */
  print_message("%ld writes\n", all);
  tear_down();
}

static void a_full_disk_is_said_at_any_write(void **state) {
  char why[256];
  (void)state;
  set_up();
  assert_true(record(why, sizeof why));
  long all = calls;
  int last = -1;
  for (long k = 1; k <= all; k += 5) {
    remove(h5);
    calls = 0, fails_at = k;
    *why = 0;
    if (record(why, sizeof why)) fail_msg("it does not see that write %ld of %ld failed", k, all);
    if (strcmp(why, strerror(ENOSPC)) != 0) fail_msg("write %ld: '%s'", k, why);
    int frames = frames_on_file();
    if (frames < last) fail_msg("write %ld of %ld failed: %d frames, %d before", k, all, frames, last);
    last = frames;
  }
  tear_down();
}

/* A link that has the name makes room; a device, here one like /dev/full, stays and says what it is. */
static void links_make_room_and_devices_stay(void **state) {
  char why[256] = "", victim[80];
  struct stat info;
  (void)state;
  set_up();
  snprintf(victim, sizeof victim, "%s.victim", h5);
  FILE *file = fopen(victim, "w");
  assert_non_null(file);
  fputs("mine", file);
  fclose(file);
  assert_int_equal(symlink(victim, h5), 0);
  assert_true(record(why, sizeof why));
  assert_int_equal(frames_on_file(), FRAMES);
  assert_true(stat(victim, &info) == 0 && info.st_size == 4);
  remove(victim);
  remove(h5);
  if (mknod(h5, S_IFCHR | 0600, makedev(1, 7)) == 0) { /* as root */
    assert_false(record(why, sizeof why));
    assert_string_equal(why, strerror(ENOSPC));
    assert_true(stat(h5, &info) == 0 && S_ISCHR(info.st_mode));
  }
  tear_down();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_written_is_read),
      cmocka_unit_test(a_process_that_ends_at_any_write_leaves_the_frames_before),
      cmocka_unit_test(a_full_disk_is_said_at_any_write),
      cmocka_unit_test(links_make_room_and_devices_stay),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
