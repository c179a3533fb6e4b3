/* The matrix of an implicit step of a stiff cloth of N x N particles, M + h^2 K, with the masses and pins of
 * scripts/scenes/curtain.lua, for benchmarks of solvers: structural, shear and flexion springs of k, 0.3 k and 0.05 k,
 * slightly stretched and waved, the upper row held. */
#ifndef HK_BENCH_CLOTH_MATRIX_H
#define HK_BENCH_CLOTH_MATRIX_H

#include "core/numerics/matrix/matrix.h"

#include <math.h>
#include <stdlib.h>

/* Of the k-th number, the same in every call. */
static inline double noise(size_t k) {
  uint64_t bits = ((uint64_t)k + 1) * 6364136223846793005u;
  bits = (bits ^ (bits >> 32)) * 0x9E3779B97F4A7C15u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

typedef struct cloth_matrix {
  hk_block_matrix pattern;
  hk_matrix A;
  double *x;
  uint32_t side;
} cloth_matrix;

enum { KINDS = 6 }; /* of springs: structural, shear, flexion, two directions each */

static const int offset[KINDS][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}, {2, 0}, {0, 2}};
static const double share[KINDS] = {1, 1, 0.3, 0.3, 0.05, 0.05}; /* of k: hang's 1000, 300, 50 N/m */

static inline double *block(cloth_matrix *c, size_t row, size_t column) {
  size_t e = c->A.row_start[row];
  while (c->A.column[e] != column) e++;
  return c->A.value + 9 * e;
}

/* Calls `visit` for every spring. */
static inline void each_spring(cloth_matrix *c, double k,
                               void (*visit)(cloth_matrix *, uint32_t a, uint32_t b, double k, double L)) {
  for (int o = 0; o < KINDS; o++)
    for (uint32_t a = 0; a < c->side * c->side; a++) {
      int64_t i = (int64_t)(a % c->side) + offset[o][0], j = (int64_t)(a / c->side) + offset[o][1];
      if (i < 0 || i >= c->side || j >= c->side) continue;
      visit(c, a, (uint32_t)(j * c->side + i), k * share[o], hypot(offset[o][0], offset[o][1]) / (c->side - 1));
    }
}

static inline void name_spring(cloth_matrix *c, uint32_t a, uint32_t b, double k, double L) {
  (void)k, (void)L;
  c->pattern.naming.block(&c->pattern.naming, a, b);
  c->pattern.naming.block(&c->pattern.naming, b, a);
}

/* k (d d^T + max(0, 1 - L/l) (1 - d d^T)); the top row is pinned. */
static inline void add_spring(cloth_matrix *c, uint32_t a, uint32_t b, double k, double L) {
  double d[3], l = 0;
  for (int q = 0; q < 3; q++) d[q] = c->x[3 * b + q] - c->x[3 * a + q], l += d[q] * d[q];
  l = sqrt(l);
  double across = fmax(0, 1 - L / l);
  bool free_a = a / c->side + 1 < c->side, free_b = b / c->side + 1 < c->side;
  for (int q = 0; q < 9; q++) {
    double K = k * ((1 - across) * d[q / 3] * d[q % 3] / (l * l) + (q % 4 == 0 ? across : 0));
    if (free_a) block(c, a, a)[q] += K;
    if (free_b) block(c, b, b)[q] += K;
    if (free_a && free_b) block(c, a, b)[q] -= K, block(c, b, a)[q] -= K;
  }
}

static inline void open_cloth_matrix(cloth_matrix *c, uint32_t side, double k, double h) {
  size_t n = (size_t)side * side;
  *c = (cloth_matrix){.side = side, .x = malloc(3 * n * sizeof(double))};
  for (size_t i = 0; i < n; i++) {
    double u = (double)(i % side) / (side - 1), v = (double)(i / side) / (side - 1);
    c->x[3 * i] = u;
    c->x[3 * i + 1] = v * (1 + 0.006 * sin(5 * u));
    c->x[3 * i + 2] = 0.02 * sin(19 * u + 7 * v);
  }
  hk_block_matrix_begin(&c->pattern, n, n);
  for (uint32_t i = 0; i < n; i++) c->pattern.naming.block(&c->pattern.naming, i, i);
  each_spring(c, 0, name_spring);
  if (hk_block_matrix_build(&c->pattern) != HK_OK) exit(1);
  c->A = (hk_matrix){
      .rows = n, .block = 3, .row_start = c->pattern.row_start, .column = c->pattern.column, .symmetric = true};
  c->A.value = calloc(9 * c->pattern.row_start[n], sizeof(double));
  for (uint32_t i = 0; i < n; i++)
    for (int q = 0; q < 9; q += 4) block(c, i, i)[q] = i / side + 1 < side ? 0.15 / (double)n : h * h * k;
  each_spring(c, h * h * k, add_spring);
}

static inline void close_cloth_matrix(cloth_matrix *c) {
  free(c->x);
  free(c->A.value);
  hk_block_matrix_free(&c->pattern);
}

#endif
