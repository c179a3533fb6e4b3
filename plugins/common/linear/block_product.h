/* Products of sparse block matrices with vectors, on several threads, with the same bits for any number of them. */
#ifndef HK_BLOCK_PRODUCT_H
#define HK_BLOCK_PRODUCT_H

#include "core/plugin.h"

/* y = A x; x and y: rows x block, apart from each other. Blocks of 3 or 1. */
void hk_block_product(const hk_host *, const hk_matrix *A, const double *x, double *y);

#endif
