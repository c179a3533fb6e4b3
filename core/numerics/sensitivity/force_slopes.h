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

/* How what forces and masses are changes with a parameter of the scene, for tangents: the directions of hk_tangent. Its
 * numbers follow each other in `memory`. */
struct hk_force_changes {
  const double ***force; /* per force and row of its parameters; NULL: not covered; of a row: it does not change */
  double *mass;          /* n; NULL: masses do not change */
  double *memory;
};

/* Of forces with `transposed`; or, where `exact` says of each whether its Jacobian is, of exact ones with `along`
 * (facets/implicit.h). */
hk_status hk_force_slopes_open(hk_force_slopes *, const hk_dynamics *, const bool *exact);
void hk_force_slopes_close(hk_force_slopes *, const hk_dynamics *);
/* Whether the parameter changes numbers of these forces alone, as the chain rule needs it: not which particles they act
 * on, not what joins them, and not masses where other forces than these act on them. */
bool hk_force_slopes_fit(const hk_force_slopes *, const hk_dynamics *, const hk_varied *);
/* Of a parameter that fits. */
hk_status hk_force_changes_open(hk_force_changes *, const hk_force_slopes *, const hk_dynamics *, const hk_varied *);
void hk_force_changes_close(hk_force_changes *, const hk_dynamics *);
double hk_force_slopes_by(const hk_force_slopes *, const hk_dynamics *, const hk_varied *);
/* Which forces are the same at the same x and v whatever the parameter is; whether all are, and no pin has to be looked
 * at: the parameter then changes nothing but the start. */
bool hk_force_slopes_unmoved(const hk_force_slopes *, const hk_varied *, bool *unmoved);
/* Whether the comparison of runs has to see that the parameter does not change the path of a pin. */
bool hk_varied_moves_pins(const hk_varied *);

/* ---- tangent.c ---- */

/* How derivatives forwards take parameters, one after the other. */
typedef struct hk_changes_plan {
  size_t count, forces;
  /* The forces that are not compared between a parameter's runs, as it does not change them or its changes have them,
   * `forces` for each parameter; whether none is compared. */
  bool *unmoved, *none;
  hk_force_changes *changes;
  double *still, *along; /* 6n, which are 0, and 3n */
} hk_changes_plan;

hk_status hk_changes_plan_open(hk_changes_plan *, const hk_sensitivity *, const hk_varied *, size_t count);
/* own = da/dp of parameter j, 3n, at a point. */
hk_status hk_changes_plan_slope(const hk_changes_plan *, hk_sensitivity *, const hk_stage_point *, const hk_varied *,
                                size_t j, double *own);
void hk_changes_plan_close(hk_changes_plan *, const hk_sensitivity *);

#endif
