/* Which bodies of a scene go round a heavy one, by the accelerations that they feel relative to it: what all feel
 * alike, as a uniform field, changes no orbit. */
#ifndef HK_FELT_GRAVITY_H
#define HK_FELT_GRAVITY_H

#include "core/plugin.h"

typedef struct hk_felt_gravity {
  double G;      /* m^3/(kg s^2), the constant that explains the accelerations best */
  double off;    /* what it leaves of them, relative: root of the mean square over bodies; 1: it explains nothing */
  size_t bodies; /* that move freely */
  double others; /* their masses over that of the heaviest, without it */
} hk_felt_gravity;

/* x, a: n x 3, m and m/s^2. Fills `order` (room for n) with the bodies, the heaviest first, then by their distances
 * from it. Looks at some hundred bodies. False: no memory. */
bool hk_felt_gravity_find(const hk_host *, const hk_model *, const double *x, const double *a, uint32_t *order,
                          hk_felt_gravity *);

#endif
