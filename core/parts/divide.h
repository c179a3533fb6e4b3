/* Forces become accelerations. */
#ifndef HK_PARTS_DIVIDE_H
#define HK_PARTS_DIVIDE_H

#include <stdbool.h>
#include <stddef.h>

/* F *= inverse for the particles begin to end - 1; whether all F were finite. inverse: n, 1/kg. */
bool hk_part_divide(const double *inverse, double *F, size_t begin, size_t end);

#endif
