/* Sums of a number times a vector for each particle: the same bits as the plain loop, for every width of vectors that
 * this processor has, for any range, for lists, with vectors of their own and a common one. */
#include "core/engine/base/base.h"
#include "plugins/kit/parts/scaled_sums.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

enum { N = 53 };

typedef struct scene {
  double by[N], u[3 * N], F[3 * N];
  hk_scaled own, common;
} scene;

static const hk_host host = {.lanes = 2}; /* what every processor has; the others below */

static scene made(void) {
  scene s = {.own = {.each = 0.3, .times = -1.7}, .common = {.times = 2.1, .common = {0.1, -0.7, 1.3}}};
  for (int i = 0; i < N; i++) s.by[i] = 1 + sin(3.7 * i);
  for (int e = 0; e < 3 * N; e++) s.u[e] = cos(1.9 * e), s.F[e] = sin(0.3 * e);
  return s;
}

static void place(scene *s) {
  s->own.by = s->common.by = s->by;
  s->own.u = s->u;
}

/* One particle after the other. */
static double plain(const hk_scaled *s, size_t i, double *F) {
  double power = 0;
  for (size_t c = 0; c < 3; c++) {
    double u = s->u ? s->u[3 * i + c] : s->common[c], f = (s->each + s->times * s->by[i]) * u;
    F[3 * i + c] += f;
    if (s->u) power += f * u;
  }
  return power;
}

/* Roundings of 3 N products of at most 4. */
static const double near_enough = 3 * N * 4 * 2.3e-16;

static void try_range(const hk_scaled *of, scene *s, const hk_view *view, size_t begin, size_t end) {
  double wanted[3 * N], power = 0;
  memcpy(wanted, s->F, sizeof wanted);
  for (size_t k = begin; k < end; k++) power += plain(of, hk_acting_particle(view, k), wanted);
  double found = hk_scaled_sums_add(of, view, begin, end, s->F);
  assert_memory_equal(s->F, wanted, sizeof wanted);
  assert_true(fabs(found - power) <= near_enough);
}

static void every_range_is_that_of_the_plain_loop(void **state) {
  (void)state;
  scene s = made();
  place(&s);
  const hk_view view = {.n = N, .host = &host, .acting = N};
  for (size_t begin = 0; begin <= N; begin += 5)
    for (size_t end = begin; end <= N; end++) {
      try_range(&s.own, &s, &view, begin, end);
      try_range(&s.common, &s, &view, begin, end);
    }
}

static void lists_are_those_of_the_plain_loop(void **state) {
  (void)state;
  scene s = made();
  place(&s);
  const uint32_t some[] = {1, 2, 3, 7, 11, 12, 13, 14, 15, 16, 17, 40, 51};
  const hk_view view = {.n = N, .host = &host, .acting = sizeof some / sizeof *some, .active = some};
  try_range(&s.own, &s, &view, 0, view.acting);
  try_range(&s.common, &s, &view, 2, 11);
}

typedef double adding(const hk_scaled *, const double *pattern, size_t begin, size_t end, double *F);

static void same_bits(const hk_scaled *of, scene s, adding *add) {
  double pattern[3 * HK_SCALED_EIGHT], two[3 * N];
  for (size_t l = 0; l < 3 * HK_SCALED_EIGHT; l++) pattern[l] = of->common[l % 3];
  memcpy(two, s.F, sizeof two);
  assert_true(add(of, pattern, 3, 3 + 5 * HK_SCALED_EIGHT, s.F) ==
              hk_scaled_eights_2(of, pattern, 3, 3 + 5 * HK_SCALED_EIGHT, two));
  assert_memory_equal(s.F, two, sizeof two);
}

static void all_widths_give_the_same_bits(void **state) {
  (void)state;
  scene s = made();
  place(&s);
  if (hk_processor_lanes() == 2) skip();
  for (int lanes = 4; lanes <= hk_processor_lanes(); lanes *= 2)
    same_bits(&s.own, s, HK_WIDEST(lanes, hk_scaled_eights)),
        same_bits(&s.common, s, HK_WIDEST(lanes, hk_scaled_eights));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_range_is_that_of_the_plain_loop),
                                     cmocka_unit_test(lists_are_those_of_the_plain_loop),
                                     cmocka_unit_test(all_widths_give_the_same_bits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
