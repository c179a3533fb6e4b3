/* See transfer.h. Rows are independent of each other, so each is computed by one thread, in one order. */
#include "plugins/common/multigrid/transfer.h"

#include <string.h>

enum { ROWS = 256, MOST = 256 /* aggregates that a row of P sees; further ones keep what T has */ };

/* ---- pattern ---- */

/* Puts a value into a rising list, where it is not there and there is room; returns by how much the list is longer. */
static size_t insert(uint32_t *list, size_t count, uint32_t value) {
  size_t at = 0;
  while (at < count && list[at] < value) at++;
  if (at < count && list[at] == value) return 0;
  if (count == MOST) return 0;
  memmove(list + at + 1, list + at, (count - at) * sizeof *list);
  list[at] = value;
  return 1;
}

static bool is_zero(const hk_matrix *A, size_t e) {
  size_t bb = A->block * A->block;
  for (size_t k = 0; k < bb; k++)
    if (A->value[bb * e + k] != 0) return false;
  return true;
}

/* The aggregates of row r and of its neighbours; none for a row without an aggregate, which keeps its solution: what is
 * fixed is moved by nothing. */
static size_t columns_of(const hk_matrix *A, const uint32_t *aggregate, size_t r, uint32_t *list) {
  size_t count = 0;
  if (aggregate[r] == UINT32_MAX) return 0;
  count += insert(list, count, aggregate[r]);
  for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
    uint32_t name = aggregate[A->column[e]];
    if (name != UINT32_MAX && !is_zero(A, e)) count += insert(list, count, name);
  }
  return count;
}

typedef struct task {
  hk_transfer *P;
  const hk_matrix *A;
  const double *inverse;
  const uint32_t *aggregate;
  double w;
  const double *from;
  double *to;
} task;

static void count_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  uint32_t list[MOST];
  (void)chunk;
  for (size_t r = begin; r < end; r++) t->P->start[r + 1] = columns_of(t->A, t->aggregate, r, list);
}

static void list_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  uint32_t list[MOST];
  (void)chunk;
  for (size_t r = begin; r < end; r++) {
    size_t count = columns_of(t->A, t->aggregate, r, list);
    memcpy(t->P->column + t->P->start[r], list, count * sizeof *list);
  }
}

static void transpose(hk_transfer *P) {
  size_t *at = P->back_start;
  for (size_t e = 0; e < P->start[P->rows]; e++) at[P->column[e] + 1]++;
  for (size_t c = 0; c < P->columns; c++) at[c + 1] += at[c];
  for (size_t r = 0; r < P->rows; r++)
    for (size_t e = P->start[r]; e < P->start[r + 1]; e++) {
      size_t to = at[P->column[e]]++;
      P->back_row[to] = (uint32_t)r;
      P->back_entry[to] = (uint32_t)e;
    }
  for (size_t c = P->columns; c > 0; c--) at[c] = at[c - 1];
  at[0] = 0;
}

/* ---- numbers ---- */

static size_t place(const hk_transfer *P, size_t r, uint32_t column) {
  for (size_t e = P->start[r]; e < P->start[r + 1]; e++)
    if (P->column[e] == column) return e;
  return SIZE_MAX;
}

/* to = I at the aggregate of r, less w D^-1 times the sum of `to`, the blocks of A by aggregates. */
static void smooth_row(const task *t, size_t r) {
  hk_transfer *P = t->P;
  size_t b = P->block, bb = b * b;
  const double *D = t->inverse + bb * r;
  for (size_t e = P->start[r]; e < P->start[r + 1]; e++) {
    double sum[9], *to = P->value + bb * e;
    memcpy(sum, to, bb * sizeof *sum);
    for (size_t i = 0; i < b; i++)
      for (size_t j = 0; j < b; j++) {
        double product = 0;
        for (size_t k = 0; k < b; k++) product += D[b * i + k] * sum[b * k + j];
        to[b * i + j] = (i == j && P->column[e] == t->aggregate[r] ? 1 : 0) - t->w * product;
      }
  }
}

static void fill_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  size_t bb = t->P->block * t->P->block;
  (void)chunk;
  for (size_t r = begin; r < end; r++) {
    if (t->aggregate[r] == UINT32_MAX) continue;
    for (size_t e = t->A->row_start[r]; e < t->A->row_start[r + 1]; e++) {
      uint32_t name = t->aggregate[t->A->column[e]];
      size_t at = name == UINT32_MAX ? SIZE_MAX : place(t->P, r, name);
      for (size_t k = 0; k < bb && at != SIZE_MAX; k++) t->P->value[bb * at + k] += t->A->value[bb * e + k];
    }
    smooth_row(t, r);
  }
}

hk_status hk_transfer_build(hk_transfer *P, const hk_host *host, const hk_matrix *A, const double *inverse, double w,
                            const uint32_t *aggregate, size_t aggregates) {
  task t = {.P = P, .A = A, .inverse = inverse, .aggregate = aggregate, .w = w};
  size_t bb = A->block * A->block;
  hk_transfer_free(P, host);
  P->rows = A->rows;
  P->columns = aggregates;
  P->block = A->block;
  P->start = host->allocate(host, (A->rows + 1) * sizeof *P->start);
  P->back_start = host->allocate(host, (aggregates + 2) * sizeof *P->back_start);
  if (!P->start || !P->back_start) return HK_NO_MEMORY;
  host->parallel_for(host, A->rows, ROWS, count_rows, &t);
  for (size_t r = 0; r < A->rows; r++) P->start[r + 1] += P->start[r];
  size_t count = P->start[A->rows];
  P->column = host->allocate(host, (count + 1) * sizeof *P->column);
  P->value = host->allocate(host, (count + 1) * bb * sizeof *P->value);
  P->back_row = host->allocate(host, (count + 1) * sizeof *P->back_row);
  P->back_entry = host->allocate(host, (count + 1) * sizeof *P->back_entry);
  if (!P->column || !P->value || !P->back_row || !P->back_entry) return HK_NO_MEMORY;
  host->parallel_for(host, A->rows, ROWS, list_rows, &t);
  host->parallel_for(host, A->rows, ROWS, fill_rows, &t);
  transpose(P);
  return HK_OK;
}

void hk_transfer_free(hk_transfer *P, const hk_host *host) {
  void *all[] = {P->start, P->column, P->value, P->back_start, P->back_row, P->back_entry};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  *P = (hk_transfer){0};
}

/* ---- use ---- */

static void restrict_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_transfer *P = t->P;
  size_t b = P->block;
  (void)chunk;
  for (size_t c = begin; c < end; c++) {
    double sum[3] = {0};
    for (size_t k = P->back_start[c]; k < P->back_start[c + 1]; k++) {
      const double *B = P->value + b * b * P->back_entry[k], *x = t->from + b * P->back_row[k];
      for (size_t i = 0; i < b; i++)
        for (size_t j = 0; j < b; j++) sum[j] += B[b * i + j] * x[i];
    }
    for (size_t j = 0; j < b; j++) t->to[b * c + j] = sum[j];
  }
}

static void prolong_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_transfer *P = t->P;
  size_t b = P->block;
  (void)chunk;
  for (size_t r = begin; r < end; r++)
    for (size_t e = P->start[r]; e < P->start[r + 1]; e++) {
      const double *B = P->value + b * b * e, *x = t->from + b * P->column[e];
      for (size_t i = 0; i < b; i++)
        for (size_t j = 0; j < b; j++) t->to[b * r + i] += B[b * i + j] * x[j];
    }
}

void hk_transfer_restrict(const hk_transfer *P, const hk_host *host, const double *fine, double *coarse) {
  task t = {.P = (hk_transfer *)P, .from = fine, .to = coarse};
  host->parallel_for(host, P->columns, ROWS, restrict_rows, &t);
}

void hk_transfer_prolong(const hk_transfer *P, const hk_host *host, const double *coarse, double *fine) {
  task t = {.P = (hk_transfer *)P, .from = coarse, .to = fine};
  host->parallel_for(host, P->rows, ROWS, prolong_rows, &t);
}
