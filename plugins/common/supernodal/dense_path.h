/* The dense loops of the supernodal factorization, by the width of vectors, for doubles and for floats.
 *
 * Matrices are stored by columns, `ld` numbers from one to the next, in whole vectors of 64 bytes. What lies above the
 * diagonal is never read as part of a result, but may be written. Every number of a result is the sum of its products
 * in their order, whatever the vectors and tiles, so all processors with fused multiply-add give the same bits. */
#ifndef HK_DENSE_PATH_H
#define HK_DENSE_PATH_H

#include "plugins/common/supernodal/supernodes.h"

/* Columns of a front that are worked on together, at most, and rows of a chunk: multiples of the widths of all tiles,
 * the rows a multiple of three times the tallest. Strips of 12 such columns are 18 kB, which stay in the first cache
 * while a chunk of rows, 300 kB, in the second, goes past. */
enum { HK_FRONT_DEPTH = 192, HK_FRONT_ROWS = 192 };

/* Some columns of a front, right-looking: the square on the diagonal, the rows below it, and what these take from the
 * rest of the front, which is `inner` further columns of the panel and the update. Rows and columns of the rest count
 * from row `begin` of the panel, where the square ends with a vector. */
typedef struct hk_front_block {
  void *panel;   /* its first column, of `ld` numbers; the diagonal begins in row `top` */
  void *inverse; /* columns: 1/diagonal */
  size_t ld, top;
  size_t columns;      /* up to HK_FRONT_DEPTH */
  size_t begin, rows;  /* below the square: whole vectors, `begin` is top + columns */
  size_t inner, outer; /* columns of the rest in the panel, and in the update */
  void *update;        /* outer columns of ldu numbers; its rows are those of the rest from row `inner` on */
  size_t ldu;
  bool first;           /* the update is not there yet */
  void *square, *A, *B; /* strips of the square, HK_FRONT_DEPTH squared numbers; of rows and columns of the rest */
} hk_front_block;

typedef struct hk_dense_path {
  const char *name;
  size_t number; /* bytes: of a double or a float */
  /* Cholesky's factorization of the square. Returns the number of columns before the first pivot that is not positive:
   * `columns` if all are. */
  size_t (*factorize)(const hk_front_block *);
  /* Rows [begin, end) below it, divided by the square's transpose, also into A. Of these and of `update`, begin and end
   * are multiples of a third of HK_FRONT_ROWS or the end. */
  void (*solve_rows)(const hk_front_block *, size_t begin, size_t end);
  /* Rows [begin, end) into B, as columns of the rest; begin is a multiple of HK_FRONT_ROWS. */
  void (*pack_columns)(const hk_front_block *, size_t begin, size_t end);
  /* Takes A B^T from rows [begin, end) of the rest, on and below the diagonal. */
  void (*update)(const hk_front_block *, size_t begin, size_t end);
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
