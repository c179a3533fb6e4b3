/* What the elements of a scene's forces say of its fastest mode, without evaluating a force: see element_bound.c. */
#ifndef HK_ELEMENT_BOUND_H
#define HK_ELEMENT_BOUND_H

#include "core/plugin.h"

typedef struct hk_element_bound {
  double stiffness; /* no w^2 of the elements is larger, 1/s^2 */
  double tension;   /* the part of it across the springs, which their damping does not reach, 1/s^2 */
  double beta;      /* least damping over stiffness, s; 0 when an element has none */
  double length;    /* m, the shortest element or edge of the scene; INFINITY: there is none longer than 0 */
} hk_element_bound;

/* x: n x 3, m; scratch: 6n doubles. */
hk_element_bound hk_element_bound_at(const hk_model *model, const double *x, double *scratch);

/* Eigenvalues of a symmetric 3x3 matrix (xx, xy, xz, yy, yz, zz), in rising order. */
void hk_symmetric_eigenvalues(const double a[6], double value[3]);

#endif
