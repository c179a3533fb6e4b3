/* A sparse Cholesky factor, A + shift I = P^T L L^T P, by CHOLMOD, for several solvers: the graph of blocks is ordered
 * and analysed once, its values are taken and factorized as often as needed. Chen, Davis, Hager and Rajamanickam,
 * Algorithm 887: CHOLMOD, ACM TOMS 35 (2008). */
#ifndef HK_CHOLESKY_H
#define HK_CHOLESKY_H

#include "plugins/common/cholesky/block_order.h"

/* Zeroed before `open`, except for the parameters. */
typedef struct hk_cholesky {
  int ordering, threads; /* parameters: HK_ORDER_...; threads of the BLAS */
  const hk_host *host;
  cholmod_common common;
  bool started, ready;   /* ready: there is a factor */
  size_t rows, block;    /* sizes of the analysed matrix */
  double flops, entries; /* of a factorization; numbers of L */
  cholmod_sparse *A;     /* upper triangle, in scalars */
  cholmod_factor *L;
  cholmod_dense *b, *x, *y, *e; /* right-hand side, solution and CHOLMOD's workspaces */
} hk_cholesky;

hk_status hk_cholesky_open(hk_cholesky *, const hk_host *);
void hk_cholesky_close(hk_cholesky *);
hk_status hk_cholesky_analyze(hk_cholesky *, const hk_matrix *A); /* and takes its values */
hk_status hk_cholesky_take(hk_cholesky *, const hk_matrix *A);    /* copies the values; the factor stays as it is */
/* HK_NOT_CONVERGED: the matrix taken last is not positive definite with this shift; there is no factor then. */
hk_status hk_cholesky_factorize(hk_cholesky *, double shift);
hk_status hk_cholesky_solve(hk_cholesky *, const double *b, double *x); /* with the present factor */
/* |b - A x| / |b| for the matrix taken last. b is overwritten. */
double hk_cholesky_residual(const hk_cholesky *, double *b, const double *x);
void hk_cholesky_describe(char *text, size_t size);

#endif
