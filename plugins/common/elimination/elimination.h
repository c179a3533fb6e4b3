/* The order in which the rows of one component are eliminated, and the blocks of its factor L. */
#ifndef HK_ELIMINATION_H
#define HK_ELIMINATION_H

#include "plugins/common/elimination/components.h"

/* A block of A: the entry-th of the row at a position of the component. */
typedef struct hk_origin {
  uint32_t position, entry; /* position UINT32_MAX: none, the block of L is fill */
} hk_origin;

typedef struct hk_elimination {
  size_t n;        /* columns of L, in the order of elimination */
  uint32_t *order; /* n: the position in the component of the row that is eliminated as j-th */
  uint32_t *start; /* n + 1: the blocks of column j are start[j]..start[j + 1], its diagonal first */
  uint32_t *row;   /* start[n]: their rows, rising */
  uint32_t
      *target; /* for every column, the blocks (row[p], row[q]) that blocks p >= q below its diagonal update, q by q */
  hk_origin *origin; /* start[n]: where A has the block */
  size_t updates;    /* entries of `target` */
  hk_status status;  /* HK_NO_MEMORY; HK_FAILED: more than `most` updates */
} hk_elimination;

/* Analyses component k. */
hk_elimination hk_elimination_find(const hk_host *, const hk_matrix *A, const hk_components *, size_t k, size_t most);
void hk_elimination_free(hk_elimination *, const hk_host *);

#endif
