/* The dense part of a supernode's factorization. */
#ifndef HK_DENSE_FRONT_H
#define HK_DENSE_FRONT_H

#include "plugins/common/supernodal/dense_path.h"

typedef struct hk_dense_front {
  const hk_host *host;
  const hk_dense_path *path;
  void *panel, *inverse; /* ld x columns, whose diagonal begins in row `top` and ends with a vector; 1/diagonal */
  void *update;          /* ldu x outer, of which nothing is read; -L L^T of the rows below the square */
  void *work;            /* hk_dense_front_work numbers */
  size_t ld, top, columns, outer, ldu;
  bool on_all_threads;
} hk_dense_front;

/* Numbers of memory that a front of so many columns and rows below them takes. */
size_t hk_dense_front_work(size_t columns, size_t outer);
/* Returns the number of columns before the first pivot that is not positive: `columns` if all are. The bits depend
 * neither on the number of threads nor, from vectors of 4 on, on their width. */
size_t hk_dense_front_factorize(const hk_dense_front *);

#endif
