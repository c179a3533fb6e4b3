/* The matrix of the next level, P^T A P. A P is computed first, row by row, and kept, so that a coarse row is the sum
 * of its rows of A P in their order, and no two threads add to one. Patterns are found by one thread, numbers by all.
 */
#include "plugins/common/multigrid/transfer.h"

enum { ROWS = 64 };

typedef struct sparse { /* as hk_transfer has its rows */
  size_t *start;
  uint32_t *column;
  double *value;
} sparse;

typedef struct task {
  const hk_transfer *P;
  const hk_matrix *A;
  sparse AP, coarse;
} task;

/* ---- patterns ---- */

/* Appends the columns of a row of `from` that are not yet marked with `mark`; returns the new length. */
static size_t append(const size_t *start, const uint32_t *column, size_t row, size_t *seen, size_t mark, uint32_t *list,
                     size_t count) {
  for (size_t e = start[row]; e < start[row + 1]; e++) {
    if (seen[column[e]] == mark) continue;
    seen[column[e]] = mark;
    if (list) list[count] = column[e];
    count++;
  }
  return count;
}

static void sort(uint32_t *list, size_t count) {
  for (size_t k = 1; k < count; k++) {
    uint32_t value = list[k];
    size_t at = k;
    for (; at > 0 && list[at - 1] > value; at--) list[at] = list[at - 1];
    list[at] = value;
  }
}

static size_t product_row(const task *t, size_t r, size_t *seen, size_t mark, uint32_t *list) {
  size_t count = 0;
  for (size_t e = t->A->row_start[r]; e < t->A->row_start[r + 1]; e++)
    count = append(t->P->start, t->P->column, t->A->column[e], seen, mark, list, count);
  return count;
}

static size_t coarse_row(const task *t, size_t c, size_t *seen, size_t mark, uint32_t *list) {
  size_t count = 0;
  for (size_t k = t->P->back_start[c]; k < t->P->back_start[c + 1]; k++)
    count = append(t->AP.start, t->AP.column, t->P->back_row[k], seen, mark, list, count);
  return count;
}

/* Counts, allocates, lists. `seen`: for every column, marks of rows; numbers of rows rise from `*mark` on. */
static bool find(const task *t, const hk_host *host, size_t rows, sparse *to, size_t *seen, size_t *mark,
                 size_t (*row)(const task *, size_t, size_t *, size_t, uint32_t *)) {
  size_t bb = t->A->block * t->A->block;
  to->start = host->allocate(host, (rows + 1) * sizeof *to->start);
  for (size_t r = 0; r < rows && to->start; r++) to->start[r + 1] = to->start[r] + row(t, r, seen, ++*mark, NULL);
  if (!to->start) return false;
  to->column = host->allocate(host, (to->start[rows] + 1) * sizeof *to->column);
  to->value = host->allocate(host, (to->start[rows] + 1) * bb * sizeof *to->value);
  if (!to->column || !to->value) return false;
  for (size_t r = 0; r < rows; r++) {
    row(t, r, seen, ++*mark, to->column + to->start[r]);
    sort(to->column + to->start[r], to->start[r + 1] - to->start[r]);
  }
  return true;
}

/* ---- numbers ---- */

static double *block_at(const sparse *s, size_t r, uint32_t column, size_t bb) {
  size_t low = s->start[r], high = s->start[r + 1];
  while (low + 1 < high) {
    size_t middle = low + (high - low) / 2;
    if (s->column[middle] <= column)
      low = middle;
    else
      high = middle;
  }
  return s->value + bb * low;
}

/* C += A B, or A^T B. */
static inline void add_product(double *restrict C, const double *restrict A, const double *restrict B) {
  for (size_t i = 0; i < 3; i++)
    for (size_t j = 0; j < 3; j++) C[3 * i + j] += A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

static inline void add_transposed(double *restrict C, const double *restrict A, const double *restrict B) {
  for (size_t i = 0; i < 3; i++)
    for (size_t j = 0; j < 3; j++) C[3 * i + j] += A[i] * B[j] + A[3 + i] * B[3 + j] + A[6 + i] * B[6 + j];
}

static void fill_product(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_transfer *P = t->P;
  size_t b = P->block, bb = b * b;
  (void)chunk;
  for (size_t r = begin; r < end; r++)
    for (size_t e = t->A->row_start[r]; e < t->A->row_start[r + 1]; e++) {
      uint32_t k = t->A->column[e];
      const double *block = t->A->value + bb * e;
      for (size_t f = P->start[k]; f < P->start[k + 1]; f++) {
        double *to = block_at(&t->AP, r, P->column[f], bb);
        if (b == 3)
          add_product(to, block, P->value + bb * f);
        else
          *to += *block * P->value[f];
      }
    }
}

static void fill_coarse(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_transfer *P = t->P;
  size_t b = P->block, bb = b * b;
  (void)chunk;
  for (size_t c = begin; c < end; c++)
    for (size_t k = P->back_start[c]; k < P->back_start[c + 1]; k++) {
      const double *block = P->value + bb * P->back_entry[k];
      for (size_t f = t->AP.start[P->back_row[k]]; f < t->AP.start[P->back_row[k] + 1]; f++) {
        double *to = block_at(&t->coarse, c, t->AP.column[f], bb);
        if (b == 3)
          add_transposed(to, block, t->AP.value + bb * f);
        else
          *to += *block * t->AP.value[f];
      }
    }
}

static void release(sparse *s, const hk_host *host) {
  host->release(host, s->start);
  host->release(host, s->column);
  host->release(host, s->value);
}

hk_status hk_transfer_galerkin(const hk_transfer *P, const hk_host *host, const hk_matrix *A, hk_matrix *coarse) {
  task t = {.P = P, .A = A};
  size_t mark = 0, *seen = host->allocate(host, (P->columns + 1) * sizeof *seen);
  bool fine = seen && find(&t, host, P->rows, &t.AP, seen, &mark, product_row) &&
              find(&t, host, P->columns, &t.coarse, seen, &mark, coarse_row);
  if (fine) {
    host->parallel_for(host, P->rows, ROWS, fill_product, &t);
    host->parallel_for(host, P->columns, ROWS, fill_coarse, &t);
  }
  host->release(host, seen);
  release(&t.AP, host);
  *coarse = (hk_matrix){P->columns, P->block, t.coarse.start, t.coarse.column, t.coarse.value, true, 0};
  return fine ? HK_OK : HK_NO_MEMORY;
}

void hk_coarse_free(hk_matrix *coarse, const hk_host *host) {
  sparse s = {(size_t *)coarse->row_start, (uint32_t *)coarse->column, coarse->value};
  release(&s, host);
  *coarse = (hk_matrix){0};
}
