/* The solver banded beside cholmod on the matrices that it is made for: J W J^T of chains of bars (block 1), chains and
 * strands with springs to the next and the next but one (block 3), random trees. Time per row, the least of several
 * alternating repeats, on one thread. To reach: constant from 1e3 to 1e5 rows, factorize and solve of bars together at
 * most 20 ns. */
#include "tests/support/solver_matrix.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct shape {
  const char *name;
  size_t rows, strand, block, width; /* `strand` rows are one component; width 0: a random tree */
} shape;

static const shape shapes[] = {
    {"bars of a chain", 1000, 1000, 1, 1},     {"bars of a chain", 10000, 10000, 1, 1},
    {"bars of a chain", 100000, 100000, 1, 1}, {"bars of strands of 32", 32000, 32, 1, 1},
    {"chain, next", 1000, 1000, 3, 1},         {"chain, next", 100000, 100000, 3, 1},
    {"chain, next but one", 1000, 1000, 3, 2}, {"chain, next but one", 100000, 100000, 3, 2},
    {"strands of 33, next", 33000, 33, 3, 1},  {"strands, next but one", 33000, 33, 3, 2},
    {"strands, next but one", 3300, 33, 3, 2}, {"random tree", 1000, 1000, 3, 0},
    {"random tree", 100000, 100000, 3, 0},     {"band of 4", 10000, 10000, 3, 4},
    {"band of 8", 10000, 10000, 3, 8},         {"band of 16", 10000, 10000, 3, 16},
    {"band of 32", 10000, 10000, 3, 32},       {"band of 4", 10000, 10000, 1, 4},
    {"band of 8", 10000, 10000, 1, 8},         {"band of 16", 10000, 10000, 1, 16},
    {"band of 32", 10000, 10000, 1, 32},
};

static void make(test_solver *s, const shape *of) {
  test_matrix_begin(s, of->rows);
  for (size_t i = 0; i < of->rows; i++) {
    size_t place = i % of->strand, up = (size_t)((test_noise() + 0.5) * (double)place);
    for (size_t w = 1; w <= of->width && w <= place; w++) test_matrix_pair(s, i, i - w);
    if (of->width == 0 && place > 0) test_matrix_pair(s, i, up > place - 1 ? place - 1 : up);
  }
  test_matrix_end(s, of->block);
  test_matrix_fill(s, 0.1);
}

typedef struct times {
  double analyze, factorize, solve; /* s */
} times;

static void measure(test_solver *s, const double *b, double *x, times *best) {
  double t0 = now();
  if (test_solver_factorize(s) != HK_OK) exit(1);
  double t1 = now();
  if (test_solver_solve(s, b, x, NULL) != HK_OK) exit(1);
  double t2 = now();
  best->factorize = fmin(best->factorize, t1 - t0);
  best->solve = fmin(best->solve, t2 - t1);
}

static void run(const shape *of, int threads) {
  static const char *const names[2] = {"banded", "cholmod"};
  test_solver s[2];
  times best[2];
  size_t n = of->rows * of->block;
  double *b = calloc(2 * n, sizeof *b), *x = b + n;
  for (size_t k = 0; k < n; k++) b[k] = test_noise();
  for (int k = 0; k < 2; k++) {
    test_solver_open(&s[k], names[k], threads);
    make(&s[k], of);
    double t0 = now();
    if (test_solver_analyze(&s[k]) != HK_OK) exit(1);
    best[k] = (times){now() - t0, INFINITY, INFINITY};
  }
  for (size_t repeat = 0; repeat < 10 + 1000000 / of->rows; repeat++)
    for (int k = 0; k < 2; k++) measure(&s[k], b, x, &best[k]);
  printf("%-22s %7zu x %zu ", of->name, of->rows, of->block);
  for (int k = 0; k < 2; k++)
    printf("  %7.1f %7.1f %7.1f", 1e9 * best[k].analyze / (double)of->rows, 1e9 * best[k].factorize / (double)of->rows,
           1e9 * best[k].solve / (double)of->rows);
  printf("\n");
  for (int k = 0; k < 2; k++) test_solver_close(&s[k]);
  free(b);
}

int main(int count, char **arguments) {
  int threads = count > 1 ? atoi(arguments[1]) : 1;
  printf("ns per row                            banded: analyze, factorize, solve    cholmod\n");
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) run(&shapes[k], threads);
  return 0;
}
