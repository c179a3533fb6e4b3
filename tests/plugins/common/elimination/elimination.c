/* The order of elimination: no fill on trees, a band no longer than it is wide, equal components found again. */
#include "plugins/common/elimination/elimination.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static void tree_has_no_fill(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "banded", 1);
  for (size_t rows = 1; rows < 3000; rows = 3 * rows + 1) {
    test_matrix_begin(&s, rows);
    for (size_t i = 1; i < rows; i++) test_matrix_pair(&s, i, (size_t)((test_noise() + 0.5) * (double)i));
    test_matrix_end(&s, 1);
    hk_components c = hk_components_find(&s.solver->host, &s.A);
    hk_elimination e = hk_elimination_find(&s.solver->host, &s.A, &c, 0, rows);
    assert_int_equal(c.count, 1);
    assert_int_equal(e.status, HK_OK);
    assert_int_equal(e.start[rows], 2 * rows - 1);
    for (size_t b = 0; b < 2 * rows - 1; b++) assert_int_not_equal(e.origin[b].position, UINT32_MAX);
    hk_elimination_free(&e, &s.solver->host);
    hk_components_free(&c, &s.solver->host);
  }
  test_solver_close(&s);
}

/* A band of width w has w + 1 blocks per column; the middle, where both halves meet, takes at most w^2 more. */
static void band_stays_as_narrow_as_it_is(void **state) {
  (void)state;
  enum { ROWS = 1000 };
  test_solver s;
  test_solver_open(&s, "banded", 1);
  for (size_t w = 1; w < 8; w++) {
    test_matrix_begin(&s, ROWS);
    for (size_t i = 0; i < ROWS; i++)
      for (size_t k = 1; k <= w && k <= i; k++) test_matrix_pair(&s, i, i - k);
    test_matrix_end(&s, 3);
    hk_components c = hk_components_find(&s.solver->host, &s.A);
    hk_elimination e = hk_elimination_find(&s.solver->host, &s.A, &c, 0, ROWS * w * w);
    assert_int_equal(e.status, HK_OK);
    assert_true(e.start[ROWS] <= ROWS * (w + 1) + w * w);
    hk_elimination_free(&e, &s.solver->host);
    hk_components_free(&c, &s.solver->host);
  }
  test_solver_close(&s);
}

/* Chains of 3, 5, 3, 5, ... rows side by side, and a ring of 5 with as many blocks in a row as a chain has nowhere. */
static void components_of_one_graph_are_one_class(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "banded", 1);
  test_matrix_begin(&s, 45);
  for (size_t k = 0, at = 0; k < 10; at += k++ % 2 ? 5 : 3)
    for (size_t i = 1; i < (k % 2 ? 5 : 3); i++) test_matrix_pair(&s, at + i, at + i - 1);
  for (size_t i = 0; i < 5; i++) test_matrix_pair(&s, 40 + i, 40 + (i + 1) % 5);
  test_matrix_end(&s, 3);
  hk_components c = hk_components_find(&s.solver->host, &s.A);
  assert_int_equal(c.count, 11);
  assert_int_equal(c.classes, 3);
  for (size_t k = 0; k < 10; k++) assert_int_equal(c.kind[k], k % 2);
  assert_int_equal(c.kind[10], 2);
  hk_components_free(&c, &s.solver->host);
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tree_has_no_fill),
      cmocka_unit_test(band_stays_as_narrow_as_it_is),
      cmocka_unit_test(components_of_one_graph_are_one_class),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
