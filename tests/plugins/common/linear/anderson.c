/* Anderson's acceleration on linear problems, where theory says when it ends: with a window as long as the number of
 * different contraction factors it finds the solution in one step more than there are factors. */
#include "plugins/common/linear/anderson.h"
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h>

enum { N = 60, FACTORS = 5 };

/* x <- x + A^-1 r, r = b - H x, H and A diagonal; r has the factor H/A in {0.05, 0.2, 0.4, 0.7, 1}. */
static const double part[FACTORS] = {0.05, 0.2, 0.4, 0.7, 1};

static double A(size_t e) { return 1 + 0.1 * (double)(e % 7); }

static double solution(size_t e) { return sin((double)e); }

static double error_after(int steps, size_t window) {
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  hk_anderson a = {0};
  double x[N] = {0}, r[N], dx[N], g[N], off = 0;
  assert_int_equal(hk_anderson_reserve(&a, &f->host, N, window), HK_OK);
  for (int k = 0; k < steps; k++) {
    for (size_t e = 0; e < N; e++) {
      r[e] = part[e % FACTORS] * A(e) * (solution(e) - x[e]);
      dx[e] = r[e] / A(e);
      g[e] = x[e] + dx[e];
    }
    hk_anderson_next(&a, dx, g, r, x);
  }
  for (size_t e = 0; e < N; e++) off = fmax(off, fabs(x[e] - solution(e)));
  hk_anderson_release(&a, &f->host);
  fake_system_destroy(f);
  return off;
}

/* 1e-6: the root of the regularization, 1e-12 of |dF|^2. */
static void linear_problems_end_after_as_many_steps_as_factors(void **state) {
  (void)state;
  double before = error_after(FACTORS - 1, FACTORS), after = error_after(FACTORS + 1, FACTORS);
  print_message("error %.1e after %d steps, %.1e after %d\n", before, FACTORS - 1, after, FACTORS + 1);
  assert_true(before > 1e-3);
  assert_true(after < 1e-6);
}

/* Without acceleration the slowest factor leaves 0.95^30 = 0.2 of the error; a window of 2 must do ten times better. */
static void short_windows_help_too(void **state) {
  (void)state;
  double plain = error_after(30, 0), off = error_after(30, 2);
  print_message("30 steps leave %.1e, with a window of 2 %.1e\n", plain, off);
  assert_true(fabs(plain / pow(0.95, 30) - 1) < 0.01); /* the largest |sin| of the slow ones is 0.999 */
  assert_true(off < plain / 10);
}

/* At the solution f is 0 in every step: nothing may divide by its length. */
static void a_solution_stays(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  hk_anderson a = {0};
  double x[N], zero[N] = {0}, g[N];
  assert_int_equal(hk_anderson_reserve(&a, &f->host, N, 3), HK_OK);
  for (size_t e = 0; e < N; e++) x[e] = solution(e);
  for (int k = 0; k < 6; k++) {
    memcpy(g, x, sizeof g);
    hk_anderson_next(&a, zero, g, zero, x);
    assert_memory_equal(x, g, sizeof g);
  }
  hk_anderson_release(&a, &f->host);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_problems_end_after_as_many_steps_as_factors),
      cmocka_unit_test(short_windows_help_too),
      cmocka_unit_test(a_solution_stays),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
