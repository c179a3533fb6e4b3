/* Solves with a sparse Cholesky factor, P A P^T = L L^T, for several right-hand sides at once: see triangular.c. */
#ifndef HK_TRIANGULAR_H
#define HK_TRIANGULAR_H

#include "core/plugin.h"

/* A factor in the storage of CHOLMOD: supernodes are runs of columns with a common list of rows, which begins with the
 * columns themselves. Entry (row[list[s] + r], first[s] + c), r >= c, is value[column[first[s] + c] + r]. */
typedef struct hk_factor_view {
  size_t n, supernodes;
  const int64_t *first;  /* supernodes + 1: columns */
  const int64_t *list;   /* supernodes: first position of the list of rows in `row` ... */
  const int64_t *rows;   /* ... and its length */
  const int64_t *row;    /* increasing within a list */
  const int64_t *column; /* n */
  const double *value;
  const int64_t *order; /* n: row k of L is row order[k] of A; NULL: the identity */
} hk_factor_view;

typedef struct hk_triangular hk_triangular;

/* Allocates memory for factors of the shape of `factor`, whose `value` may be NULL. NULL: no memory. */
hk_triangular *hk_triangular_create(const hk_host *host, const hk_factor_view *factor);
void hk_triangular_free(hk_triangular *, const hk_host *host);
/* Copies the values of a factor of that shape. */
void hk_triangular_fill(hk_triangular *, const hk_factor_view *factor);
/* x = A^-1 b; b, x: n x columns, row-major; they may be the same array. */
void hk_triangular_solve(hk_triangular *, const double *b, double *x, size_t columns);

#endif
