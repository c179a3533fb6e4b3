/* The sum of loads on the corners of elements, particle by particle in the order of the elements: the same bits for any
 * number of threads. */
#ifndef HK_CORNER_SUMS_H
#define HK_CORNER_SUMS_H

#include "core/plugin.h"

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_corner_sums {
  size_t *first;    /* n + 2: the corners at particle i are corner[first[i]] ... corner[first[i + 1] - 1] */
  uint32_t *corner; /* arity per tuple: arity k + m is member m of tuple k; rising for each particle */
} hk_corner_sums;

/* To be called in `create` and `topology`. HK_NO_MEMORY. */
hk_status hk_corner_sums_sort(hk_corner_sums *, const hk_host *host, size_t n, const hk_tuples *node);
/* F (n x 3) += load, N, which has a row for every corner. */
void hk_corner_sums_add(const hk_corner_sums *, const hk_host *host, size_t n, const double (*load)[3], double *F);

#endif
