/* The Cholesky factor of a sparse symmetric block matrix, P A P^T = L L^T, in doubles or floats, by the multifrontal
 * method: see supernodal.c. */
#ifndef HK_SUPERNODAL_H
#define HK_SUPERNODAL_H

#include "plugins/common/linear/triangular.h"
#include "plugins/common/supernodal/dense_front.h"
#include "plugins/common/supernodal/supernodes.h"

#include <stdatomic.h>

/* Zeroed before `open`. */
typedef struct hk_supernodal {
  const hk_host *host;
  const hk_dense_path *path;
  cholmod_common common;
  bool started, ready; /* ready: there is a factor */
  hk_supernodes nodes;
  void *L, *inverse;  /* panels; reciprocals of the diagonal */
  void *update;       /* sums that supernodes pass on */
  void *vector;       /* a right-hand side in the order of the factor, for every branch */
  void *front;        /* a front's part of it, for every branch */
  void *work;         /* of fronts, for every branch ... */
  size_t *work_at;    /* branches: ... where its own begins */
  size_t *bad;        /* branches: the row whose pivot was not positive, or SIZE_MAX */
  size_t *turn;       /* branches: the order in which they are factorized; the top is the last */
  atomic_size_t stop; /* the first turn at which a pivot was not positive; those after it need no factors */
  size_t stride, front_stride;
  const double *value;    /* of the matrix that is being factorized */
  hk_triangular *columns; /* L for several right-hand sides; NULL until there are some */
  bool copied;            /* `columns` has the numbers of the factor */
} hk_supernodal;

hk_status hk_supernodal_open(hk_supernodal *, const hk_host *, bool single);
bool hk_supernodal_is_single(const hk_supernodal *);
void hk_supernodal_close(hk_supernodal *);
hk_status hk_supernodal_analyze(hk_supernodal *, const hk_matrix *A, int ordering);
/* HK_NOT_CONVERGED: the matrix is not positive definite, and there is no factor. */
hk_status hk_supernodal_factorize(hk_supernodal *, const hk_matrix *A);
/* x = A^-1 b with the present factor; b and x may be the same array. */
void hk_supernodal_solve(hk_supernodal *, const double *b, double *x);
/* The same for several right-hand sides, rows x columns, of a factor in doubles, by plugins/common/linear/triangular.h,
 * which copies L at the first such call after a factorization. HK_NO_MEMORY. */
hk_status hk_supernodal_solve_columns(hk_supernodal *, const double *b, double *x, size_t columns);

#endif
