/* The dense loops of the supernodal factorization, by the width of vectors, for doubles and for floats.
 *
 * Matrices are stored by columns, `ld` numbers from one to the next, in whole vectors of 64 bytes. What lies above the
 * diagonal is never read as part of a result, but may be written. Every number of a result is the sum of its products
 * in their order, whatever the vectors and tiles, so all processors with fused multiply-add give the same bits. */
#ifndef HK_DENSE_PATH_H
#define HK_DENSE_PATH_H

#include "plugins/common/supernodal/supernodes.h"

typedef struct hk_dense_path {
  const char *name;
  size_t number; /* bytes: of a double or a float */
  /* Cholesky's factorization of the square of the panel's `columns` columns, whose diagonal begins in row `top` and
   * ends with a vector. 1/diagonal goes to `inverse`. Returns the number of columns before the first pivot that is not
   * positive: `columns` if all are. */
  size_t (*factorize)(void *panel, size_t ld, size_t top, size_t columns, void *inverse);
  /* Rows [begin, end) below it, whole vectors, divided by the square's transpose. */
  void (*solve_rows)(void *panel, size_t ld, size_t top, size_t columns, const void *inverse, size_t begin, size_t end);
  /* Columns [begin, end) of U = -L L^T, on and below the diagonal. U has `ldu` rows, as L, whose columns have `ld`. */
  void (*update)(void *U, size_t ldu, size_t begin, size_t end, const void *L, size_t ld, size_t columns);
  /* A supernode's panel with the blocks of A, and what a child's update adds to it and to the update. */
  void (*begin)(const hk_supernodes *, const hk_supernode *, const double *value, void *panel);
  void (*extend_panel)(const hk_supernodes *, const hk_supernode *child, const void *from, const hk_supernode *,
                       void *panel);
  void (*extend_update)(const hk_supernodes *, const hk_supernode *child, const void *from, const hk_supernode *,
                        void *update);
  /* A supernode's columns of a vector in the order of the factor: taken from b, in the order of A, times `scale`, and
   * given to x times `scale`. */
  void (*load)(const hk_supernodes *, const hk_supernode *, const double *b, double scale, void *vector);
  void (*store)(const hk_supernodes *, const hk_supernode *, const void *vector, double scale, double *x);
  /* The part of a supernode in L^-1 and in L^-T. `front` has room for a column of its panel. */
  void (*forward)(const hk_supernodes *, const hk_supernode *, const void *panel, const void *inverse, void *vector,
                  void *front);
  void (*backward)(const hk_supernodes *, const hk_supernode *, const void *panel, const void *inverse, void *vector,
                   void *front);
  /* Adds the rows below the columns to another vector and zeroes them here. */
  void (*pass_on)(const hk_supernodes *, const hk_supernode *, void *from, void *to);
} hk_dense_path;

const hk_dense_path *hk_dense_double(int lanes); /* hk_host.lanes */
const hk_dense_path *hk_dense_single(int lanes); /* for floats */

#endif
