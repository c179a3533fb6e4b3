/* The arms of friction: a round side of an impact is rubbed at its surface, a radius away from where its place is. */
#ifndef HK_BODY_ARMS_H
#define HK_BODY_ARMS_H

#include "core/plugin.h"

/* Of one side of an impact. */
typedef struct hk_body_arm {
  const uint32_t *carrier; /* 4 of a rigid body; NULL: it is rubbed at its place */
  double radius;           /* m */
  double weight[4];        /* of the carriers, with the sum 0: the vector -radius n, turned with the body */
} hk_body_arm;

typedef struct hk_body_arms {
  hk_body_arm side[2]; /* the impact's n is from the second to the first */
} hk_body_arms;

/* The carriers that all of `count` particles have in common, of a body that turns about every axis; NULL: none. Those
 * of weight 0 do not count. */
const uint32_t *hk_body_arm_carriers(const hk_model *, const uint32_t *particle, const double *weight, int count);
/* Sets the weights where the particles are at x (n x 3) and the normal is n. */
void hk_body_arms_set(hk_body_arms *, const double *x, const double n[3]);
/* out += what the arms add to the difference of both sides, across n: of y = x or v, n x 3. */
void hk_body_arms_add(const hk_body_arms *, const double *y, const double n[3], double out[3]);
/* Returns the volume; across[c]/volume are the reciprocal vectors of x_c - x_0, c from 1. */
double hk_body_arms_reciprocal(const uint32_t *carrier, const double *x, double across[3][3]);
/* rad/s: the spin of the body whose carriers are at x with v (n x 3). */
void hk_body_spin(const uint32_t *carrier, const double *x, const double *v, double out[3]);
/* v of the four carriers (n x 3) at x: the motion of the body that moved with v_from at x_from. */
void hk_body_arms_carry(const uint32_t *carrier, const double *x_from, const double *v_from, const double *x,
                        double *v);
/* G += the part across n of the 3 x 3 matrix `sum`, by rows. */
void hk_body_arms_across(const double sum[9], const double n[3], double G[9]);
/* Of a point of a flat body or a rod with a radius that shows, which is its own or the one given (m): it has no extent
 * to turn it about. */
void hk_body_warn_of_arms(const hk_host *, const hk_view *, double radius);
static inline bool hk_body_arms_any(const hk_body_arms *a) { return a->side[0].carrier || a->side[1].carrier; }

#endif
