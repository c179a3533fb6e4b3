/* Vectors of SUNDIALS over memory of the state. */
#ifndef HK_SUNDIALS_VECTOR_H
#define HK_SUNDIALS_VECTOR_H

#include <nvector/nvector_serial.h>
#include <stdbool.h>
#include <stddef.h>

/* A vector over `data` with arithmetic of its own; NULL: no memory. It is destroyed after all its clones. */
N_Vector hk_sundials_vector(size_t size, double *data, SUNContext context);
bool hk_sundials_vector_failed(N_Vector); /* there was no memory for a clone: what has clones of it must not be used */

#endif
