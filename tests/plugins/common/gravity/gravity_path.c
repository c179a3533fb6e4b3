/* Every path of the gravity kernel that this processor has, against sums in long double. */
#include "core/engine/base/base.h"
#include "plugins/common/gravity/gravity_path.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { BODIES = 1003, BLOCK = HK_GRAVITY_BLOCK };

/* A sum of n terms in turn is off by n eps/2 of the sum of their sizes at most, and by its root in the mean: 1e-15 for
 * a thousand. Each term has about 6 roundings. */
static const double rounding = 4e-15;

typedef struct sources {
  double number[4 * BODIES];
  hk_bodies at;
  double cell[BODIES][HK_CELL_NUMBERS];
  uint32_t which[BODIES]; /* all, in turn */
  hk_targets targets;
} sources;

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53;
}

/* The first targets are the first sources. Cells are at least 1 away. */
static sources *fill(void) {
  sources *s = calloc(1, sizeof *s);
  uint64_t seed = 5;
  for (size_t k = 0; k < 4 * BODIES; k++) s->number[k] = noise(&seed);
  s->at = (hk_bodies){s->number, s->number + BODIES, s->number + 2 * BODIES, s->number + 3 * BODIES};
  for (size_t l = 0; l < BLOCK; l++) {
    s->targets.x[0][l] = s->at.x[l];
    s->targets.x[1][l] = s->at.y[l];
    s->targets.x[2][l] = s->at.z[l];
  }
  for (uint32_t k = 0; k < BODIES; k++) s->which[k] = k;
  for (size_t k = 0; k < BODIES; k++)
    for (size_t c = 0; c < HK_CELL_NUMBERS; c++) s->cell[k][c] = (c < 3 ? 2 : 0) + noise(&seed);
  return s;
}

static size_t paths(const hk_gravity_path *list[3]) {
  size_t count = 0;
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) list[count++] = hk_gravity_path_of(lanes);
  return count;
}

static void near(const char *name, double got, long double wanted, long double size) {
  if (!(fabsl(got - wanted) <= rounding * size))
    fail_msg("%s: %.17g instead of %.17Lg, %.2Lg of the terms", name, got, wanted, fabsl(got - wanted) / size);
}

/* d from a target to a place, and its square. */
static long double apart(const sources *s, size_t l, double x, double y, double z, long double d[3]) {
  const double at[3] = {x, y, z};
  long double r2 = 0;
  for (size_t c = 0; c < 3; c++) d[c] = (long double)at[c] - s->targets.x[c][l], r2 += d[c] * d[c];
  return r2;
}

static void check_pull(const hk_gravity_path *path, const sources *s, double eps2, size_t begin, size_t end) {
  hk_pull got = {0};
  path->pull(&s->at, begin, end, &s->targets, eps2, &got);
  for (size_t l = 0; l < BLOCK; l++) {
    long double a[3] = {0}, size = 0, d[3];
    for (size_t j = begin; j < end; j++) {
      long double s2 = apart(s, l, s->at.x[j], s->at.y[j], s->at.z[j], d) + eps2;
      if (!(s2 > 0)) continue;
      for (size_t c = 0; c < 3; c++) a[c] += s->at.m[j] * d[c] / (s2 * sqrtl(s2));
      size += s->at.m[j] / s2;
    }
    for (size_t c = 0; c < 3; c++) near(path->name, got.a[c][l], a[c], size);
    assert_int_equal(got.zeros[l], eps2 == 0 && l >= begin && l < end);
  }
}

static void check_scalar(const hk_gravity_path *path, const sources *s, double eps2, int power) {
  double got[BLOCK] = {0};
  path->scalar(&s->at, 0, BODIES, &s->targets, eps2, power, got);
  for (size_t l = 0; l < BLOCK; l++) {
    long double sum = 0, d[3];
    for (size_t j = 0; j < BODIES; j++) {
      long double s2 = apart(s, l, s->at.x[j], s->at.y[j], s->at.z[j], d) + eps2;
      if (s2 > 0) sum += s->at.m[j] / powl(s2, power / 2.0L);
    }
    near(path->name, got[l], sum, sum);
  }
}

static void sums_over_bodies_are_right_to_rounding(void **state) {
  (void)state;
  const hk_gravity_path *list[3];
  sources *s = fill();
  for (size_t p = paths(list); p-- > 0;)
    for (int soft = 0; soft < 2; soft++) {
      check_pull(list[p], s, soft ? 1e-4 : 0, 0, BODIES);
      check_pull(list[p], s, soft ? 1e-4 : 0, 5, 12);
      check_pull(list[p], s, soft ? 1e-4 : 0, 7, 7);
      check_scalar(list[p], s, soft ? 1e-4 : 0, 1);
      check_scalar(list[p], s, soft ? 1e-4 : 0, 3);
    }
  free(s);
}

/* M/s + d.Sd/(2 s^5) - trace/(3 s^3) and its gradient, written out. */
static void cells_have_their_quadrupole(void **state) {
  (void)state;
  const hk_gravity_path *list[3];
  sources *s = fill();
  const double eps2 = 0.01;
  for (size_t p = paths(list); p-- > 0;) {
    hk_pull got = {0};
    double potential[BLOCK] = {0};
    list[p]->pull_of_cells((const double(*)[HK_CELL_NUMBERS])s->cell, s->which, BODIES, &s->targets, eps2, &got);
    list[p]->potential_of_cells((const double(*)[HK_CELL_NUMBERS])s->cell, s->which, BODIES, &s->targets, eps2,
                                potential);
    for (size_t l = 0; l < BLOCK; l++) {
      long double a[3] = {0}, size = 0, sum = 0, d[3];
      for (size_t k = 0; k < BODIES; k++) {
        const double *c = s->cell[k], *S = c + HK_CELL_S;
        long double s2 = apart(s, l, c[0], c[1], c[2], d) + eps2, w = 1 / sqrtl(s2), w5 = w * w * w * w * w;
        long double Sd[3] = {S[0] * d[0] + S[1] * d[1] + S[2] * d[2], S[1] * d[0] + S[3] * d[1] + S[4] * d[2],
                             S[2] * d[0] + S[4] * d[1] + S[5] * d[2]};
        long double dSd = d[0] * Sd[0] + d[1] * Sd[1] + d[2] * Sd[2];
        for (size_t q = 0; q < 3; q++)
          a[q] += (c[HK_CELL_M] * w * w * w + 2.5L * dSd * w5 * w * w - c[HK_CELL_TRACE] * w5) * d[q] - Sd[q] * w5;
        sum += c[HK_CELL_M] * w + dSd * w5 / 2 - c[HK_CELL_TRACE] * w * w * w / 3;
        size += c[HK_CELL_M] * w * w + (fabsl(dSd) + fabsl(c[HK_CELL_TRACE])) * w5 / w;
      }
      for (size_t q = 0; q < 3; q++) near(list[p]->name, got.a[q][l], a[q], size);
      near(list[p]->name, potential[l], sum, size);
    }
  }
  free(s);
}

/* The cell of the first 50 sources. */
static void collect(const sources *s, double c[HK_CELL_NUMBERS]) {
  for (size_t j = 0; j < 50; j++) {
    const double r[3] = {s->at.x[j], s->at.y[j], s->at.z[j]};
    c[HK_CELL_M] += s->at.m[j];
    for (size_t q = 0; q < 3; q++) c[q] += s->at.m[j] * r[q];
  }
  for (size_t q = 0; q < 3; q++) c[q] /= c[HK_CELL_M];
  for (size_t j = 0; j < 50; j++) {
    const double r[3] = {s->at.x[j] - c[0], s->at.y[j] - c[1], s->at.z[j] - c[2]};
    size_t at = HK_CELL_S;
    for (size_t a = 0; a < 3; a++)
      for (size_t b = a; b < 3; b++) c[at++] += 3 * s->at.m[j] * r[a] * r[b];
    c[HK_CELL_TRACE] += 1.5 * s->at.m[j] * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  }
}

/* Seen from twice as far, their potential is off by (1/2)^3, the next order, relative to its size. */
static void cells_stand_for_their_bodies(void **state) {
  (void)state;
  const double eps2 = 4;
  sources *s = fill();
  double off[2] = {0}, c[1][HK_CELL_NUMBERS] = {{0}};
  collect(s, c[0]);
  for (int far = 0; far < 2; far++) {
    double exact[BLOCK] = {0}, sum[BLOCK] = {0};
    hk_targets t;
    for (size_t l = 0; l < BLOCK; l++)
      for (size_t q = 0; q < 3; q++) t.x[q][l] = c[0][q] + (far ? 20 : 10) * sin((double)(3 * l + q));
    hk_gravity_path_of(hk_processor_lanes())
        ->potential_of_cells((const double(*)[HK_CELL_NUMBERS])c, s->which, 1, &t, eps2, sum);
    hk_gravity_path_of(hk_processor_lanes())->scalar(&s->at, 0, 50, &t, eps2, 1, exact);
    for (size_t l = 0; l < BLOCK; l++) off[far] = fmax(off[far], fabs(sum[l] - exact[l]) / exact[l]);
  }
  assert_true(off[0] < 7e-4); /* (0.87/10)^3, with half the diagonal of a cube of 1 */
  assert_true(off[0] / off[1] > 6.5 && off[0] / off[1] < 11);
  free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_over_bodies_are_right_to_rounding),
      cmocka_unit_test(cells_have_their_quadrupole),
      cmocka_unit_test(cells_stand_for_their_bodies),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
