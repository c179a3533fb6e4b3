/* Coulomb friction of a barrier's contacts, smoothed and lagged (Li and others 2020, Incremental Potential Contact,
 * section 5): with the normal n, the weights w of the nearest points and the normal force l of the last accepted step,
 * and u = sum_i w_i v_i less its part along n,
 *     F_i = -w_i mu l f(|u|/e) u/|u|,   f(y) = 2y - y^2 below 1, 1 above.
 * So it depends on velocities alone, and its blocks are symmetric and definite. */
#ifndef HK_BARRIER_FRICTION_H
#define HK_BARRIER_FRICTION_H

#include "plugins/common/contact/barrier/barrier_contacts.h"

typedef struct hk_barrier_touch {
  hk_feature_pair pair;
  uint32_t id[4]; /* of the particles */
  hk_pair_frame frame;
  double load;   /* l, N */
  uint32_t name; /* as that of hk_barrier_pair */
} hk_barrier_touch;

typedef struct hk_barrier_friction {
  double coefficient, speed; /* mu; e, m/s */
  hk_array touches;          /* hk_barrier_touch, rising: field */
  hk_array pairs;            /* hk_feature_pair, of the touches; scratch */
} hk_barrier_friction;

double hk_friction_add(const hk_barrier_friction *, const double *v, double *F); /* returns the power, W */
double hk_friction_power(const hk_barrier_friction *, const double *v);          /* W */
void hk_friction_damping(const hk_barrier_friction *, const double *v, const hk_blocks *into);
/* Takes over the contacts of an accepted step. HK_NO_MEMORY. */
hk_status hk_friction_take(hk_barrier_friction *, hk_barrier_contacts *, const hk_view *view);
/* After births and deaths: drops the contacts of the dead and finds the indices of the others. HK_NO_MEMORY. */
hk_status hk_friction_renumber(hk_barrier_friction *, const hk_view *view);
/* Before hk_barrier_find: lists the pairs of the touches. After it: tells them their names. */
hk_status hk_friction_list(hk_barrier_friction *, const hk_host *);
void hk_friction_update_names(hk_barrier_friction *, const hk_barrier_contacts *);

#endif
