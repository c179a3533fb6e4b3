/* Checkpoints: a run that goes on from one is judged as if it had not stopped, whatever was bad before; one that is
 * damaged, of another version or of another scene is refused with a sentence. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *spring(test_engine *e, double k) {
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, s, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(e, s, "k", k);
  test_number(e, s, "rest", 0.9);
  return s;
}

static void two_particles(test_engine *e) {
  test_engine_open(e);
  e->scene->duration = 2;
  e->scene->fps = 10;
  test_particle(e, 0, 0, 1, 1);
  test_particle(e, 1, 0, 1, 2);
}

/* Bad in its first half: the spring, which acts until 0.5 s, swings with h w = 2.05, beyond leapfrog's 2. The reduced
 * mass is 2/3 kg. */
static void unstable_at_first(test_engine *e) {
  two_particles(e);
  spring(e, 2.05 * 2.05 / 0.01 / 0.01 * 2 / 3)->to = 0.5;
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  e->options.dt = 0.01;
}

/* Both land on the floor in the first half, which takes energy and momentum that nobody counts. */
static void moved_by_a_corrector(test_engine *e) {
  two_particles(e);
  spring(e, 100);
  test_plugin(e, HK_FORCE, "gravity")->to = 0.9;
  test_plugin(e, HK_CORRECTOR, "fixture:floor");
}

static void fed_by_a_source(test_engine *e) {
  two_particles(e);
  spring(e, 100);
  test_number(e, test_plugin(e, HK_SOURCE, "fixture:spout"), "every", 0.6);
}

static void adaptive(test_engine *e) {
  two_particles(e);
  spring(e, 1000);
  test_plugin(e, HK_INTEGRATOR, "dopri5");
}

/* Swings that the steps do not resolve, until 1.2 s: in the median of all frames, which the verdict looks at, and not
 * in that of the second half. */
static void unresolved(test_engine *e) {
  two_particles(e);
  e->scene->particles.position[5] = 3;
  spring(e, 1e6)->to = 1.2;
  test_plugin(e, HK_INTEGRATOR, "implicit_midpoint");
}

static void constrained(test_engine *e) {
  two_particles(e);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t[][2]){{1, 2}}, 1);
  e->scene->particles.velocity[4] = 3;
  test_plugin(e, HK_FORCE, "gravity");
}

/* A particle that was held at its place falls from 0.5 s on. */
static void released(test_engine *e) {
  two_particles(e);
  spring(e, 100);
  uint32_t id = 1;
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = 1, .id = &id, .release = 0.5};
  assert_int_equal(hk_scene_add_pin(e->scene, &pin, &e->error), HK_OK);
  test_plugin(e, HK_FORCE, "gravity");
}

typedef void scene_maker(test_engine *);

static hk_summary end_of(test_engine *e) {
  hk_summary s;
  test_advance(e, 2);
  assert_int_equal(hk_run_close(e->run, &e->error), HK_OK);
  hk_run_summary(e->run, &s);
  return s;
}

static bool is_of_the_clock(const hk_figure *f) {
  return strstr(f->key, "wall") || strstr(f->key, "per_s") || strstr(f->key, "seconds");
}

static void same_figure(const hk_figure *f, const hk_summary *a, const hk_summary *b, size_t scene) {
  const void *x = (const char *)a + f->offset, *y = (const char *)b + f->offset;
  bool same = true;
  if (f->type == HK_FIGURE_NUMBER) {
    double p = *(const double *)x, q = *(const double *)y;
    same = p == q || (isnan(p) && isnan(q));
    if (!same) fail_msg("scene %zu: %s: %.17g, gone on %.17g", scene, f->key, p, q);
  } else if (f->type == HK_FIGURE_COUNT) {
    same = *(const size_t *)x == *(const size_t *)y;
    if (!same) fail_msg("scene %zu: %s: %zu, gone on %zu", scene, f->key, *(const size_t *)x, *(const size_t *)y);
  } else {
    const char *p = f->type == HK_FIGURE_BUFFER ? x : *(const char *const *)x;
    const char *q = f->type == HK_FIGURE_BUFFER ? y : *(const char *const *)y;
    if ((!p || !q) ? p != q : strcmp(p, q) != 0) fail_msg("scene %zu: %s: '%s', gone on '%s'", scene, f->key, p, q);
  }
}

static void same_summary(const hk_summary *a, const hk_summary *b, size_t scene) {
  for (const hk_figure *f = hk_figure_table; f->key; f++)
    if (!is_of_the_clock(f)) same_figure(f, a, b, scene);
  assert_int_equal(a->warnings, b->warnings);
}

/* Every figure of the summary but those of the clock, to the last bit, saved at a frame or between two. Implicit
 * methods factorize anew, so that their figures agree to their tolerance only: the verdict and what it is put down to
 * are compared. */
static void a_run_that_goes_on_is_judged_as_a_whole(void **state) {
  (void)state;
  scene_maker *const scenes[] = {unstable_at_first, moved_by_a_corrector, fed_by_a_source, adaptive,
                                 unresolved,        constrained,          released};
  char path[512];
  snprintf(path, sizeof path, "%s/whole.bin", test_folder());
  for (size_t k = 0; k < 2 * (sizeof scenes / sizeof *scenes); k++) {
    test_engine whole, second;
    scenes[k / 2](&whole);
    test_run(&whole);
    test_advance(&whole, k % 2 ? 0.95 : 1);
    assert_int_equal(hk_run_save(whole.run, path, &whole.error), HK_OK);
    hk_summary a = end_of(&whole);
    scenes[k / 2](&second);
    second.scene->start_file = strdup(path);
    test_run(&second);
    hk_summary b = end_of(&second);
    if (scenes[k / 2] == unresolved) {
      assert_true(a.verdict == HK_INACCURATE && b.verdict == HK_INACCURATE && a.steps == b.steps);
      assert_non_null(strstr(a.reason, "the steps do not resolve what swings"));
      assert_non_null(strstr(b.reason, "the steps do not resolve what swings"));
    } else {
      same_summary(&a, &b, k / 2);
      assert_memory_equal(hk_run_view(whole.run)->x, hk_run_view(second.run)->x, 3 * a.n * sizeof(double));
    }
    if (scenes[k / 2] == unstable_at_first) assert_int_equal(b.verdict, HK_INACCURATE);
    test_engine_close(&whole);
    test_engine_close(&second);
  }
}

/* ---- damage ---- */

enum { MOST = 1 << 14 };

typedef struct bytes {
  size_t count;
  unsigned char byte[MOST];
} bytes;

static void write_bytes(const char *path, const bytes *b, size_t count) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(b->byte, 1, count, file), count);
  fclose(file);
}

static bytes saved(scene_maker *make, const char *path) {
  test_engine e;
  bytes b;
  make(&e);
  test_run(&e);
  test_advance(&e, 0.5);
  assert_int_equal(hk_run_save(e.run, path, &e.error), HK_OK);
  test_engine_close(&e);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  b.count = fread(b.byte, 1, MOST, file);
  fclose(file);
  assert_true(b.count > 100 && b.count < MOST);
  return b;
}

/* Opens a run from it, and makes a few steps; the status, with the error's text. */
static hk_status open_from(scene_maker *make, const char *path, char *text, size_t size) {
  test_engine e;
  make(&e);
  e.scene->start_file = strdup(path);
  e.options.step_limit = 20;
  hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
  snprintf(text, size, "%s", e.error.text);
  if (status == HK_OK) hk_run_advance(e.run, hk_run_end(e.run), NULL);
  test_engine_close(&e);
  return status;
}

static void expect_refused(const char *path, const char *what) {
  char text[1024];
  hk_status status = open_from(moved_by_a_corrector, path, text, sizeof text);
  if (status != HK_IO && status != HK_BAD_PARAM) fail_msg("status %d, '%s'", (int)status, text);
  if (!strstr(text, "damaged.bin") || !strstr(text, what)) fail_msg("expected '%s' in '%s'", what, text);
}

static void one_that_is_cut_short_is_refused_at_every_length(void **state) {
  (void)state;
  char path[512];
  snprintf(path, sizeof path, "%s/damaged.bin", test_folder());
  bytes b = saved(moved_by_a_corrector, path);
  const size_t first_line = strlen("hooke checkpoint 8\n");
  for (size_t count = 0; count < b.count; count++) {
    write_bytes(path, &b, count);
    expect_refused(path, count >= first_line ? "is cut short or damaged" : "");
  }
}

static void one_with_any_byte_changed_is_refused(void **state) {
  (void)state;
  char path[512];
  snprintf(path, sizeof path, "%s/damaged.bin", test_folder());
  bytes b = saved(moved_by_a_corrector, path);
  const size_t first_line = strlen("hooke checkpoint 8\n");
  for (size_t at = 0; at < b.count; at++) {
    b.byte[at] ^= 0x81;
    write_bytes(path, &b, b.count);
    expect_refused(path, at >= first_line ? "is cut short or damaged" : "");
    b.byte[at] ^= 0x81;
  }
}

/* FNV-1a on eight lanes of words, and of what is left on bytes. */
static void sum_again(bytes *b) {
  const uint64_t basis = 1469598103934665603u, prime = 1099511628211u;
  const size_t first = strlen("hooke checkpoint 8\n"), end = b->count - 8;
  uint64_t lane[8], word, sum = basis;
  size_t k = first;
  for (size_t l = 0; l < 8; l++) lane[l] = basis + l;
  for (; k + sizeof lane <= end; k += sizeof lane)
    for (size_t l = 0; l < 8; l++) {
      memcpy(&word, b->byte + k + 8 * l, 8);
      lane[l] = (lane[l] ^ word) * prime;
    }
  for (size_t l = 0; l < 8; l++) sum = (sum ^ lane[l]) * prime;
  for (; k < end; k++) sum = (sum ^ b->byte[k]) * prime;
  memcpy(b->byte + end, &sum, 8);
}

/* Numbers of particles, samples, warnings and so on that no file of this length can hold, and truth values that are
 * none, under a checksum that is right: refused or, where the field may be anything, taken; never a crash, undefined
 * behaviour, a run without end, nor gigabytes of memory. */
static void numbers_in_it_are_not_believed(void **state) {
  (void)state;
  static const uint64_t values[] = {
      0, 1, 3, 1u << 20, UINT32_MAX, 1ull << 40, 1ull << 61, UINT64_MAX, 0x7ff8ull << 48, 0x0202020202020202,
  };
  char path[512], text[1024];
  snprintf(path, sizeof path, "%s/damaged.bin", test_folder());
  bytes whole = saved(moved_by_a_corrector, path);
  const size_t begin = strlen("hooke checkpoint 8\n"), words = (whole.count - begin - 8) / 8;
  size_t refused = 0;
  for (size_t w = 0; w < words; w++)
    for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
      bytes b = whole;
      memcpy(b.byte + begin + 8 * w, &values[k], 8);
      sum_again(&b);
      write_bytes(path, &b, b.count);
      hk_status status = open_from(moved_by_a_corrector, path, text, sizeof text);
      refused += status != HK_OK;
      if (status != HK_OK && !*text) fail_msg("word %zu: refused without a sentence", w);
    }
  assert_true(refused > 20 && refused < 9 * words); /* the sum is right */
}

/* How many words are refused where they have this value. */
static size_t refused_with(const bytes *whole, uint64_t value, const char *path) {
  const size_t begin = strlen("hooke checkpoint 8\n"), words = (whole->count - begin - 8) / 8;
  size_t refused = 0;
  char text[1024];
  for (size_t w = 0; w < words; w++) {
    bytes b = *whole;
    memcpy(b.byte + begin + 8 * w, &value, 8);
    sum_again(&b);
    write_bytes(path, &b, b.count);
    refused += open_from(fed_by_a_source, path, text, sizeof text) != HK_OK;
  }
  return refused;
}

/* A plugin that counts on would overflow; of other words both are the same damage. */
static void counts_beyond_any_run_are_refused(void **state) {
  (void)state;
  char path[512];
  snprintf(path, sizeof path, "%s/damaged.bin", test_folder());
  bytes whole = saved(fed_by_a_source, path);
  size_t large = refused_with(&whole, 1ull << 52, path), absurd = refused_with(&whole, (1ull << 53) + 1, path);
  assert_true(absurd > large);
}

static void with_an_obstacle(test_engine *e) {
  two_particles(e);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_CORRECTOR, "obstacle"), "radius", 0.05);
}

/* The obstacle keeps three poses of one size: a list without any, and all that follows it as it was, is of no run. */
static void a_list_of_another_length_than_the_plugin_gave_it_is_refused(void **state) {
  (void)state;
  enum { POSES = 3, LONGEST = 256 };
  const uint64_t poses = POSES, none = 0;
  char path[512], text[1024];
  snprintf(path, sizeof path, "%s/damaged.bin", test_folder());
  bytes whole = saved(with_an_obstacle, path);
  size_t tried = 0;
  for (size_t at = strlen("hooke checkpoint 8\n"); at + 16 < whole.count; at++) {
    if (memcmp(whole.byte + at, &poses, 8) != 0) continue;
    for (size_t cut = 8 * POSES; cut <= LONGEST * POSES && at + 16 + cut < whole.count; cut += 8 * POSES, tried++) {
      bytes b = whole;
      memcpy(b.byte + at, &none, 8);
      memmove(b.byte + at + 8, b.byte + at + 8 + cut, b.count - at - 8 - cut);
      b.count -= cut;
      sum_again(&b);
      write_bytes(path, &b, b.count);
      if (open_from(with_an_obstacle, path, text, sizeof text) == HK_OK) fail_msg("byte %zu, %zu cut: taken", at, cut);
    }
  }
  assert_true(tried > 0);
}

static void at_other_frames(test_engine *e) {
  moved_by_a_corrector(e);
  e->scene->fps = 20;
}

static void another_version_and_another_scene_are_refused(void **state) {
  (void)state;
  char path[512], text[1024];
  snprintf(path, sizeof path, "%s/damaged.bin", test_folder());
  bytes b = saved(moved_by_a_corrector, path);
  assert_int_equal(open_from(adaptive, path, text, sizeof text), HK_BAD_PARAM);
  assert_non_null(strstr(text, "does not fit this scene: its plugins"));
  assert_int_equal(open_from(at_other_frames, path, text, sizeof text), HK_BAD_PARAM);
  assert_non_null(strstr(text, "does not fit this scene: its frames per second differ"));
  assert_int_equal(open_from(fed_by_a_source, path, text, sizeof text), HK_BAD_PARAM);
  b.byte[strlen("hooke checkpoint ")] = '1';
  write_bytes(path, &b, b.count);
  expect_refused(path, "is a checkpoint of another version of hooke: write it again");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_run_that_goes_on_is_judged_as_a_whole),
      cmocka_unit_test(one_that_is_cut_short_is_refused_at_every_length),
      cmocka_unit_test(one_with_any_byte_changed_is_refused),
      cmocka_unit_test(numbers_in_it_are_not_believed),
      cmocka_unit_test(counts_beyond_any_run_are_refused),
      cmocka_unit_test(a_list_of_another_length_than_the_plugin_gave_it_is_refused),
      cmocka_unit_test(another_version_and_another_scene_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
