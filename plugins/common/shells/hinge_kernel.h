/* Forces and blocks of many hinges, E = 1/2 k C^2 with C the angle, counted on through pi, less that at rest. */
#ifndef HK_HINGE_KERNEL_H
#define HK_HINGE_KERNEL_H

#include "plugins/common/shells/bending.h"

/* `rest`, `turned`: of all hinges of the start, rad. F += the forces of one part or of HK_ALL_PARTS, and their power to
 * view->power. */
void hk_hinge_forces(const hk_bending *, const double *rest, const double *turned, const hk_view *view, size_t part,
                     double *F);
/* -dF/dx and -dF/dv, sixteen blocks a hinge in the order of hk_bending_pattern. Without how the direction of the
 * damping turns, which is not symmetric; with HK_WANT_DEFINITE k grad C grad C^T alone. */
void hk_hinge_blocks(const hk_bending *, const double *rest, const double *turned, const hk_view *view,
                     const hk_blocks *into);
/* As hk_implicit_facet.transposed, with the parameters of the force `hinges`. */
void hk_hinge_transposed(const hk_bending *, const double *rest, const double *turned, const hk_view *view,
                         const hk_bending_params *given, const double *u, const hk_transposed *into);
/* As hk_implicit_facet.along, likewise. */
void hk_hinge_along(const hk_bending *, const double *rest, const double *turned, const hk_view *view,
                    const hk_bending_params *given, const hk_tangent *directions, size_t count);

#endif
