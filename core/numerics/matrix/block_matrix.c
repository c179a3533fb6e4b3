/* Block compressed rows from (row, column) pairs: two stable counting sorts, by column and then by row, bring equal
 * pairs together in the order of the matrix; each run of them is one block. Time and memory are linear in the number of
 * pairs, rows and columns for any pattern, even when one row holds all blocks. */

#include "core/numerics/matrix/matrix.h"

#include <stdlib.h>

static void name_block(hk_pattern *pattern, uint32_t row, uint32_t column) {
  hk_block_matrix *m = (hk_block_matrix *)(void *)pattern;
  void *pair = m->pair;
  m->out_of_range |= row >= m->rows || column >= m->columns;
  m->no_memory |= hk_array_reserve(&pair, &m->capacity, m->named + 1, sizeof *m->pair) != 0;
  m->pair = pair;
  if (m->no_memory || m->out_of_range) return;
  m->pair[m->named][0] = row;
  m->pair[m->named++][1] = column;
}

void hk_block_matrix_begin(hk_block_matrix *m, size_t rows, size_t columns) {
  hk_block_matrix_free(m);
  *m = (hk_block_matrix){.naming = {name_block}, .rows = rows, .columns = columns};
}

/* Stable order of the pairs by their row (side 0) or column (side 1); `from` NULL: the order of naming. `start` has
 * keys + 1 entries. */
static void sort(const hk_block_matrix *m, int side, size_t keys, const size_t *from, size_t *to, size_t *start) {
  for (size_t k = 0; k <= keys; k++) start[k] = 0;
  for (size_t e = 0; e < m->named; e++) start[m->pair[e][side] + 1]++;
  for (size_t k = 0; k < keys; k++) start[k + 1] += start[k];
  for (size_t e = 0; e < m->named; e++) {
    size_t pair = from ? from[e] : e;
    to[start[m->pair[pair][side]]++] = pair;
  }
}

/* One block per run of equal pairs. */
static void number(hk_block_matrix *m, const size_t *order) {
  size_t count = 0;
  for (size_t e = 0; e < m->named; e++) {
    const uint32_t *here = m->pair[order[e]], *last = e ? m->pair[order[e - 1]] : NULL;
    if (!last || here[0] != last[0] || here[1] != last[1]) {
      m->column[count++] = here[1];
      m->row_start[here[0] + 1]++;
    }
    m->slot[order[e]] = count - 1;
  }
  for (size_t r = 0; r < m->rows; r++) m->row_start[r + 1] += m->row_start[r];
}

uint64_t hk_pattern_number(size_t rows, size_t block, const size_t *row_start, const uint32_t *column) {
  uint64_t hash = 1469598103934665603u ^ block;
  for (size_t r = 0; r <= rows; r++) hash = (hash ^ row_start[r]) * 0x9E3779B97F4A7C15u + (hash >> 29);
  for (size_t e = 0; e < row_start[rows]; e++) hash = (hash ^ column[e]) * 0x9E3779B97F4A7C15u + (hash >> 29);
  return hash | 1; /* 0 is reserved for patterns without a number */
}

hk_status hk_block_matrix_build(hk_block_matrix *m) {
  if (m->out_of_range) return HK_FAILED;
  size_t keys = m->rows > m->columns ? m->rows : m->columns;
  size_t *order = calloc(m->named + 1, sizeof *order), *start = malloc((keys + 1) * sizeof *start);
  m->slot = calloc(m->named + 1, sizeof *m->slot);
  m->column = malloc((m->named + 1) * sizeof *m->column);
  m->row_start = calloc(m->rows + 1, sizeof *m->row_start);
  bool fine = order && start && m->slot && m->column && m->row_start && !m->no_memory;
  if (fine) {
    sort(m, 1, m->columns, NULL, m->slot, start);
    sort(m, 0, m->rows, m->slot, order, start);
    number(m, order);
    uint32_t *tight = realloc(m->column, (m->row_start[m->rows] + 1) * sizeof *tight);
    if (tight) m->column = tight;
    m->number = hk_pattern_number(m->rows, 3, m->row_start, m->column);
    free(m->pair);
    m->pair = NULL;
    m->capacity = 0;
  }
  free(order);
  free(start);
  return fine ? HK_OK : HK_NO_MEMORY;
}

void hk_block_matrix_free(hk_block_matrix *m) {
  free(m->pair);
  free(m->slot);
  free(m->row_start);
  free(m->column);
  *m = (hk_block_matrix){0};
}
