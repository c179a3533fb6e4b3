/* The loop of conjugate gradients: it ends in as many iterations as the matrix has eigenvalues, at the size of the
 * residual that is asked for, and not at numbers that are not finite. */
#include "plugins/common/gradients/gradients_loop.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { N = 5000 };

static double vector[5][N], diagonal[N];

static double product(void *context, const double *p, double *q) {
  double sum = 0;
  (void)context;
  for (size_t k = 0; k < N; k++) sum += p[k] * (q[k] = diagonal[k] * p[k]);
  return sum;
}

static double precondition(void *context, const double *r, double *z) {
  double sum = 0;
  (void)context;
  for (size_t k = 0; k < N; k++) sum += r[k] * (z[k] = r[k]);
  return sum;
}

/* b = 1 and a diagonal of 1, 2 and 3. */
static hk_gradients_loop begin(test_solver *s, hk_residual part[2]) {
  hk_gradients_loop loop = {.host = &s->solver->host, .unknowns = N, .part = part};
  loop.x = vector[0], loop.r = vector[1], loop.z = vector[2], loop.p = vector[3], loop.q = vector[4];
  loop.product = product, loop.precondition = precondition;
  for (size_t k = 0; k < N; k++) {
    vector[0][k] = 0;
    vector[1][k] = 1;
    diagonal[k] = (double)(1 + k % 3);
  }
  return loop;
}

static void as_many_iterations_as_eigenvalues(void **state) {
  (void)state;
  test_solver s;
  hk_residual part[2];
  test_solver_open(&s, "pcg", 2);
  hk_gradients_loop loop = begin(&s, part);
  const hk_residual goal = {INFINITY, 1e-12};
  assert_true(hk_gradients_iterate(&loop, &goal, 100));
  assert_int_equal(loop.iterations, 3);
  for (size_t k = 0; k < N; k++) assert_true(fabs(vector[0][k] - 1 / diagonal[k]) < 1e-12);
  test_solver_close(&s);
}

/* After the first step r = (a, -b, -c) differs in size: each goal has to be met by its own. */
static void both_sizes_of_the_residual_are_asked_for(void **state) {
  (void)state;
  test_solver s;
  hk_residual part[2];
  test_solver_open(&s, "pcg", 1);
  for (int which = 0; which < 2; which++) {
    hk_gradients_loop loop = begin(&s, part);
    const hk_residual goal = {which == 0 ? 1e-10 : INFINITY, which == 1 ? 0.3 : INFINITY};
    assert_true(hk_gradients_iterate(&loop, &goal, 100));
    double squares = 0, largest = 0;
    for (size_t k = 0; k < N; k++) {
      squares += vector[1][k] * vector[1][k];
      largest = fmax(largest, fabs(vector[1][k]));
    }
    assert_true(fabs(loop.left.largest - largest) < 1e-15);
    assert_true(fabs(loop.left.squares - squares) <= 1e-12 * squares + 1e-20);
    assert_int_equal(loop.iterations, which == 0 ? 3 : 2);
  }
  test_solver_close(&s);
}

static void what_is_not_finite_does_not_end_well(void **state) {
  (void)state;
  test_solver s;
  hk_residual part[2];
  test_solver_open(&s, "pcg", 1);
  hk_gradients_loop loop = begin(&s, part);
  const hk_residual goal = {INFINITY, 0.1};
  vector[1][7] = NAN;
  assert_false(hk_gradients_iterate(&loop, &goal, 100));
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(as_many_iterations_as_eigenvalues),
      cmocka_unit_test(both_sizes_of_the_residual_are_asked_for),
      cmocka_unit_test(what_is_not_finite_does_not_end_well),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
