/* A symmetric block matrix by its upper triangle, for products that read it once. */
#ifndef HK_UPPER_MATRIX_H
#define HK_UPPER_MATRIX_H

#include "core/plugin.h"

/* Rows are cut into chunks, these into groups of HK_UPPER_LANES rows. A chunk numbers what it touches from 0: its rows
 * (up to whole groups), then its places, which stand for the columns beyond it in rising order. Blocks of a group's
 * rows are stored side by side as slots, a lane for each row: first the diagonal, then slots whose lanes touch four
 * successive numbers ("even"), then the others. A lane without a block is zero. */
enum {
  HK_UPPER_LANES = 4,
  HK_UPPER_SPARE = 1024, /* more than the stride adds */
  HK_UPPER_LOCAL = 8192  /* numbers of a chunk that fit on the stack; more have memory of their own */
};

typedef struct hk_upper {
  size_t rows, block;
  size_t chunk, chunks; /* rows in a chunk, a multiple of the lanes */
  size_t *slot_start;   /* groups + 1: into slots */
  size_t *index_start;  /* groups + 1: into `index` */
  uint32_t *even;       /* groups: even slots behind the diagonal */
  uint32_t *index;      /* of an even slot the first lane's number, of another one each lane's */
  uint32_t *source;     /* slots x lanes: which block of A, or UINT32_MAX */
  double *value;        /* slots x block x block x lanes; of packed chunks less is used */
  bool *packed;         /* chunks: blocks are equal to their transposes and stored as xx, xy, xz, yy, yz, zz */
  size_t *place_start;  /* chunks + 1 */
  uint32_t *place_row;  /* places: the row each stands for */
  double *halo;         /* places x block: what a chunk has for rows of others */
  size_t *take_start;   /* chunks + 1: into `take`, by the chunk that receives */
  uint32_t *take;       /* its places, in the order of the chunks they come from */
  double **own;         /* chunks: working memory of those that do not fit on the stack, or NULL */
  double *part;         /* chunks */
} hk_upper;

/* The pattern of A, without numbers. HK_NO_MEMORY: free what is there. */
hk_status hk_upper_analyze(hk_upper *, const hk_host *, const hk_matrix *A);
/* The numbers of A, which has the pattern analysed; of diagonal blocks, too, the upper triangle counts. */
void hk_upper_fill(hk_upper *, const hk_host *, const hk_matrix *A);
/* y = A x; returns x.y. */
double hk_upper_product(const hk_upper *, const hk_host *, const double *x, double *y);
void hk_upper_free(hk_upper *, const hk_host *); /* a zeroed one is fine */

/* The first block of row r of A on or right of the diagonal. */
size_t hk_upper_first(const hk_matrix *A, size_t r);

/* Doubles from one component to the next in a chunk's working memory. No power of two, so that rows a line of a grid
 * apart do not fall into one place of the cache together with all their components. */
static inline size_t hk_upper_stride(size_t touched) { return (touched + HK_UPPER_LANES + 511) / 512 * 512 + 88; }

/* How many numbers chunk k touches, up to whole vectors. */
static inline size_t hk_upper_touched(const hk_upper *m, size_t k) {
  size_t rows = m->rows - k * m->chunk < m->chunk ? m->rows - k * m->chunk : m->chunk;
  size_t places = m->place_start[k + 1] - m->place_start[k];
  return (rows + HK_UPPER_LANES - 1) / HK_UPPER_LANES * HK_UPPER_LANES +
         (places + HK_UPPER_LANES - 1) / HK_UPPER_LANES * HK_UPPER_LANES;
}

#endif
