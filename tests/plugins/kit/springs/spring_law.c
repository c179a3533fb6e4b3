/* HK_SPRING_TENSION: springs with a law of their own, in runs, lists and singly, by every width. */
#define HK_SPRING_TENSION(k, L, l) ((k) * ((l) - (L)) * (1 + ((l) - (L)) * ((l) - (L)) * 25.))
#include "core/engine/base/base.h"
#include "plugins/kit/springs/spring_kernel.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 40, SPRINGS = 16, APART = 20 };

typedef struct state {
  double x[3 * N + 1], v[3 * N + 1], F[3 * N], expected[3 * N];
  double k[SPRINGS + HK_SPRING_WIDEST], c[SPRINGS + HK_SPRING_WIDEST], L[SPRINGS + HK_SPRING_WIDEST];
  uint32_t pair[SPRINGS][2];
} state;

static state *begin(size_t apart) {
  state *s = calloc(1, sizeof *s);
  for (size_t q = 0; q < 3 * N; q++) s->x[q] = sin(1.3 * (double)q), s->v[q] = cos(2.1 * (double)q);
  for (size_t e = 0; e < SPRINGS; e++) {
    s->k[e] = 100 + (double)e, s->c[e] = 0.1 * (double)(e % 5), s->L[e] = 0.3 * (double)(1 + e % 3);
    s->pair[e][0] = (uint32_t)e, s->pair[e][1] = (uint32_t)(e + apart);
  }
  return s;
}

/* T(l) d/l + c (u.d) d/l^2 on the first end, by the formula as it is written. */
static void expect(state *s) {
  for (size_t e = 0; e < SPRINGS; e++) {
    const size_t i = 3 * s->pair[e][0], j = 3 * s->pair[e][1];
    double d[3], l2 = 0, w = 0;
    for (size_t r = 0; r < 3; r++) {
      d[r] = s->x[j + r] - s->x[i + r];
      l2 += d[r] * d[r], w += d[r] * (s->v[j + r] - s->v[i + r]);
    }
    const double l = sqrt(l2), longer = l - s->L[e], T = s->k[e] * longer * (1 + 25 * longer * longer);
    for (size_t r = 0; r < 3; r++) {
      const double f = T * d[r] / l + s->c[e] * w * d[r] / l2;
      s->expected[i + r] += f, s->expected[j + r] -= f;
    }
  }
}

/* Forces are up to some 1e5 N, their sums of a dozen roundings each. */
static void compare(state *s, int lanes, const char *what) {
  for (size_t q = 0; q < 3 * N; q++)
    if (!(fabs(s->F[q] - s->expected[q]) <= 1e-9))
      fail_msg("%s, %d lanes: F[%zu] is %.17g, not %.17g", what, lanes, q, s->F[q], s->expected[q]);
  free(s);
}

static void runs_and_lists_have_the_law(void **unused) {
  const size_t all = ~(size_t)0, distance[] = {1, APART};
  const uint8_t present[SPRINGS / 8] = {0xff, 0xff};
  (void)unused;
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2)
    for (size_t a = 0; a < 2; a++)
      for (int list = 0; list < 2; list++) {
        const size_t apart = distance[a], j = 3 * apart;
        state *s = begin(apart);
        const hk_spring_ways at = {
            {s->k, s->c, s->L, all, all, all}, present, s->x, s->x + j, s->v, s->v + j, s->F, s->F + j};
        expect(s);
        if (list)
          HK_WIDEST(lanes, hk_spring_list_run)(&at, (const uint32_t(*)[2])s->pair, SPRINGS, true);
        else if (apart < HK_SPRING_FAR)
          HK_WIDEST(lanes, hk_spring_near_run)(&at, SPRINGS, true);
        else
          HK_WIDEST(lanes, hk_spring_far_run)(&at, SPRINGS, true);
        compare(s, lanes, list ? "list" : "run");
      }
}

static void one_spring_at_a_time_has_the_law(void **unused) {
  double power = 0;
  (void)unused;
  assert_true(fabs(hk_spring_scale(4, 0, 10, 1.5, 1.5, &power) - 10 * 0.5 * (1 + 25 * 0.25) / 2) < 1e-14);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(runs_and_lists_have_the_law),
                                     cmocka_unit_test(one_spring_at_a_time_has_the_law)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
