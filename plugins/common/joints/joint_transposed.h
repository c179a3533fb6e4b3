/* Products of many joints with a vector, for adjoints. */
#ifndef HK_JOINT_TRANSPOSED_H
#define HK_JOINT_TRANSPOSED_H

#include "core/plugin.h"

/* The derivatives of u.F by k, c and the angle at rest of the next joint, N m/(N m/rad) and so on. */
typedef void hk_joint_slopes(void *context, double by_k, double by_c, double by_rest);

/* Adds (dF/dx)^T u and (dF/dv)^T u of joints with k, c and angles at rest each; plane: as in hk_joint_measure. slopes:
 * called for every joint in their order; NULL: not wanted. */
void hk_joint_transposed(const hk_elements *, const hk_view *view, const double plane[3], const double *u, double *by_x,
                         double *by_v, hk_joint_slopes *slopes, void *context);

#endif
