/* The strain of an element: C over its rest value, as the figures of a run have it; of several numbers C the largest by
 * magnitude. */
#ifndef HK_ELEMENT_STRAIN_H
#define HK_ELEMENT_STRAIN_H

#include "core/plugin.h"

bool hk_elements_strained(const hk_elements *);                           /* whether they have strains */
double hk_element_strain(const hk_elements *, const double *x, size_t k); /* NAN: none, its rest value is 0 */

#endif
