/* The choice of the barrier's pressure, and what accepted steps tell of its contacts. */
#ifndef HK_BARRIER_CHOICE_H
#define HK_BARRIER_CHOICE_H

#include "plugins/common/contact/barrier/barrier_contacts.h"

/* Of one state. */
typedef struct hk_barrier_survey {
  double closest;  /* m, least gap; INFINITY: no pair is near */
  double approach; /* m/s, fastest approach of a pair that may act on the move */
  double load;     /* N, sum of the normal forces */
  double energy;   /* J */
} hk_barrier_survey;

hk_barrier_survey hk_barrier_survey_at(hk_barrier_contacts *, const hk_view *view);

/* kg/m^2, mass of the surfaces' particles that can move by the area they stand for; 0: there are none. */
double hk_barrier_density(const hk_barrier_contacts *, const hk_view *view);

/* Pa. A sheet of density s that rests on another one loads the barrier with s g, and one that comes at the speed v
 * brings the energy s v^2/2 per area: the pressure is chosen so that the barrier carries a hundred times its own
 * weight, and stops the approach while a third of its distance is left (b(1/3) = 0.49). It only rises, to twice what
 * it was at least, and between steps. */
double hk_barrier_chosen(double density, double distance, double approach, double before);

#endif
