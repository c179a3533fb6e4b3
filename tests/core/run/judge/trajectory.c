/* Trajectories of runs, which are compared: distances that are known, moments that both have, channels in their own
 * unit, other particles, and memory that stays bounded. */
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 2, WIDTH = 1 };

/* Two particles with one channel, at (x, 0, 0) and (0, x, 0), y = x. */
typedef struct subject {
  hk_state state;
  double X[(6 + WIDTH) * N + 1];
  uint32_t id[N];
} subject;

static void place(subject *s, double t, double x) {
  memset(s, 0, sizeof *s);
  s->state.t = t;
  s->state.model.n = N;
  s->state.width = WIDTH;
  s->state.X = s->X;
  s->state.id = s->id;
  s->id[0] = 1, s->id[1] = 5;
  s->X[0] = s->X[4] = x;
  s->X[6 * N] = s->X[6 * N + 1] = x;
}

/* The channel of the subjects; errors of it do not count. */
static char channel_name[] = "y";
static hk_channel_spec channel_of = {.name = channel_name, .size = WIDTH};
static const hk_scene one_channel = {.particles = {.channels = 1, .channel = &channel_of}};
static const double no_accuracy[] = {INFINITY};

static void note(hk_trajectory *a, size_t frame, double x, bool always) {
  subject s;
  hk_error error = {0};
  place(&s, (double)frame / 60, x);
  assert_int_equal(hk_trajectory_note(a, &s.state, frame, always, &error), HK_OK);
}

static void distances_are_those_of_the_worst_moment(void **state) {
  (void)state;
  hk_trajectory a = {0}, b = {0};
  char name[] = "y";
  hk_channel_spec channel = {.name = name, .size = 1};
  hk_scene scene = {.particles = {.channels = 1, .channel = &channel}};
  const double accuracy[] = {0.5};
  for (size_t k = 0; k <= 60; k++) note(&a, k, (double)k, false);
  for (size_t k = 0; k <= 60; k += 2) note(&b, k, (double)k + (k == 30 ? 3 : 1), false);
  hk_distance d = hk_trajectory_distance(&a, &b, &scene, accuracy, 0, INFINITY);
  assert_true(d.position == 3 && d.t == 0.5 && d.channel == 6 && strcmp(d.channel_name, "y") == 0);
  d = hk_trajectory_distance(&a, &b, &scene, accuracy, 1, INFINITY);
  assert_true(d.position == 1 && d.channel == 2);
  d = hk_trajectory_distance(&a, &b, &scene, accuracy, 0.01, 0.02); /* frame 1, which b does not have */
  assert_true(isnan(d.position));
  assert_true(hk_trajectory_motion(&a) == 60 && hk_trajectory_channel_change(&a, &scene, 0) == 60);
  assert_true(fabs(hk_trajectory_time(&a, 0.5) - 31.0 / 60) < 1e-15);
  hk_trajectory_free(&a);
  hk_trajectory_free(&b);
}

static void what_is_not_finite_is_infinitely_far(void **state) {
  (void)state;
  hk_trajectory a = {0}, b = {0};
  note(&a, 0, NAN, false);
  note(&b, 0, 1, false);
  assert_true(isinf(hk_trajectory_distance(&a, &b, &one_channel, no_accuracy, 0, INFINITY).position));
  hk_trajectory_free(&a);
  hk_trajectory_free(&b);
}

static void other_particles_are_not_compared(void **state) {
  (void)state;
  hk_trajectory a = {0}, b = {0};
  hk_error error = {0};
  subject s;
  note(&a, 0, 1, false);
  place(&s, 0, 1);
  s.id[1] = 6;
  assert_int_equal(hk_trajectory_note(&b, &s.state, 0, false, &error), HK_OK);
  assert_true(isnan(hk_trajectory_distance(&a, &b, &one_channel, no_accuracy, 0, INFINITY).position));
  hk_trajectory_free(&a);
  hk_trajectory_free(&b);
}

/* 2^24 numbers are kept at most: of 2 particles with 10 numbers a frame, 1.7 million frames; the end always is. */
static void the_memory_is_bounded(void **state) {
  (void)state;
  hk_trajectory a = {0};
  size_t last = 3400001;
  for (size_t k = 0; k < last; k++) note(&a, k, 0, false);
  note(&a, last, 1, true);
  assert_true(a.size <= ((size_t)1 << 24) && a.stride == 4);
  assert_true(hk_trajectory_motion(&a) == 1);
  assert_true(hk_trajectory_distance(&a, &a, &one_channel, no_accuracy, 0, INFINITY).position == 0);
  hk_trajectory_free(&a);
}

/* Moments as a checkpoint has them; those of a stranger are not read outside of their numbers. */
typedef struct source {
  const unsigned char *at;
  size_t left;
} source;

static bool get(void *from, void *data, size_t bytes) {
  source *s = from;
  if (bytes > s->left) return false;
  if (!data || !bytes) return true;
  memcpy(data, s->at, bytes);
  s->at += bytes, s->left -= bytes;
  return true;
}

enum { FRAMES = 3, NUMBERS = FRAMES * (4 + WIDTH) * N, MOMENT = 5 * 8 };

static bool restores(const unsigned char *byte, size_t stride, size_t moments, size_t numbers, size_t width) {
  hk_trajectory read = {0}, stated = {.moments = moments, .size = numbers, .width = width, .stride = stride};
  source from = {byte, FRAMES * MOMENT + NUMBERS * sizeof(double)};
  bool fine = hk_trajectory_restore(&read, true, &stated, 6, &from, get);
  if (fine) assert_true(hk_trajectory_motion(&read) >= 0);
  hk_trajectory_free(&read);
  return fine;
}

static void forged_moments_are_refused(void **state) {
  (void)state;
  static unsigned char byte[FRAMES * MOMENT + NUMBERS * sizeof(double)], copy[sizeof byte];
  hk_trajectory a = {0};
  for (size_t k = 0; k < FRAMES; k++) note(&a, k, (double)k, true);
  assert_int_equal(hk_trajectory_bytes(&a), FRAMES * MOMENT);
  memcpy(byte, a.moment, FRAMES * MOMENT);
  memcpy(byte + FRAMES * MOMENT, a.value, NUMBERS * sizeof(double));
  hk_trajectory_free(&a);
  assert_true(restores(byte, 1, FRAMES, NUMBERS, 4 + WIDTH));
  assert_false(restores(byte, 0, FRAMES, NUMBERS, 4 + WIDTH));
  assert_false(restores(byte, 1, FRAMES + 1, NUMBERS, 4 + WIDTH));
  assert_false(restores(byte, 1, FRAMES, NUMBERS - 1, 4 + WIDTH));
  assert_false(restores(byte, 1, FRAMES, NUMBERS, 4)); /* of a scene without the channel */
  for (size_t k = 0; k < FRAMES; k++)                  /* each word of a moment but the frame's number */
    for (size_t word = 0; word < 5; word++) {
      memcpy(copy, byte, sizeof byte);
      memset(copy + k * MOMENT + word * 8, word == 0 ? 0xff : 0x7f, 8); /* t: NaN; others: huge */
      if (word != 1) assert_false(restores(copy, 1, FRAMES, NUMBERS, 4 + WIDTH));
    }
  static const double ids[] = {0, -1, 6, 1e300, 1.5, NAN, 5};
  for (size_t k = 0; k < sizeof ids / sizeof *ids; k++) { /* the first particle's, before 5 */
    memcpy(copy, byte, sizeof byte);
    memcpy(copy + FRAMES * MOMENT, &ids[k], sizeof *ids);
    assert_false(restores(copy, 1, FRAMES, NUMBERS, 4 + WIDTH));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distances_are_those_of_the_worst_moment),
      cmocka_unit_test(what_is_not_finite_is_infinitely_far),
      cmocka_unit_test(other_particles_are_not_compared),
      cmocka_unit_test(the_memory_is_bounded),
      cmocka_unit_test(forged_moments_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
