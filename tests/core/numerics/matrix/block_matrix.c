/* Patterns from named blocks, against the plain way: a table of all pairs. */
#include "core/numerics/matrix/matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { ROWS = 40, COLUMNS = 60, NAMED = 900 };

static void pattern_holds_each_named_block_once_and_sorted(void **state) {
  (void)state;
  hk_block_matrix m = {0};
  static bool there[ROWS][COLUMNS];
  uint32_t bits = 1, row[NAMED], column[NAMED];
  size_t distinct = 0;
  hk_block_matrix_begin(&m, ROWS, COLUMNS);
  for (size_t e = 0; e < NAMED; e++) {
    bits = bits * 1664525u + 1013904223u;
    row[e] = (bits >> 16) % (ROWS / 2) * 2; /* every other row stays empty */
    column[e] = (bits >> 8) % COLUMNS;
    distinct += !there[row[e]][column[e]];
    there[row[e]][column[e]] = true;
    m.naming.block(&m.naming, row[e], column[e]);
  }
  assert_int_equal(hk_block_matrix_build(&m), HK_OK);
  assert_int_equal(m.row_start[ROWS], distinct);
  for (size_t r = 0; r < ROWS; r++)
    for (size_t e = m.row_start[r]; e < m.row_start[r + 1]; e++) {
      assert_true(there[r][m.column[e]]);
      if (e > m.row_start[r]) assert_true(m.column[e] > m.column[e - 1]);
    }
  for (size_t e = 0; e < NAMED; e++) {
    assert_int_equal(m.column[m.slot[e]], column[e]);
    assert_in_range(m.slot[e], m.row_start[row[e]], m.row_start[row[e] + 1] - 1);
  }
  hk_block_matrix_free(&m);
}

/* One particle joined to all: a method quadratic in the length of a row would not end within the test's time. */
static void pattern_of_a_hub_takes_linear_time(void **state) {
  (void)state;
  enum { SPOKES = 1000000 };
  hk_block_matrix m = {0};
  hk_block_matrix_begin(&m, SPOKES, SPOKES);
  for (uint32_t i = SPOKES; i-- > 0;) {
    m.naming.block(&m.naming, 0, i);
    m.naming.block(&m.naming, i, 0);
  }
  assert_int_equal(hk_block_matrix_build(&m), HK_OK);
  assert_int_equal(m.row_start[1], SPOKES);
  assert_int_equal(m.row_start[SPOKES], 2 * SPOKES - 1);
  hk_block_matrix_free(&m);
}

static void pattern_refuses_a_block_outside(void **state) {
  (void)state;
  hk_block_matrix m = {0};
  hk_block_matrix_begin(&m, 3, 3);
  m.naming.block(&m.naming, 1, 3);
  assert_int_equal(hk_block_matrix_build(&m), HK_FAILED);
  hk_block_matrix_free(&m);
}

static void pattern_may_be_empty(void **state) {
  (void)state;
  hk_block_matrix m = {0};
  hk_block_matrix_begin(&m, 2, 2);
  assert_int_equal(hk_block_matrix_build(&m), HK_OK);
  assert_int_equal(m.row_start[2], 0);
  hk_block_matrix_free(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pattern_holds_each_named_block_once_and_sorted),
      cmocka_unit_test(pattern_of_a_hub_takes_linear_time),
      cmocka_unit_test(pattern_refuses_a_block_outside),
      cmocka_unit_test(pattern_may_be_empty),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
