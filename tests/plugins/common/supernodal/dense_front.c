/* The dense part of a front: L and the update are those of a factorization as the book has it, to rounding, for numbers
 * of columns and rows on both sides of a tile, a block and a chunk; bits depend neither on threads nor, from vectors of
 * four on, on their width; a pivot that is not positive is named. */
#include "plugins/common/supernodal/dense_front.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { VECTOR = HK_FRONT_VECTOR / sizeof(double) };

typedef struct front {
  hk_dense_front f;
  size_t rows; /* of the whole matrix: columns and outer */
  double *A;   /* rows x columns, row-major: what is factorized */
} front;

static size_t in_vectors(size_t numbers) { return (numbers + VECTOR - 1) / VECTOR * VECTOR; }

/* As supernodes.c lays it out. */
static void open_front(front *t, const hk_host *host, int lanes, size_t columns, size_t outer) {
  size_t top = in_vectors(columns) - columns, ld = (in_vectors(top + columns + outer) / VECTOR | 1) * VECTOR;
  size_t ldu = outer ? (in_vectors(outer) / VECTOR | 1) * VECTOR : 0;
  t->rows = columns + outer;
  t->A = calloc(t->rows * columns, sizeof *t->A);
  t->f = (hk_dense_front){.host = host, .path = hk_dense_double(lanes), .ld = ld, .top = top, .columns = columns};
  t->f.outer = outer;
  t->f.ldu = ldu;
  t->f.panel = host->allocate(host, ld * columns * sizeof(double));
  t->f.inverse = host->allocate(host, columns * sizeof(double));
  t->f.update = host->allocate(host, (ldu * outer + 1) * sizeof(double));
  t->f.work = host->allocate(host, hk_dense_front_work(columns, outer) * sizeof(double));
}

static void close_front(front *t) {
  const hk_host *host = t->f.host;
  host->release(host, t->f.panel);
  host->release(host, t->f.inverse);
  host->release(host, t->f.update);
  host->release(host, t->f.work);
  free(t->A);
}

/* Numbers in [-1/2, 1/2) that depend on their place alone, and a diagonal above the sum of a row. */
static double entry(size_t i, size_t j, size_t rows) {
  uint64_t bits = ((uint64_t)i * 8191 + j + 1) * 6364136223846793005u;
  bits = (bits ^ (bits >> 32)) * 0x9E3779B97F4A7C15u;
  return i == j ? (double)rows : (double)(bits >> 11) * 0x1p-53 - 0.5;
}

static void fill(front *t) {
  double *panel = t->f.panel;
  for (size_t j = 0; j < t->f.columns; j++)
    for (size_t i = j; i < t->rows; i++)
      panel[t->f.ld * j + t->f.top + i] = t->A[t->f.columns * i + j] = entry(i, j, t->rows);
}

static double panel_at(const front *t, size_t i, size_t j) {
  return ((const double *)t->f.panel)[t->f.ld * j + t->f.top + i];
}

/* Column by column, in A. */
static void factorize_plainly(front *t) {
  size_t c = t->f.columns;
  for (size_t j = 0; j < c; j++)
    for (size_t i = j; i < t->rows; i++) {
      double sum = t->A[c * i + j];
      for (size_t k = 0; k < j; k++) sum -= t->A[c * i + k] * t->A[c * j + k];
      t->A[c * i + j] = i == j ? sqrt(sum) : sum / t->A[c * j + j];
    }
}

/* Numbers are below the root of `rows`; sums of 500 products lose some hundred units of rounding of 1 at most. */
static void compare(front *t) {
  size_t c = t->f.columns;
  const double *U = t->f.update;
  for (size_t j = 0; j < c; j++)
    for (size_t i = j; i < t->rows; i++) assert_true(fabs(panel_at(t, i, j) - t->A[c * i + j]) < 1e-12);
  for (size_t j = 0; j < t->f.outer; j++)
    for (size_t i = j; i < t->f.outer; i++) {
      double sum = 0;
      for (size_t k = 0; k < c; k++) sum -= t->A[c * (c + i) + k] * t->A[c * (c + j) + k];
      assert_true(fabs(U[t->f.ldu * j + i] - sum) < 1e-12);
    }
}

static const size_t sizes[][2] = {{1, 0},   {1, 1},   {3, 2},    {6, 40},   {9, 7},    {12, 205}, {48, 16},
                                  {191, 5}, {192, 9}, {193, 33}, {200, 90}, {385, 50}, {450, 0},  {400, 210}};
enum { SIZES = sizeof sizes / sizeof *sizes };

static void factors_are_those_of_the_book(void **state) {
  (void)state;
  static const int lanes[] = {2, 4, 8};
  test_solver s;
  test_solver_open(&s, "supernodal", 1);
  for (size_t k = 0; k < SIZES; k++)
    for (int w = 0; w < 3 && lanes[w] <= s.solver->host.lanes; w++) {
      front t;
      open_front(&t, &s.solver->host, lanes[w], sizes[k][0], sizes[k][1]);
      fill(&t);
      assert_int_equal(hk_dense_front_factorize(&t.f), t.f.columns);
      factorize_plainly(&t);
      compare(&t);
      close_front(&t);
    }
  test_solver_close(&s);
}

static void same_lower_triangles(const front *a, const front *b) {
  const double *U = a->f.update, *V = b->f.update;
  for (size_t j = 0; j < a->f.columns; j++)
    for (size_t i = j; i < a->rows; i++) assert_true(panel_at(a, i, j) == panel_at(b, i, j));
  for (size_t j = 0; j < a->f.outer; j++)
    for (size_t i = j; i < a->f.outer; i++) assert_true(U[a->f.ldu * j + i] == V[a->f.ldu * j + i]);
}

static void bits_depend_neither_on_threads_nor_on_widths(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  test_solver first;
  test_solver_open(&first, "supernodal", 1);
  int widest = first.solver->host.lanes;
  for (size_t k = 0; k < SIZES; k++) {
    front one;
    open_front(&one, &first.solver->host, widest, sizes[k][0], sizes[k][1]);
    fill(&one);
    assert_int_equal(hk_dense_front_factorize(&one.f), one.f.columns);
    for (int n = 0; n < 3; n++) {
      front t;
      test_solver s;
      test_solver_open(&s, "supernodal", threads[n]);
      open_front(&t, &s.solver->host, widest > 4 ? 4 : widest, sizes[k][0], sizes[k][1]);
      t.f.on_all_threads = true;
      fill(&t);
      assert_int_equal(hk_dense_front_factorize(&t.f), t.f.columns);
      same_lower_triangles(&one, &t);
      close_front(&t);
      test_solver_close(&s);
    }
    close_front(&one);
  }
  test_solver_close(&first);
}

static void a_pivot_that_is_not_positive_is_named(void **state) {
  (void)state;
  static const size_t bad[] = {0, 5, 66, 191, 192, 399};
  test_solver s;
  test_solver_open(&s, "supernodal", 1);
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    front t;
    open_front(&t, &s.solver->host, s.solver->host.lanes, 400, 20);
    fill(&t);
    ((double *)t.f.panel)[t.f.ld * bad[k] + t.f.top + bad[k]] = -1;
    assert_int_equal(hk_dense_front_factorize(&t.f), bad[k]);
    close_front(&t);
  }
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(factors_are_those_of_the_book),
      cmocka_unit_test(bits_depend_neither_on_threads_nor_on_widths),
      cmocka_unit_test(a_pivot_that_is_not_positive_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
