/* Incomplete Cholesky factors of a symmetric block matrix on its own pattern, as a preconditioner. */
#ifndef HK_INCOMPLETE_CHOLESKY_H
#define HK_INCOMPLETE_CHOLESKY_H

#include "core/plugin.h"

/* M = (I + W)^T D (I + W) in every domain, a range of rows; blocks between domains are dropped. */
typedef struct hk_incomplete {
  size_t rows, block;
  size_t domain, domains; /* rows in a domain */
  size_t *start;          /* rows + 1: positions in `column`; blocks right of the diagonal and within the domain */
  uint32_t *column;       /* start[rows], increasing in a row */
  uint32_t *source;       /* start[rows]: position of the block in A */
  double *work;           /* start[rows] x block x block */
  float *W;               /* start[rows] x block x block, and four more */
  double *D;              /* rows x block x block */
  double *inverse;        /* rows x block x block: inverse of D */
  double *shift;          /* domains: shift of the diagonal, relative to it; negative: no shift was sufficient */
  double *part;           /* domains */
} hk_incomplete;

hk_status hk_incomplete_analyze(hk_incomplete *, const hk_host *, const hk_matrix *A); /* HK_NO_MEMORY: to be freed */
/* Computes the factors of A, whose pattern was analysed. False: A is not positive definite, and there are no
 * factors. */
bool hk_incomplete_factorize(hk_incomplete *, const hk_host *, const hk_matrix *A);
/* z = M^-1 r; returns r.z. One number beyond z's end is read and not used; r and z must not overlap. */
double hk_incomplete_apply(const hk_incomplete *, const hk_host *, const double *r, double *z);
void hk_incomplete_free(hk_incomplete *, const hk_host *); /* a zeroed structure is allowed */

/* Inverse of a symmetric matrix of b x b, b 3 or 1, from its upper triangle. Returns b, or the first row (from 0) whose
 * pivot is not above `least` times the diagonal of `scale`. */
size_t hk_invert_definite(size_t b, const double *A, const double *scale, double least, double *inverse);

#endif
