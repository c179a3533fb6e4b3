/* The widths of the springs kernel give the same bits, those of one spring at a time. */
#include "core/engine/base/base.h"
#include "plugins/kit/springs/spring_kernel.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { CASES = 4, PARTICLES = 700, SPRINGS = HK_SPRING_BLOCK, HUB = 35 };

typedef struct state {
  double x[3 * PARTICLES + 1], v[3 * PARTICLES + 1];
  double k[SPRINGS + HK_SPRING_WIDEST], c[SPRINGS + HK_SPRING_WIDEST], L[SPRINGS + HK_SPRING_WIDEST];
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
  for (size_t e = 0; e < HUB; e++) s->pair[e][0] = 5, s->pair[e][1] = 700 - 2; /* the same ends in all of a vector */
  for (size_t e = HUB; e < HUB + 40; e++) s->pair[e][1 - e % 2] = s->pair[e - 1][e % 2]; /* ends that follow */
  memcpy(s->x + 3 * 300, s->x + 3 * 299, 3 * sizeof *s->x); /* a coincident pair of the near run */
  s->pair[200][0] = 299, s->pair[200][1] = 300;
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
  const hk_spring_ways all = {.q = q, .xi = s->x, .vi = s->v, .Fi = out[CASES - 1].F};
  out[CASES - 1].power = HK_WIDEST(lanes, hk_spring_list_run)(&all, (const uint32_t(*)[2])s->pair, n, damped);
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

/* The springs of a run of n one at a time. Where ends are near, forces on second ends follow those on first ones. */
static void sum_singly(const hk_spring_ways *at, size_t n, bool near, bool damped, double *power) {
  double f[3 * SPRINGS] = {0}, four[4] = {0};
  for (size_t e = 0; e < n; e++) {
    const bool here = at->present[e / 8] >> e % 8 & 1;
    const double *xi = at->xi + 3 * e, *xj = at->xj + 3 * e, *vi = at->vi + 3 * e, *vj = at->vj + 3 * e;
    const double d[3] = {xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]};
    const double w = damped ? d[0] * (vj[0] - vi[0]) + d[1] * (vj[1] - vi[1]) + d[2] * (vj[2] - vi[2]) : 0;
    const double s = hk_spring_scale(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], w, at->q.k[e & at->q.each_k],
                                     at->q.c[e & at->q.each_c], at->q.L[e & at->q.each_L], here ? &four[e % 4] : power);
    for (int r = 0; r < 3; r++) {
      f[3 * e + r] = (here ? s : 0) * d[r];
      at->Fi[3 * e + r] += f[3 * e + r];
      if (!near) at->Fj[3 * e + r] -= f[3 * e + r];
    }
  }
  for (size_t e = 0; e < 3 * n && near; e++) at->Fj[e] -= f[e];
  *power = (four[0] + four[1]) + (four[2] + four[3]);
}

/* Of runs whose second ends are `apart` particles behind the first ones, or before them. */
static void compare_singly(int lanes, const state *s, size_t n, ptrdiff_t apart, bool each, bool damped) {
  const size_t all = each ? ~(size_t)0 : 0, i = 3 * 360;
  result *is = calloc(2, sizeof *is);
  uint8_t present[SPRINGS / 8];
  memset(present, 0xff, sizeof present);
  for (size_t e = 0; e < n && each; e += 13) present[e / 8] &= (uint8_t) ~(1u << e % 8);
  double k[HK_SPRING_WIDEST], c[HK_SPRING_WIDEST], L[HK_SPRING_WIDEST];
  for (size_t r = 0; r < HK_SPRING_WIDEST; r++) k[r] = 70, c[r] = 2, L[r] = 0.4;
  hk_spring_ways at = {.q = {each ? s->k : k, each ? s->c : c, each ? s->L : L, all, all, all},
                       .present = present,
                       .xi = s->x + i,
                       .vi = s->v + i};
  at.xj = at.xi + 3 * apart, at.vj = at.vi + 3 * apart;
  const bool near = apart < HK_SPRING_FAR && -apart < HK_SPRING_FAR;
  for (size_t q = 0; q < 3 * PARTICLES; q++) is[0].F[q] = is[1].F[q] = q % 2 ? -0.0 : 1e-3 * (double)q;
  at.Fi = is[0].F + i, at.Fj = at.Fi + 3 * apart;
  is[0].power =
      near ? HK_WIDEST(lanes, hk_spring_near_run)(&at, n, damped) : HK_WIDEST(lanes, hk_spring_far_run)(&at, n, damped);
  at.Fi = is[1].F + i, at.Fj = at.Fi + 3 * apart;
  sum_singly(&at, n, near, damped, &is[1].power);
  if (memcmp(&is[0], &is[1], sizeof *is)) print_error("%d lanes, %zu springs, ends %td apart\n", lanes, n, apart);
  assert_memory_equal(&is[0], &is[1], sizeof *is);
  free(is);
}

static void runs_have_the_bits_of_one_spring_at_a_time(void **unused) {
  const ptrdiff_t apart[] = {1, 2, 15, 16, 60, -1, -2, -15, -16, -300};
  const size_t n[] = {4, 8, 12, 28, 32, 36, 44, 64, 100, SPRINGS};
  state *s = calloc(1, sizeof *s);
  (void)unused;
  fill(s);
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2)
    for (size_t a = 0; a < sizeof apart / sizeof *apart; a++)
      for (size_t k = 0; k < sizeof n / sizeof *n; k++)
        for (int variant = 0; variant < 4; variant++)
          compare_singly(lanes, s, n[k], apart[a], variant & 1, variant & 2);
  free(s);
}

/* n pairs one at a time, of which some share their ends with those before. */
static void compare_pairs_singly(int lanes, const state *s, size_t n, bool each, bool damped) {
  const size_t all = each ? ~(size_t)0 : 0;
  double k[HK_SPRING_WIDEST], c[HK_SPRING_WIDEST], L[HK_SPRING_WIDEST], four[4] = {0};
  for (size_t r = 0; r < HK_SPRING_WIDEST; r++) k[r] = 70, c[r] = 2, L[r] = 0.4;
  result *is = calloc(2, sizeof *is);
  for (size_t q = 0; q < 3 * PARTICLES; q++) is[0].F[q] = is[1].F[q] = q % 2 ? -0.0 : 1e-3 * (double)q;
  const hk_spring_ways at = {
      .q = {each ? s->k : k, each ? s->c : c, each ? s->L : L, all, all, all}, .xi = s->x, .vi = s->v, .Fi = is[0].F};
  is[0].power = HK_WIDEST(lanes, hk_spring_list_run)(&at, (const uint32_t(*)[2])s->pair, n, damped);
  for (size_t e = 0; e < n; e++) {
    const size_t i = 3 * s->pair[e][0], j = 3 * s->pair[e][1];
    double d[3], w = 0, l2 = 0;
    for (size_t r = 0; r < 3; r++) d[r] = s->x[j + r] - s->x[i + r];
    for (size_t r = 0; r < 3; r++) l2 += d[r] * d[r], w += damped ? d[r] * (s->v[j + r] - s->v[i + r]) : 0;
    const double f = hk_spring_scale(l2, w, at.q.k[e & all], at.q.c[e & all], at.q.L[e & all], &four[e % 4]);
    for (size_t r = 0; r < 3; r++) is[1].F[i + r] += f * d[r], is[1].F[j + r] -= f * d[r];
  }
  is[1].power = (four[0] + four[1]) + (four[2] + four[3]);
  if (memcmp(&is[0], &is[1], sizeof *is)) print_error("%d lanes, %zu pairs\n", lanes, n);
  assert_memory_equal(&is[0], &is[1], sizeof *is);
  free(is);
}

static void lists_have_the_bits_of_one_spring_at_a_time(void **unused) {
  const size_t n[] = {4, 8, 12, 36, 100, SPRINGS};
  state *s = calloc(1, sizeof *s);
  (void)unused;
  fill(s);
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2)
    for (size_t k = 0; k < sizeof n / sizeof *n; k++)
      for (int variant = 0; variant < 4; variant++) compare_pairs_singly(lanes, s, n[k], variant & 1, variant & 2);
  free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(widths_give_the_same_bits),
                                     cmocka_unit_test(runs_have_the_bits_of_one_spring_at_a_time),
                                     cmocka_unit_test(lists_have_the_bits_of_one_spring_at_a_time)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
