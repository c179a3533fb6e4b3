/* Vectors of SUNDIALS over memory of the state. */
#ifndef HK_SUNDIALS_VECTOR_H
#define HK_SUNDIALS_VECTOR_H

#include <nvector/nvector_serial.h>
#include <stddef.h>

/* A vector over `data` with arithmetic of its own; NULL: no memory. */
N_Vector hk_sundials_vector(size_t size, double *data, SUNContext context);

#endif
