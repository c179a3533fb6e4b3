/* The V-cycle is a symmetric positive definite operator, as conjugate gradients take it to be; coarse matrices are
 * P^T A P, made without all of A P at once; fixed rows are reached by no other; aggregates are whole. */
#include "plugins/common/multigrid/hierarchy.h"
#include "plugins/common/linear/block_product.h"
#include "tests/bench/cloth_matrix.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 50, ROWS = SIDE * SIDE, COUNT = 3 * ROWS };

typedef struct fixture {
  cloth_matrix cloth;
  test_solver s; /* its host */
  hk_upper upper;
  hk_hierarchy h;
} fixture;

static void open_fixture(fixture *f) {
  memset(f, 0, sizeof *f);
  open_cloth_matrix(&f->cloth, SIDE, 1e5, 1 / 60.0);
  test_solver_open(&f->s, "multigrid", 1);
  const hk_host *host = &f->s.solver->host;
  assert_int_equal(hk_upper_analyze(&f->upper, host, &f->cloth.A), HK_OK);
  hk_upper_fill(&f->upper, host, &f->cloth.A);
  assert_int_equal(hk_hierarchy_open(&f->h, host), HK_OK);
  assert_int_equal(hk_hierarchy_build(&f->h, &f->cloth.A, &f->upper), HK_OK);
  assert_true(f->h.levels > 1 && f->h.direct);
}

static void close_fixture(fixture *f) {
  hk_hierarchy_close(&f->h);
  hk_upper_free(&f->upper, &f->s.solver->host);
  test_solver_close(&f->s);
  close_cloth_matrix(&f->cloth);
}

static double product(const double *x, const double *y) {
  double sum = 0;
  for (size_t k = 0; k < COUNT; k++) sum += x[k] * y[k];
  return sum;
}

/* y.M^-1 x = x.M^-1 y up to the rounding of sums of COUNT numbers and of the coarsest solution (condition 1e7),
 * relative to the root of x.M^-1 x times y.M^-1 y. */
static void the_cycle_is_symmetric_and_positive_definite(void **state) {
  (void)state;
  static double x[COUNT + 8], y[COUNT + 8], u[COUNT + 8], v[COUNT + 8];
  fixture f;
  open_fixture(&f);
  for (size_t round = 0; round < 5; round++) {
    for (size_t k = 0; k < COUNT; k++) x[k] = noise(k + 7919 * round), y[k] = round ? noise(3 * k + round) : x[k] + 1;
    double xx = hk_hierarchy_apply(&f.h, x, u), yy = hk_hierarchy_apply(&f.h, y, v);
    assert_true(xx > 0 && yy > 0);
    assert_true(fabs(product(x, u) - xx) <= 1e-12 * xx);
    assert_true(fabs(product(y, u) - product(x, v)) <= 1e-9 * sqrt(xx * yy));
  }
  close_fixture(&f);
}

static void fixed_rows_are_reached_by_no_other(void **state) {
  (void)state;
  static double r[COUNT + 8], z[COUNT + 8];
  fixture f;
  open_fixture(&f);
  for (size_t k = 0; k < COUNT - 3 * SIDE; k++) r[k] = noise(k); /* the upper row is held */
  hk_hierarchy_apply(&f.h, r, z);
  for (size_t k = COUNT - 3 * SIDE; k < COUNT; k++) assert_true(z[k] == 0);
  close_fixture(&f);
}

/* x.(P^T A P) y = (P x).A (P y) for random vectors, to the rounding of their sums. */
static void coarse_matrices_are_those_of_galerkin(void **state) {
  (void)state;
  static double x[COUNT], y[COUNT], Px[COUNT], Py[COUNT], APy[COUNT], Ay[COUNT];
  fixture f;
  open_fixture(&f);
  const hk_level *fine = &f.h.level[0], *coarse = &f.h.level[1];
  const hk_host *host = &f.s.solver->host;
  double left = 0, right = 0, scale = 0;
  for (size_t k = 0; k < 3 * coarse->A.rows; k++) x[k] = noise(k), y[k] = noise(k + 1000000);
  hk_transfer_prolong(&fine->P, host, x, Px);
  hk_transfer_prolong(&fine->P, host, y, Py);
  hk_block_product(host, &f.cloth.A, Py, APy);
  hk_block_product(host, &coarse->A, y, Ay);
  for (size_t k = 0; k < 3 * coarse->A.rows; k++) left += x[k] * Ay[k];
  for (size_t k = 0; k < COUNT; k++) right += Px[k] * APy[k], scale += fabs(Px[k] * APy[k]);
  assert_true(scale > 0 && fabs(left - right) <= 1e-13 * scale);
  assert_true(hk_matrix_asymmetry(&coarse->A) < 1e-13);
  close_fixture(&f);
}

static size_t allocated; /* bytes */
static void *(*allocate)(const hk_host *, size_t);

static void *count_allocation(const hk_host *host, size_t bytes) {
  allocated += bytes;
  return allocate(host, bytes);
}

/* Blocks of A P. */
static size_t blocks_of_product(const hk_matrix *A, const hk_transfer *P) {
  static size_t seen[ROWS];
  size_t count = 0;
  memset(seen, 0, sizeof seen);
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      for (size_t f = P->start[A->column[e]]; f < P->start[A->column[e] + 1]; f++) {
        count += seen[P->column[f]] != r + 1;
        seen[P->column[f]] = r + 1;
      }
  return count;
}

/* Beside the coarse matrix: the pattern of A P, two lists of columns and a strip of its numbers, 1024 of 2500 rows. */
static void a_product_is_never_held_as_a_whole(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f);
  hk_matrix coarse;
  hk_host *host = &f.s.solver->host;
  allocate = host->allocate;
  host->allocate = count_allocation;
  allocated = 0;
  assert_int_equal(hk_transfer_galerkin(&f.h.level[0].P, host, &f.cloth.A, &coarse), HK_OK);
  host->allocate = allocate;
  size_t numbers = 9 * sizeof(double), own = (numbers + 4) * coarse.row_start[coarse.rows] + 8 * coarse.rows;
  size_t product = blocks_of_product(&f.cloth.A, &f.h.level[0].P), lists = 4 * product + 8 * ROWS + 16 * coarse.rows;
  assert_true(allocated - own - lists < numbers * product / 2);
  hk_coarse_free(&coarse, host);
  close_fixture(&f);
}

static void aggregates_have_every_joined_row_once(void **state) {
  (void)state;
  static uint32_t aggregate[ROWS];
  static double work[ROWS];
  fixture f;
  open_fixture(&f);
  size_t count = hk_aggregate(&f.cloth.A, 0.14, aggregate, work), sizes[ROWS] = {0};
  assert_true(count > ROWS / 13 && count < ROWS / 2);
  for (size_t r = 0; r < ROWS; r++) {
    assert_true((aggregate[r] == UINT32_MAX) == (r >= ROWS - SIDE)); /* the upper row alone is joined to none */
    if (aggregate[r] != UINT32_MAX) assert_true(aggregate[r] < count), sizes[aggregate[r]]++;
  }
  for (size_t k = 0; k < count; k++) assert_true(sizes[k] > 0);
  close_fixture(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_cycle_is_symmetric_and_positive_definite),
      cmocka_unit_test(fixed_rows_are_reached_by_no_other),
      cmocka_unit_test(coarse_matrices_are_those_of_galerkin),
      cmocka_unit_test(a_product_is_never_held_as_a_whole),
      cmocka_unit_test(aggregates_have_every_joined_row_once),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
