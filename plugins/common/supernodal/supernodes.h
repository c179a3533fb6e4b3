/* Supernodes of a sparse block matrix: runs of columns of its Cholesky factor with a common list of rows, which form a
 * tree, the sums that each passes on to its parent, and where all of it lies in memory. Analysed once for a pattern.
 * Ashcraft and Grimes, ACM TOMS 15 (1989); the multifrontal method: Duff and Reid, ACM TOMS 9 (1983); Liu, SIAM Review
 * 34 (1992). */
#ifndef HK_SUPERNODES_H
#define HK_SUPERNODES_H

#include "core/plugin.h"

#include <cholmod.h>

/* Rows and columns are counted in blocks; positions, ld, ldu and top in numbers. */
typedef struct hk_supernode {
  uint32_t first, columns; /* of the factor */
  uint32_t rows;           /* below the columns: row[list ...] */
  uint32_t parent;         /* HK_NO_PARENT: a root */
  size_t list;             /* into row */
  size_t panel, ld, top;   /* the columns in L, as dense_path.h has them */
  size_t update, ldu;      /* rows x rows, what the parent adds; ldu is 0 where there are no rows */
  size_t run, run_end;     /* into run: where its rows are in its parent's front */
  size_t entry, entry_end; /* into entry: the blocks of A in its columns */
  size_t child, child_end; /* into child: those whose parent it is, in their order */
} hk_supernode;

#define HK_NO_PARENT UINT32_MAX
enum { HK_FRONT_VECTOR = 64 }; /* bytes; begins of matrices and lengths of their columns are multiples of it */

typedef struct hk_row_run { /* rows that follow each other in both fronts; `to` counts from the parent's first column */
  uint32_t from, to, count;
} hk_row_run;

typedef struct hk_entry {
  size_t block; /* of A */
  size_t to;    /* from the panel's begin */
} hk_entry;

/* A subtree, or the last one, what is above all subtrees: supernodes [begin, end) in the order of the factorization. */
typedef struct hk_branch {
  uint32_t begin, end;
} hk_branch;

typedef struct hk_supernodes {
  size_t rows, block;
  size_t count, branches; /* the last branch is that of the top */
  hk_supernode *node;     /* count; children before parents */
  hk_branch *branch;      /* branches */
  uint32_t *top;          /* supernodes of the last branch, whose range counts in this list */
  uint32_t *order;        /* rows: row k of the factor is row order[k] of A */
  uint32_t *row;
  uint32_t *child;
  hk_row_run *run;
  hk_entry *entry;
  size_t L_size, update_size, front; /* numbers of L, of all updates; most rows of a panel */
  double flops, entries;             /* of a factorization; numbers of L */
} hk_supernodes;

/* `number`: bytes of a number. HK_NO_MEMORY or HK_FAILED with a message; what there is has to be freed. */
hk_status hk_supernodes_analyze(hk_supernodes *, const hk_host *, cholmod_common *, const hk_matrix *A, int ordering,
                                size_t number);
void hk_supernodes_free(hk_supernodes *, const hk_host *); /* a zeroed structure is allowed */

#endif
