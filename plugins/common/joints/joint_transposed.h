/* Products of many joints with a vector, for adjoints, and their changes along directions, for tangents. */
#ifndef HK_JOINT_TRANSPOSED_H
#define HK_JOINT_TRANSPOSED_H

#include "core/plugin.h"

/* The derivatives of u.F by k, c and the angle at rest of the next joint, N m/(N m/rad) and so on. */
typedef void hk_joint_slopes(void *context, double by_k, double by_c, double by_rest);

/* Adds (dF/dx)^T u and (dF/dv)^T u of joints with k, c and angles at rest each; plane: as in hk_joint_measure. slopes:
 * called for every joint in their order; NULL: not wanted. */
void hk_joint_transposed(const hk_elements *, const hk_view *view, const double plane[3], const double *u, double *by_x,
                         double *by_v, hk_joint_slopes *slopes, void *context);

static inline bool hk_joint_acts(const hk_view *view, const uint32_t *node) {
  return !view->is_active || (view->is_active[node[0]] && view->is_active[node[1]] && view->is_active[node[2]]);
}

/* Rows of the force's parameters, by which hk_tangent.parameter has the changes of every joint of `all`. */
typedef struct hk_joint_rows {
  size_t k, c, rest;
} hk_joint_rows;

/* As hk_implicit_facet.along; the elements are those of `all` that act, in their order. */
void hk_joint_along(const hk_elements *, const hk_view *view, const double plane[3], const hk_tuples *all,
                    const hk_joint_rows *, const hk_tangent *directions, size_t count);

#endif
