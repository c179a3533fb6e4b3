/* The fill-reducing order of a block matrix, by AMD or METIS through CHOLMOD. The graph of blocks is ordered, which
 * keeps the unknowns of a particle together and is block^2 times smaller. */
#ifndef HK_BLOCK_ORDER_H
#define HK_BLOCK_ORDER_H

#include "core/plugin.h"

#include <cholmod.h>

enum { HK_ORDER_BEST, HK_ORDER_AMD, HK_ORDER_METIS };

/* The symbolic factor of the graph of A's blocks up to the diagonal, in the order HK_ORDER_...; best: AMD, or METIS
 * where the factorization is long and METIS makes it shorter. NULL: common->status says why. */
cholmod_factor *hk_block_order(cholmod_common *, const hk_matrix *A, int ordering);

/* Blocks up to the diagonal in block row r. */
size_t hk_upper_blocks(const hk_matrix *A, size_t r);

#endif
