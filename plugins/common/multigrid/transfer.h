/* Prolongations of smoothed aggregation: aggregates of a matrix's rows, and P = (I - w D^-1 A) T, where T spreads the
 * block of an aggregate to its rows. Vanek, Mandel and Brezina, Computing 56 (1996). */
#ifndef HK_TRANSFER_H
#define HK_TRANSFER_H

#include "core/plugin.h"

typedef struct hk_transfer {
  size_t rows, columns, block;
  size_t *start;      /* rows + 1 */
  uint32_t *column;   /* start[rows], rising in a row */
  double *value;      /* start[rows] x block x block */
  size_t *back_start; /* columns + 1: its transpose, by positions in `value` */
  uint32_t *back_row; /* start[rows], rising in a column */
  uint32_t *back_entry;
} hk_transfer;

/* aggregate[r]: that of row r, from 0, or UINT32_MAX where a row is joined to no other; returns their number. Rows are
 * joined where |A_ij|^2 > strength^2 |A_ii| |A_jj| (Frobenius). Depends on A alone. work: rows. */
size_t hk_aggregate(const hk_matrix *A, double strength, uint32_t *aggregate, double *work);
/* inverse: of the diagonal blocks. HK_NO_MEMORY: to be freed. What there was is released first. */
hk_status hk_transfer_build(hk_transfer *, const hk_host *, const hk_matrix *A, const double *inverse, double w,
                            const uint32_t *aggregate, size_t aggregates);
void hk_transfer_free(hk_transfer *, const hk_host *); /* a zeroed structure is allowed */

void hk_transfer_restrict(const hk_transfer *, const hk_host *, const double *fine, double *coarse); /* P^T fine */
void hk_transfer_prolong(const hk_transfer *, const hk_host *, const double *coarse, double *fine);  /* fine += P .. */

/* P^T A P. Its arrays are one allocation each, of the host. HK_NO_MEMORY: to be freed. */
hk_status hk_transfer_galerkin(const hk_transfer *, const hk_host *, const hk_matrix *A, hk_matrix *coarse);
void hk_coarse_free(hk_matrix *coarse, const hk_host *);

#endif
