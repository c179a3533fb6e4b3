/* The common functions of forces made of elements: a force provides C, its gradient and its Hessian. */
#ifndef HK_ELEMENT_FORCE_H
#define HK_ELEMENT_FORCE_H

#include "core/plugin.h"

/* To be zeroed before the first use, except `acting.values`, `acting.evaluate`, `acting.self` and `hessian`. The memory
 * belongs to the instance and is released with it. */
typedef struct hk_element_force {
  hk_elements acting; /* tuples whose members are all active; the result of hk_force.elements */
  /* H = d^2 C/dx^2 of the e-th number C of tuple k: (3 arity) x (3 arity), row-major. */
  void (*hessian)(const void *self, const double *x, size_t k, unsigned e, double *H); /* NULL: C is linear in x */
} hk_element_force;

/* To be called in `create` and `topology`. Where *rest was not given it is filled with the values of `evaluate` at the
 * view's positions for rest = 0 (only for one number C per tuple). damping and rest may be NULL. HK_NO_MEMORY. */
hk_status hk_element_force_take(hk_element_force *, const hk_view *view, const hk_tuples *node,
                                const hk_per_tuple *stiffness, const hk_per_tuple *damping, hk_per_tuple *rest);
void hk_element_force_add(const hk_element_force *, const hk_view *view, double *F); /* and the power of damping */
double hk_element_force_energy(const hk_element_force *, const hk_view *view);
/* The blocks in the order of the pattern; `*next` is the number of blocks already added, so that several lists of a
 * force can follow one another. */
void hk_element_force_pattern(const hk_element_force *, hk_pattern *pattern);
void hk_element_force_jacobian(const hk_element_force *, const hk_view *view, const hk_blocks *into, size_t *next);

#endif
