/* Solves with a sparse Cholesky factor, P A P^T = L L^T, for several right-hand sides at once: see triangular.c. */
#ifndef HK_TRIANGULAR_H
#define HK_TRIANGULAR_H

#include "core/plugin.h"

/* A factor as its maker keeps it: supernodes are runs of columns with one list of rows, which begins with the columns
 * themselves. Entry (row[list[s] + r], first[s] + c), r >= c, is value[column[first[s] + c] + r]. */
typedef struct hk_factor_view {
  size_t n, supernodes;
  const int64_t *first;  /* supernodes + 1: columns */
  const int64_t *list;   /* supernodes: where the list of rows begins in `row` ... */
  const int64_t *rows;   /* ... and how long it is */
  const int64_t *row;    /* rising within a list */
  const int64_t *column; /* n */
  const double *value;
  const int64_t *order; /* n: row k of L is row order[k] of A; NULL: the same */
} hk_factor_view;

typedef struct hk_triangular hk_triangular;

/* Room for factors of the shape of `factor`, whose `value` may be NULL; NULL when there is no memory. */
hk_triangular *hk_triangular_create(const hk_host *host, const hk_factor_view *factor);
void hk_triangular_free(hk_triangular *, const hk_host *host);
/* Takes the numbers of a factor of that shape; they are copied. */
void hk_triangular_fill(hk_triangular *, const hk_factor_view *factor);
/* x = A^-1 b; b, x: n x columns, side by side; they may be the same. */
void hk_triangular_solve(hk_triangular *, const double *b, double *x, size_t columns);
/* Keeps to the path that runs on every processor: the same bits, slower. */
void hk_triangular_narrow(hk_triangular *);

#endif
