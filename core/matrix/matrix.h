/* Sparse matrices as patterns: where the blocks are that forces or constraints name, and which rows follow from
 * others. */
#ifndef HK_MATRIX_H
#define HK_MATRIX_H

#include "core/base/base.h"

/* ---- block_matrix.c: the pattern of a matrix from named blocks; a zeroed structure is an empty pattern ---- */

typedef struct hk_block_matrix {
  hk_pattern naming; /* first member: passed to the plugin that names blocks */
  size_t rows, columns;
  size_t named, capacity;
  uint32_t (*pair)[2]; /* named: row and column, in the order of naming; freed by the build */
  bool no_memory, out_of_range;
  size_t *slot;      /* named: position in `column` of the e-th named block */
  size_t *row_start; /* rows + 1 */
  uint32_t *column;  /* row_start[rows], rising within a row */
  uint64_t number;   /* of row_start and column, hk_matrix.pattern */
} hk_block_matrix;

void hk_block_matrix_begin(hk_block_matrix *, size_t rows, size_t columns); /* removes the old pattern */
/* Builds slot, row_start and column from the named blocks. HK_NO_MEMORY, or HK_FAILED: a block lies outside the
 * matrix. */
hk_status hk_block_matrix_build(hk_block_matrix *);
/* A hash of a pattern: equal patterns have equal numbers, different patterns have different ones (except one pair in
 * 2^64). */
uint64_t hk_pattern_number(size_t rows, size_t block, const size_t *row_start, const uint32_t *column);
void hk_block_matrix_free(hk_block_matrix *);

/* ---- independent_rows.c ---- */

/* implied[r]: row r of the symmetric matrix A with 1 x 1 blocks and a unit diagonal follows from the rows before it
 * that are not implied themselves. */
hk_status hk_independent_rows(const hk_matrix *A, bool *implied, hk_error *error);

#endif
