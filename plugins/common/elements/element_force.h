/* What every force made of elements does alike, once it has said what C, its gradient and its Hessian are. */
#ifndef HK_ELEMENT_FORCE_H
#define HK_ELEMENT_FORCE_H

#include "core/plugin.h"

/* Zeroed before the first use, but for `acting.values`, `acting.evaluate`, `acting.self` and `hessian`. The memory is
 * the instance's and goes with it. */
typedef struct hk_element_force {
  hk_elements acting; /* tuples whose members are all active; what hk_force.elements offers */
  /* H = d^2 C/dx^2 of the number e of the tuple k: (3 arity) x (3 arity), row-major. */
  void (*hessian)(const void *self, const double *x, size_t k, unsigned e, double *H);
} hk_element_force;

/* To be called in `create` and `topology`. Where *rest was left out it is filled with what `evaluate` gives of the
 * view's positions for rest = 0 (of one number a tuple). damping and rest may be NULL. HK_NO_MEMORY. */
hk_status hk_element_force_take(hk_element_force *, const hk_view *view, const hk_tuples *node,
                                const hk_per_tuple *stiffness, const hk_per_tuple *damping, hk_per_tuple *rest);
void hk_element_force_add(const hk_element_force *, const hk_view *view, double *F); /* with its damping's power */
double hk_element_force_energy(const hk_element_force *, const hk_view *view);
/* The blocks in the order of the pattern, `*next` of them done so far: several lists of a force one after the other. */
void hk_element_force_pattern(const hk_element_force *, hk_pattern *pattern);
void hk_element_force_jacobian(const hk_element_force *, const hk_view *view, const hk_blocks *into, size_t *next);

#endif
