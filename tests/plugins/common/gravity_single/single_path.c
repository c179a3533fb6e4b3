/* Every path of the gravity kernel in floats that this processor has, against sums in long double. */
#include "plugins/common/gravity_single/single_path.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { BODIES = 1003, BLOCK = HK_SINGLE_BLOCK };

/* 2^-24 for each of a dozen roundings of a term that all go one way; sums of 64 terms add as much in the mean. */
static const double rounding = 7e-7;

typedef struct sources {
  hk_single_body body[BODIES];
  double x[BODIES + BLOCK][3];
  hk_single_targets targets;
} sources;

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53;
}

/* The first target is 1e-6 from a source: the high parts alone would lose the digits. */
static sources *fill(void) {
  sources *s = calloc(1, sizeof *s);
  uint64_t seed = 5;
  for (size_t k = 0; k < BODIES + BLOCK; k++)
    for (size_t c = 0; c < 3; c++) s->x[k][c] = noise(&seed);
  for (size_t c = 0; c < 3; c++) s->x[BODIES][c] = s->x[7][c] + 1e-6;
  for (size_t k = 0; k < BODIES; k++) s->body[k].m = (float)noise(&seed);
  for (size_t c = 0; c < 3; c++) {
    for (size_t k = 0; k < BODIES; k++) s->body[k].high[c] = (float)s->x[k][c];
    for (size_t k = 0; k < BODIES; k++) s->body[k].low[c] = (float)(s->x[k][c] - (double)s->body[k].high[c]);
    for (size_t l = 0; l < BLOCK; l++) s->targets.high[c][l] = (float)s->x[BODIES + l][c];
    for (size_t l = 0; l < BLOCK; l++)
      s->targets.low[c][l] = (float)(s->x[BODIES + l][c] - (double)s->targets.high[c][l]);
  }
  return s;
}

static void check_pull(const hk_single_path *path, const sources *s, double eps2, size_t begin, size_t end) {
  hk_single_pull got = {0};
  for (size_t l = 0; l < BLOCK; l++) got.nearest[l] = INFINITY;
  path->pull(s->body, begin, end, &s->targets, (float)eps2, &got);
  for (size_t l = 0; l < BLOCK; l++) {
    double a[3] = {0}, size = 0, least = INFINITY;
    for (size_t j = begin; j < end; j++) {
      double d[3], s2 = (double)(float)eps2;
      for (size_t c = 0; c < 3; c++) d[c] = s->x[j][c] - s->x[BODIES + l][c], s2 += d[c] * d[c];
      for (size_t c = 0; c < 3; c++) a[c] += (double)s->body[j].m * d[c] / (s2 * sqrt(s2));
      size += (double)s->body[j].m / s2;
      least = fmin(least, s2);
    }
    for (size_t c = 0; c < 3; c++)
      if (!(fabs(got.a[c][l] - a[c]) <= rounding * size))
        fail_msg("%s, target %zu of %zu to %zu: %.9g instead of %.9g, %.2g of the terms", path->name, l, begin, end,
                 got.a[c][l], a[c], fabs(got.a[c][l] - a[c]) / size);
    assert_true((double)got.nearest[l] == least || fabs((double)got.nearest[l] / least - 1) < 4e-7);
  }
}

static void sums_are_right_to_the_rounding_of_floats(void **state) {
  (void)state;
  const hk_single_path *paths[] = {&hk_single_narrow, hk_single_wide8(), hk_single_wide16()};
  sources *s = fill();
  for (size_t p = 0; p < 3; p++)
    for (int soft = 0; soft < 2 && paths[p]; soft++) {
      check_pull(paths[p], s, soft ? 1e-4 : 0, 0, BODIES);
      check_pull(paths[p], s, soft ? 1e-4 : 0, 5, 12);
      check_pull(paths[p], s, soft ? 1e-4 : 0, 7, 7);
    }
  free(s);
}

/* It is for the caller to see, whatever the estimate makes of 0. */
static void a_source_at_the_place_of_a_target_is_seen(void **state) {
  (void)state;
  const hk_single_path *paths[] = {&hk_single_narrow, hk_single_wide8(), hk_single_wide16()};
  sources *s = fill();
  for (size_t c = 0; c < 3; c++) s->body[7].high[c] = s->targets.high[c][9], s->body[7].low[c] = s->targets.low[c][9];
  for (size_t p = 0; p < 3; p++) {
    hk_single_pull got = {0};
    if (!paths[p]) continue;
    for (size_t l = 0; l < BLOCK; l++) got.nearest[l] = INFINITY;
    paths[p]->pull(s->body, 0, 100, &s->targets, 0, &got);
    for (size_t l = 0; l < BLOCK; l++) assert_true((got.nearest[l] == 0) == (l == 9));
  }
  free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_are_right_to_the_rounding_of_floats),
      cmocka_unit_test(a_source_at_the_place_of_a_target_is_seen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
