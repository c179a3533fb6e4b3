/* The growth of a method's step on a linear problem: the matrix of what a step hands on, read off column by column by
 * driving the plugin, and its spectral radius. */
#ifndef HK_TEST_STEP_MATRIX_H
#define HK_TEST_STEP_MATRIX_H

#include "tests/support/fake_system.h"

/* The largest growth factor of a step of 1 s on all that the motion from the present state reaches. */
double step_growth(fake_method *);
/* Whether that factor is above `bound`; stops as soon as this is certain. */
bool step_growth_exceeds(fake_method *, double bound);

#endif
