/* Products of sparse block matrices with vectors: rows are independent, so each thread writes rows of its own. */
#include "plugins/common/linear/block_product.h"
#include "plugins/common/linear/block_vector.h"

enum { ROWS = 256 };

typedef struct full_task {
  const hk_matrix *A;
  const double *x;
  double *y;
  int lanes;
} full_task;

/* The last row of a block is loaded one number earlier, so that no memory beyond the matrix is read. */
HK_INLINE void full_rows(const full_task *t, size_t begin, size_t end) {
  const hk_matrix *A = t->A;
  for (size_t r = begin; r < end; r++) {
    vector a = {0}, b = {0}, c = {0};
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
      const double *B = A->value + 9 * e, *x = t->x + 3 * (size_t)A->column[e];
      vector head = {x[0], x[1], x[2], 0}, tail = {0, x[0], x[1], x[2]};
      a += LOAD(B) * head;
      b += LOAD(B + 3) * head;
      c += LOAD(B + 5) * tail;
    }
    t->y[3 * r] = a[0] + a[1] + a[2];
    t->y[3 * r + 1] = b[0] + b[1] + b[2];
    t->y[3 * r + 2] = c[1] + c[2] + c[3];
  }
}

HK_VERSIONS(static void, full_triples, (const full_task *t, size_t begin, size_t end), full_rows(t, begin, end))

static void full_single(const full_task *t, size_t begin, size_t end) {
  const hk_matrix *A = t->A;
  for (size_t r = begin; r < end; r++) {
    double sum = 0;
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) sum += A->value[e] * t->x[A->column[e]];
    t->y[r] = sum;
  }
}

static void full_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const full_task *t = context;
  (void)chunk;
  if (t->A->block == 1)
    full_single(t, begin, end);
  else
    HK_WIDEST(t->lanes, full_triples)(t, begin, end);
}

void hk_block_product(const hk_host *host, const hk_matrix *A, const double *x, double *y) {
  full_task task = {A, x, y, host->lanes};
  host->parallel_for(host, A->rows, ROWS, full_chunk, &task);
}
