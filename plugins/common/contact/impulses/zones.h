/* Rigid impact zones (Provot 1997; Bridson, Fedkiw and Anderson 2002, section 7.3): particles whose collisions impulses
 * do not resolve move as one rigid body for a step, with the momentum and the angular momentum that they had. A zone
 * with pinned particles moves as these do. */
#ifndef HK_ZONES_H
#define HK_ZONES_H

#include "core/plugin.h"
#include "plugins/common/contact/impulses/gauss_seidel.h"

typedef struct hk_zones {
  size_t n;
  uint32_t *zone; /* n: a particle of the same zone, in the end its least one; itself: it is in none, or that one */
  uint32_t *next, *member; /* n: room */
} hk_zones;

/* HK_NO_MEMORY. */
hk_status hk_zones_open(hk_zones *, const hk_host *, size_t n);
void hk_zones_clear(hk_zones *);
/* Puts the particles of each of these pairs into one zone, with the zones that they are in. */
void hk_zones_merge(hk_zones *, const hk_contact_solver *);

typedef struct hk_zones_move {
  double h;             /* s */
  const double *mass;   /* n, kg */
  const double *x_from; /* n x 3 */
  double *x, *v;        /* n x 3, the end of the step */
  const double *inverse_mass;
} hk_zones_move;

/* Moves all zones from x_from. False: pinned particles of one zone do not move as a rigid body does. */
bool hk_zones_apply(hk_zones *, const hk_zones_move *);

#endif
