/* The widths of the springs kernel give the same bits. */
#include "core/engine/base/base.h"
#include "plugins/kit/springs/spring_kernel.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { CASES = 4, PARTICLES = 700, SPRINGS = HK_SPRING_BLOCK, HUB = 2 * HK_SPRING_SLOTS + 3 };

typedef struct state {
  double x[3 * PARTICLES + 1], v[3 * PARTICLES + 1];
  double k[SPRINGS + HK_SPRING_BUNDLES], c[SPRINGS + HK_SPRING_BUNDLES], L[SPRINGS + HK_SPRING_BUNDLES];
  uint32_t pair[SPRINGS][2];
} state;

typedef struct result {
  double F[3 * PARTICLES], power;
} result;

static void fill(state *s) {
  for (size_t q = 0; q < 3 * PARTICLES; q++) s->x[q] = sin(1.3 * (double)q), s->v[q] = cos(2.1 * (double)q);
  for (size_t e = 0; e < SPRINGS; e++) {
    s->k[e] = 100 + (double)(e % 17), s->c[e] = 0.1 * (double)(e % 5), s->L[e] = 0.3 * (double)(e % 3);
    s->pair[e][0] = (uint32_t)(e * e % 601), s->pair[e][1] = s->pair[e][0] + 1 + (uint32_t)(e % 7);
  }
  for (size_t e = 0; e < HUB; e++) s->pair[e][0] = 5, s->pair[e][1] = 700 - 2; /* more than a slice has slots */
  memcpy(s->x + 3 * 300, s->x + 3 * 299, 3 * sizeof *s->x);                    /* a coincident pair of the near run */
}

/* The first n pairs in slices, with coefficients as they come. */
static hk_spring_list slices(const state *s, size_t n, uint32_t pair[][2], uint8_t *lanes) {
  uint32_t order[2 * SPRINGS];
  const hk_tuples edges = {n, 2, s->pair[0]};
  for (uint32_t e = 0; e < n; e++) order[e] = e;
  hk_spring_slices_sort(&edges, order, n, lanes);
  for (size_t e = 0; e < n; e++) {
    pair[e][0] = hk_spring_owner(s->pair[order[e]]);
    pair[e][1] = s->pair[order[e]][0] ^ s->pair[order[e]][1] ^ pair[e][0];
  }
  return (hk_spring_list){n, (const uint32_t(*)[2])pair, lanes};
}

/* n springs with common coefficients when `each` is 0, or one per spring. */
static void run(int lanes, const state *s, size_t n, size_t each, bool damped, result out[CASES]) {
  double k[HK_SPRING_WIDEST], c[HK_SPRING_WIDEST], L[HK_SPRING_WIDEST] = {0};
  for (size_t r = 0; r < HK_SPRING_WIDEST; r++) k[r] = 70, c[r] = 2;
  hk_spring_numbers q = {each ? s->k : k, each ? s->c : c, each ? s->L : L, each, each, each};
  uint8_t present[SPRINGS / 8]; /* a gap of two places a row of 13 */
  memset(present, 0, sizeof present);
  for (size_t e = 0; e < SPRINGS; e++) present[e / 8] |= (uint8_t)((each == 0 || e % 13 < 11) << e % 8);
  const double *xi = s->x + 3 * 100, *vi = s->v + 3 * 100;
  const size_t apart[CASES - 1] = {300, 1, HK_SPRING_FAR}; /* the nearest of the far ends: they overlap */
  memset(out, 0, CASES * sizeof *out);
  for (int r = 0; r < CASES - 1; r++) {
    size_t j = 3 * apart[r];
    const hk_spring_ways at = {q, present, xi, xi + j, vi, vi + j, out[r].F + 300, out[r].F + 300 + j};
    out[r].power = apart[r] < HK_SPRING_FAR ? HK_WIDEST(lanes, hk_spring_near_run)(&at, n, damped)
                                            : HK_WIDEST(lanes, hk_spring_far_run)(&at, n, damped);
  }
  uint32_t pair[SPRINGS + HK_SPRING_BUNDLES][2] = {{0}};
  uint8_t slots[2 * SPRINGS];
  const hk_spring_list list = slices(s, n, pair, slots);
  const hk_spring_ways all = {.q = q, .xi = s->x, .vi = s->v, .Fi = out[CASES - 1].F};
  out[CASES - 1].power = HK_WIDEST(lanes, hk_spring_list_run)(&all, &list, damped);
}

/* On variants of n springs: 1, coefficients per spring; 2, damped. */
static void compare(int lanes, const state *s, size_t n) {
  result *is = calloc(CASES, sizeof *is), *expected = calloc(CASES, sizeof *expected);
  for (int variant = 0; variant < 4; variant++) {
    run(lanes, s, n, variant & 1 ? ~(size_t)0 : 0, variant & 2, is);
    run(2, s, n, variant & 1 ? ~(size_t)0 : 0, variant & 2, expected);
    for (int r = 0; r < CASES; r++) {
      assert_memory_equal(&is[r], &expected[r], sizeof *is);
      double sum = 0;
      for (size_t q = 0; q < 3 * PARTICLES; q++) sum += fabs(is[r].F[q]);
      assert_true((is[r].power > 0) == (variant >= 2) && isfinite(sum) && sum > 100);
    }
  }
  free(is);
  free(expected);
}

static void widths_give_the_same_bits(void **unused) {
  (void)unused;
  state *s = calloc(1, sizeof *s);
  fill(s);
  for (int lanes = 4; lanes <= hk_processor_lanes(); lanes *= 2)
    for (size_t n = HK_SPRING_LANES; n <= SPRINGS; n += HK_SPRING_LANES) compare(lanes, s, n);
  free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(widths_give_the_same_bits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
