/* The paths of the springs kernel give the same bits. */
#include "plugins/common/springs/spring_path.h"

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
static void run(const hk_spring_path *path, const state *s, size_t n, size_t each, bool damped, result out[CASES]) {
  double k[HK_SPRING_WIDEST], c[HK_SPRING_WIDEST], L[HK_SPRING_WIDEST] = {0};
  for (size_t r = 0; r < HK_SPRING_WIDEST; r++) k[r] = 70, c[r] = 2;
  hk_spring_numbers q = {each ? s->k : k, each ? s->c : c, each ? s->L : L, each, each, each};
  const double *xi = s->x + 3 * 100, *vi = s->v + 3 * 100;
  memset(out, 0, CASES * sizeof *out);
  out[0].power = path->far_run(&q, n, xi, xi + 3 * 300, vi, vi + 3 * 300, out[0].F + 300, out[0].F + 1200, damped);
  out[1].power = path->near_run(&q, n, xi, xi + 3, vi, vi + 3, out[1].F + 300, out[1].F + 303, damped);
  size_t near = HK_SPRING_FAR; /* the nearest of the far ends: they overlap */
  out[3].power =
      path->far_run(&q, n, xi, xi + 3 * near, vi, vi + 3 * near, out[3].F + 300, out[3].F + 300 + 3 * near, damped);
  uint32_t pair[SPRINGS + HK_SPRING_BUNDLES][2] = {{0}};
  uint8_t lanes[2 * SPRINGS];
  const hk_spring_list list = slices(s, n, pair, lanes);
  out[2].power = path->list(&q, &list, s->x, s->v, out[2].F, damped);
}

/* On variants of n springs: 1, coefficients per spring; 2, damped. */
static void compare(const hk_spring_path *path, const state *s, size_t n) {
  result *is = calloc(CASES, sizeof *is), *expected = calloc(CASES, sizeof *expected);
  for (int variant = 0; variant < 4; variant++) {
    run(path, s, n, variant & 1 ? ~(size_t)0 : 0, variant & 2, is);
    run(&hk_spring_narrow, s, n, variant & 1 ? ~(size_t)0 : 0, variant & 2, expected);
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

static void paths_give_the_same_bits(void **unused) {
  (void)unused;
  const hk_spring_path *path[] = {hk_spring_wide(), hk_spring_wide8()}; /* NULL where this processor has none */
  state *s = calloc(1, sizeof *s);
  fill(s);
  for (size_t p = 0; p < sizeof path / sizeof *path; p++)
    for (size_t n = HK_SPRING_LANES; path[p] && n <= SPRINGS; n += HK_SPRING_LANES) compare(path[p], s, n);
  free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(paths_give_the_same_bits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
