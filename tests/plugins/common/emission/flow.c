/* Birth times and random numbers of sources: births at a constant rate are at k/rate, those of a function of time at
 * the exact roots of its integral, both the same however often and from whichever time they are asked for; draws follow
 * from seed and number alone and have the moments of their distributions. */
#include "plugins/common/emission/draw.h"
#include "plugins/common/emission/flow.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

/* 6 t births a second: 3 t^2 until t, birth k at sqrt(k/3). A line is exact in cells. */
static hk_status rising(const hk_host *host, const hk_function *f, const double *in, size_t n_in, double *out,
                        size_t n_out) {
  (void)host, (void)f, (void)n_in, (void)n_out;
  *out = 6 * *in;
  return HK_OK;
}

static void births_at_a_constant_rate_are_equally_far_apart(void **state) {
  (void)state;
  hk_flow f = {.rate = 7, .from = 0.5, .to = 2};
  double at, count;
  for (int64_t k = 0; k < 10; k++) {
    assert_int_equal(hk_flow_next(&f, NULL, k, 10, &at), HK_OK);
    assert_true(at == 0.5 + (double)k / 7);
  }
  assert_int_equal(hk_flow_next(&f, NULL, 5, 1.2, &at), HK_OK); /* later than that */
  assert_true(at == INFINITY);
  assert_int_equal(hk_flow_next(&f, NULL, 11, 10, &at), HK_OK); /* behind the end */
  assert_true(at == INFINITY);
  assert_int_equal(hk_flow_births(&f, NULL, 0, 10, &count), HK_OK);
  assert_true(count >= 1.5 * 7 && count <= 1.5 * 7 + 2);
}

/* Roundings of some sums of numbers of order 10. */
static void births_of_a_function_are_at_the_roots_of_its_integral(void **state) {
  (void)state;
  const hk_host host = {.call = rising};
  const hk_function *any = (const hk_function *)(const void *)&host; /* is not looked into */
  for (int parts = 1; parts <= 50; parts += 7) {
    hk_flow f = {.of_time = any, .to = NAN, .cell = 0.1};
    int64_t k = 0;
    double at;
    for (int part = 1; part <= parts; part++)
      for (;; k++) {
        assert_int_equal(hk_flow_next(&f, &host, k, 3.05 * part / parts, &at), HK_OK);
        if (at == INFINITY) break;
        assert_true(fabs(at - sqrt((double)k / 3)) < 1e-13);
      }
    assert_int_equal(k, 28); /* 0 to 27: 3 x 3.05^2 = 27.9 */
  }
}

/* 1e5 numbers: the mean of uniform ones is within 4 standard errors, 4 sqrt(1/12/n), and so on. */
static void draws_have_the_moments_of_their_distributions(void **state) {
  (void)state;
  enum { N = 100000 };
  double sum[4] = {0}, n = N;
  for (uint64_t k = 0; k < N; k++) {
    hk_draw d = hk_draw_begin(7, k), again = hk_draw_begin(7, k);
    double u = hk_draw_uniform(&d), z = hk_draw_normal(&d);
    assert_true(u > 0 && u < 1 && u == hk_draw_uniform(&again));
    sum[0] += u, sum[1] += u * u, sum[2] += z, sum[3] += z * z;
  }
  assert_true(fabs(sum[0] / n - 0.5) < 4 * sqrt(1 / 12.0 / n));
  assert_true(fabs(sum[1] / n - 1 / 3.0) < 4 * sqrt(4 / 45.0 / n));
  assert_true(fabs(sum[2] / n) < 4 / sqrt(n));
  assert_true(fabs(sum[3] / n - 1) < 4 * sqrt(2 / n));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(births_at_a_constant_rate_are_equally_far_apart),
      cmocka_unit_test(births_of_a_function_are_at_the_roots_of_its_integral),
      cmocka_unit_test(draws_have_the_moments_of_their_distributions),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
