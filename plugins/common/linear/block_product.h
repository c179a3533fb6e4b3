/* Products of sparse block matrices with vectors, on several threads, with bitwise equal results for any number of
 * threads. */
#ifndef HK_BLOCK_PRODUCT_H
#define HK_BLOCK_PRODUCT_H

#include "core/plugin.h"

/* y = A x; x and y: rows x block, without overlap. Blocks are 3 x 3 or 1 x 1. */
void hk_block_product(const hk_host *, const hk_matrix *A, const double *x, double *y);

#endif
