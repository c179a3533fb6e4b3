/* Baraff and Witkin's modified conjugate gradients, for (M + h D + h^2 K) dv = b with velocities that are prescribed or
 * confined to lines and planes. */
#ifndef HK_FILTERED_GRADIENTS_H
#define HK_FILTERED_GRADIENTS_H

#include "core/plugin.h"

typedef struct hk_filtered_equations {
  const hk_host *host;
  const hk_matrix *K, *D; /* 3 x 3 blocks, symmetric, of one pattern with the whole diagonal; not filtered */
  const double *mass;     /* one a row, kg */
  double h;               /* s */
  const double *b;        /* rows x 3 */
  void (*filter)(void *context, double *vector); /* zeroes the directions that are not free */
  void *context;
} hk_filtered_equations;

enum { HK_FILTERED_WORK = 6 }; /* vectors of rows x 3 */

/* dv: on entry z, whose part in the directions that are not free is prescribed, and stays to the last bit; in the
 * others it is the first guess. It ends where the residual, in the norm of the inverse diagonal, is `tolerance` times
 * that of the right-hand side. *residual, in `work`, is then b - A dv, not filtered: what acts where directions are not
 * free, kg m/s; there a constraint pushes along it with -residual/h. HK_NOT_CONVERGED: the matrix is not positive
 * definite, or rounding allows no such residual. */
hk_status hk_filtered_gradients(const hk_filtered_equations *, double *dv, double tolerance, double *work,
                                const double **residual, int *iterations);

#endif
