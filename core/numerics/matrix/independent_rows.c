/* Finds equalities that follow from others at all states of a scene, such as those of a bar given twice or of a closed
 * loop, by an up-looking Cholesky factorization: a row whose pivot vanishes depends on the rows before it and is left
 * out (Davis, Direct Methods for Sparse Linear Systems, 4.7). Without these rows, accelerations are a smooth function
 * of the state also off the constraints, where the stages of a method evaluate them; with the singular system of all
 * equations they are not. */

#include "core/numerics/matrix/matrix.h"

#include <stdlib.h>

static const double no_pivot = 1e-10; /* of a matrix with a unit diagonal: dependent up to 1e-5 of a direction */

typedef struct column {
  size_t count, capacity;
  struct {
    uint32_t row;
    double value;
  } * entry;
} column;

typedef struct factor {
  size_t rows;
  column *column;
  double *pivot, *x;
  uint32_t *parent, *mark, *stack;
  bool no_memory;
} factor;

/* Finds the nonzero columns of row r of L, in the order of elimination: from stack[top] on. */
static size_t reach(factor *f, const hk_matrix *A, uint32_t r) {
  size_t top = f->rows;
  f->mark[r] = r;
  for (size_t e = A->row_start[r]; e < A->row_start[r + 1] && A->column[e] < r; e++) {
    size_t length = 0;
    f->x[A->column[e]] = A->value[e];
    for (uint32_t j = A->column[e]; f->mark[j] != r; j = f->parent[j]) {
      f->stack[length++] = j;
      f->mark[j] = r;
      if (f->parent[j] == UINT32_MAX) f->parent[j] = r;
    }
    while (length > 0) f->stack[--top] = f->stack[--length];
  }
  return top;
}

static void append(factor *f, column *to, uint32_t row, double value) {
  void *entry = to->entry;
  f->no_memory |= hk_array_reserve(&entry, &to->capacity, to->count + 1, sizeof *to->entry) != 0;
  to->entry = entry;
  if (f->no_memory) return;
  to->entry[to->count].row = row;
  to->entry[to->count++].value = value;
}

/* The pivot of row r, eliminated with the rows before it that are not implied. */
static double eliminate(factor *f, const hk_matrix *A, uint32_t r, const bool *implied) {
  double pivot = 0;
  for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
    if (A->column[e] == r) pivot = A->value[e];
  for (size_t p = reach(f, A, r); p < f->rows && !f->no_memory; p++) {
    uint32_t j = f->stack[p];
    double value = f->x[j];
    f->x[j] = 0;
    if (implied[j]) continue;
    value /= f->pivot[j];
    for (size_t e = 0; e < f->column[j].count; e++)
      f->x[f->column[j].entry[e].row] -= f->column[j].entry[e].value * value;
    pivot -= value * value;
    append(f, &f->column[j], r, value);
  }
  return pivot;
}

hk_status hk_independent_rows(const hk_matrix *A, bool *implied, hk_error *error) {
  size_t m = A->rows;
  factor f = {m,
              calloc(m + 1, sizeof *f.column),
              calloc(m + 1, sizeof(double)),
              calloc(m + 1, sizeof(double)),
              malloc((m + 1) * sizeof(uint32_t)),
              malloc((m + 1) * sizeof(uint32_t)),
              malloc((m + 1) * sizeof(uint32_t)),
              false};
  f.no_memory = !f.column || !f.pivot || !f.x || !f.parent || !f.mark || !f.stack;
  for (size_t k = 0; k < m && !f.no_memory; k++) f.parent[k] = f.mark[k] = UINT32_MAX;
  for (uint32_t r = 0; r < m && !f.no_memory; r++) {
    double pivot = eliminate(&f, A, r, implied);
    implied[r] = pivot <= no_pivot;
    f.pivot[r] = implied[r] ? 1 : sqrt(pivot);
  }
  for (size_t k = 0; k < m && f.column; k++) free(f.column[k].entry);
  void *arrays[] = {f.column, f.pivot, f.x, f.parent, f.mark, f.stack};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  return f.no_memory ? hk_error_set(error, HK_NO_MEMORY, "no memory to compare %zu constraints", m) : HK_OK;
}
