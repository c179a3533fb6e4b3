/* M + sum over edges e = (i, j) of w_e (e_i - e_j)(e_i - e_j)^T: the n x n matrix that acts on each coordinate alike.
 */
#ifndef HK_LAPLACIAN_H
#define HK_LAPLACIAN_H

#include "core/plugin.h"

/* Zeroed before the first use. */
typedef struct hk_laplacian {
  hk_matrix matrix;             /* block 1, symmetric, the whole diagonal in its pattern */
  size_t *row_start, *diagonal; /* the matrix's; n: where the diagonal entry is */
  uint32_t *column;
  size_t edges, (*slot)[2]; /* edges: where (i, j) and (j, i) are */
  uint32_t (*pair)[2];      /* edges */
} hk_laplacian;

/* The pattern, for edges between different particles; several edges of one pair share their entries. What was there is
 * released first. After HK_NO_MEMORY it can only be released. */
hk_status hk_laplacian_build(hk_laplacian *, const hk_host *host, size_t n, size_t edges, const uint32_t (*pair)[2]);
void hk_laplacian_release(hk_laplacian *, const hk_host *host);
/* The numbers. Rows and columns of particles with inverse mass 0 become those of the identity. */
void hk_laplacian_fill(hk_laplacian *, const double *mass, const double *inverse_mass, const double *weight);

#endif
