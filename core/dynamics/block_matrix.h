/* The pattern of a sparse block matrix, built from the blocks that others name. Free it once; a zeroed one is empty. */
#ifndef HK_BLOCK_MATRIX_H
#define HK_BLOCK_MATRIX_H

#include "core/plugin.h"

typedef struct hk_block_matrix {
  hk_pattern naming; /* first member: hand it to who names blocks */
  size_t rows, columns;
  size_t named, capacity;
  uint32_t (*pair)[2]; /* named: row and column, in the order of naming; gone after the build */
  bool no_memory, out_of_range;
  size_t *slot;      /* named: where the e-th block named is in `column` */
  size_t *row_start; /* rows + 1 */
  uint32_t *column;  /* row_start[rows], rising within a row */
  uint64_t number;   /* of row_start and column, hk_matrix.pattern */
} hk_block_matrix;

void hk_block_matrix_begin(hk_block_matrix *, size_t rows, size_t columns); /* drops what was there */
/* From the named blocks to slot, row_start and column. HK_NO_MEMORY, or HK_FAILED: a block outside the matrix. */
hk_status hk_block_matrix_build(hk_block_matrix *);
/* A number for a pattern, by its content: equal patterns have equal ones, others (but for one pair in 2^64) do not. */
uint64_t hk_pattern_number(size_t rows, size_t block, const size_t *row_start, const uint32_t *column);
void hk_block_matrix_free(hk_block_matrix *);

#endif
