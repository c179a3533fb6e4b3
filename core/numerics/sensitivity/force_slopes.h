/* What an adjoint sums over the steps: derivatives by the masses and by the parameters of forces, however many numbers
 * these are. A scene's parameters are functions of them, so their derivatives follow at the end, by the chain rule:
 * their number costs no evaluations. Forces without `transposed` (facets/implicit.h), and those whose parameters are
 * functions of time, are compared between two runs at every evaluation instead. */
#ifndef HK_FORCE_SLOPES_H
#define HK_FORCE_SLOPES_H

#include "core/numerics/sensitivity/sensitivity.h"

struct hk_force_slopes {
  bool any, all;   /* some force is covered; every one is */
  bool *covers;    /* one per force */
  double ***force; /* per force and row of its parameters; NULL: not covered, or no numbers */
  double *mass;    /* n */
};

hk_status hk_force_slopes_open(hk_force_slopes *, const hk_dynamics *);
void hk_force_slopes_close(hk_force_slopes *, const hk_dynamics *);
/* Whether the parameter changes numbers of these forces alone, as the chain rule needs it: not which particles they act
 * on, not what joins them, and not masses where other forces than these act on them. */
bool hk_force_slopes_fit(const hk_force_slopes *, const hk_dynamics *, const hk_varied *);
double hk_force_slopes_by(const hk_force_slopes *, const hk_dynamics *, const hk_varied *);
/* Which forces are the same at the same x and v whatever the parameter is; whether all are, and no pin has to be looked
 * at: the parameter then changes nothing but the start. */
bool hk_force_slopes_unmoved(const hk_force_slopes *, const hk_varied *, bool *unmoved);
/* Whether the comparison of runs has to see that the parameter does not change the path of a pin. */
bool hk_varied_moves_pins(const hk_varied *);

#endif
