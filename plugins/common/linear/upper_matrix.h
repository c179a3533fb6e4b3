/* A symmetric block matrix by its upper triangle, for products that read it once. */
#ifndef HK_UPPER_MATRIX_H
#define HK_UPPER_MATRIX_H

#include "core/plugin.h"

/* Rows are cut into chunks, these into groups of HK_UPPER_LANES rows. A chunk numbers the rows that it uses from 0: its
 * own rows (rounded up to whole groups), then its places, which represent the columns beyond it in increasing order.
 * Blocks of a group's rows are stored side by side as slots, a lane for each row: first the diagonal, then slots whose
 * lanes use four successive local numbers ("even"), then the uneven ones. A lane without a block is zero. */
enum {
  HK_UPPER_LANES = 4,
  HK_UPPER_SPARE = 1024, /* padding, more than the stride adds */
  HK_UPPER_LOCAL = 8192  /* largest number of doubles of a chunk on the stack; larger chunks have memory of their own */
};

typedef struct hk_upper {
  size_t rows, block;
  size_t chunk, chunks; /* rows in a chunk, a multiple of the lanes */
  size_t *slot_start;   /* groups + 1: into slots */
  size_t *index_start;  /* groups + 1: into `index` */
  uint32_t *even;       /* groups: number of even slots after the diagonal */
  uint32_t *index;      /* local numbers: of the first lane of an even slot, of each lane of an uneven slot */
  uint32_t *source;     /* slots x lanes: position of the block in A, or UINT32_MAX */
  double *value;        /* slots x block x block x lanes; packed chunks use less of it */
  bool *packed;         /* chunks: blocks are equal to their transposes and stored as xx, xy, xz, yy, yz, zz */
  size_t *place_start;  /* chunks + 1 */
  uint32_t *place_row;  /* places: the row that each represents */
  double *halo;         /* places x block: contributions of a chunk to rows of other chunks */
  size_t *take_start;   /* chunks + 1: positions in `take`, by the receiving chunk */
  uint32_t *take;       /* the places that contribute to it, in the order of their chunks */
  double **own;         /* chunks: working memory of a chunk that does not fit on the stack, or NULL */
  double *part;         /* chunks */
} hk_upper;

/* Analyses the pattern of A. HK_NO_MEMORY: the structure must be freed. */
hk_status hk_upper_analyze(hk_upper *, const hk_host *, const hk_matrix *A);
/* Copies the values of A, whose pattern was analysed; of diagonal blocks the upper triangle is used. */
void hk_upper_fill(hk_upper *, const hk_host *, const hk_matrix *A);
/* y = A x; returns x.y. */
double hk_upper_product(const hk_upper *, const hk_host *, const double *x, double *y);
void hk_upper_free(hk_upper *, const hk_host *); /* a zeroed structure is allowed */

/* The first block of row r of A on or right of the diagonal. */
size_t hk_upper_first(const hk_matrix *A, size_t r);

/* Doubles from one component to the next in a chunk's working memory. It is no power of two, so that the components of
 * neighbouring grid lines do not map to the same cache set. */
static inline size_t hk_upper_stride(size_t touched) { return (touched + HK_UPPER_LANES + 511) / 512 * 512 + 88; }

/* The number of rows that chunk k uses, rounded up to whole vectors. */
static inline size_t hk_upper_touched(const hk_upper *m, size_t k) {
  size_t rows = m->rows - k * m->chunk < m->chunk ? m->rows - k * m->chunk : m->chunk;
  size_t places = m->place_start[k + 1] - m->place_start[k];
  return (rows + HK_UPPER_LANES - 1) / HK_UPPER_LANES * HK_UPPER_LANES +
         (places + HK_UPPER_LANES - 1) / HK_UPPER_LANES * HK_UPPER_LANES;
}

#endif
