/* Substitution with random factors of known shape: L L^T x = b holds when multiplied out, for every width of panel and
 * number of columns, and both paths give the same bits. */
#include "core/engine/base/base.h"
#include "plugins/common/linear/triangular.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { N = 120, SUPERNODES = 26 };

static uint64_t bits = 1;

static double noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

/* A factor in the supernodal layout beside the same numbers as a full matrix. */
typedef struct factor {
  int64_t first[SUPERNODES + 1], list[SUPERNODES], rows[SUPERNODES], row[N * SUPERNODES], column[N], order[N];
  double value[N * N], full[N][N];
  hk_factor_view view;
} factor;

/* Supernodes of widths 1, 2, ... 9 and so on, below which each row is there with probability 0.4. */
static void make_factor(factor *f) {
  size_t column = 0, rows = 0, value = 0, s = 0;
  memset(f, 0, sizeof *f);
  for (; column < N; s++) {
    size_t width = s % 9 + 1, begin = rows;
    if (column + width > N) width = N - column;
    f->first[s] = (int64_t)column;
    f->list[s] = (int64_t)rows;
    for (size_t i = column; i < N; i++)
      if (i < column + width || noise() < -0.1) f->row[rows++] = (int64_t)i;
    f->rows[s] = (int64_t)(rows - begin);
    for (size_t c = 0; c < width; c++, value += rows - begin) {
      f->column[column + c] = (int64_t)value;
      for (size_t r = 0; r < rows - begin; r++) {
        double number = r < c ? NAN : r == c ? 2 + noise() : noise() / 20; /* what is above the diagonal is not read */
        f->value[value + r] = number;
        if (r >= c) f->full[f->row[begin + r]][column + c] = number;
      }
    }
    column += width;
  }
  f->first[s] = N;
  for (int64_t k = 0; k < N; k++) f->order[k] = k * 7 % N;
  f->view = (hk_factor_view){N, s, f->first, f->list, f->rows, f->row, f->column, f->value, f->order};
}

/* Row order[k] of A is row k of L. */
static void multiply(const factor *f, const double *x, double *b, size_t columns) {
  for (size_t c = 0; c < columns; c++) {
    double y[N] = {0};
    for (size_t i = 0; i < N; i++)
      for (size_t j = 0; j <= i; j++) y[j] += f->full[i][j] * x[columns * (size_t)f->order[i] + c];
    for (size_t i = 0; i < N; i++) {
      double sum = 0;
      for (size_t j = 0; j <= i; j++) sum += f->full[i][j] * y[j];
      b[columns * (size_t)f->order[i] + c] = sum;
    }
  }
}

/* x is of order 1, and rows of L sum to less than 4 beside a diagonal of 2: a condition below 1e3, times rounding. */
static void what_was_multiplied_is_solved(void **state) {
  (void)state;
  fake_system *system = fake_system_create(&(fake_problem){.n = 1});
  factor *f = malloc(sizeof *f);
  make_factor(f);
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    system->host.lanes = lanes;
    hk_triangular *t = hk_triangular_create(&system->host, &f->view);
    hk_triangular_fill(t, &f->view);
    for (size_t columns = 1; columns <= 9; columns++) {
      double x[9 * N], b[9 * N], got[9 * N];
      for (size_t k = 0; k < columns * N; k++) x[k] = noise();
      multiply(f, x, b, columns);
      hk_triangular_solve(t, b, got, columns);
      for (size_t k = 0; k < columns * N; k++) assert_true(fabs(got[k] - x[k]) < 1e-12);
    }
    hk_triangular_free(t, &system->host);
  }
  free(f);
  fake_system_destroy(system);
}

static void paths_give_the_same_bits(void **state) {
  (void)state;
  fake_system *system = fake_system_create(&(fake_problem){.n = 1});
  factor *f = malloc(sizeof *f);
  make_factor(f);
  double b[3 * N], x[3 * N], narrow[3 * N];
  for (size_t k = 0; k < 3 * N; k++) b[k] = noise();
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    system->host.lanes = lanes;
    hk_triangular *t = hk_triangular_create(&system->host, &f->view);
    hk_triangular_fill(t, &f->view);
    hk_triangular_solve(t, b, lanes == 2 ? narrow : x, 3);
    if (lanes > 2) assert_memory_equal(x, narrow, sizeof x);
    hk_triangular_free(t, &system->host);
  }
  free(f);
  fake_system_destroy(system);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_was_multiplied_is_solved),
      cmocka_unit_test(paths_give_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
