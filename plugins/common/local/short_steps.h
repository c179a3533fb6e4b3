/* The short steps of stiff springs within a long step, on flat arrays of the particles that these springs join. */
#ifndef HK_SHORT_STEPS_H
#define HK_SHORT_STEPS_H

#include "plugins/common/local/short_lanes.h"
#include "plugins/kit/springs/spring_layout.h"

enum { HK_SHORT_PARTS = 48 };

/* Springs that take about the same number of short steps, with no particle in common with those of other parts. */
typedef struct hk_short_part {
  hk_local_modes modes;    /* of all its springs */
  size_t begin, n;         /* the particles of its large components in the arrays */
  double stiffest;         /* 1/s^2, of these */
  hk_spring_layout layout; /* of these, without damping, on the particles 0 to n - 1 of the part */
} hk_short_part;

/* Zeroed before the first use; all memory is the instance's. */
typedef struct hk_short_steps {
  hk_short_lanes lanes; /* the small components */
  double shift;         /* s of local_filter.h */
  size_t parts, n;      /* n: particles of large components, in the arrays */
  hk_short_part part[HK_SHORT_PARTS];
  uint32_t *index;                               /* n: their indices in the scene */
  double (*projector)[9];                        /* n: what sliding pins leave of a vector; NULL: none slides */
  double *inverse_mass, *x, *d, *change, *a, *F; /* n x 3 each, in one allocation; 1/kg three times */
  double *q;                                     /* n x 3, x + d */
} hk_short_steps;

/* `scratch`: n x 3 of the whole scene. After HK_NO_MEMORY it can only be freed. */
hk_status hk_short_steps_build(hk_short_steps *, hk_system *, const hk_stiff_edges *, double *scratch);
void hk_short_steps_free(hk_short_steps *, const hk_host *);

/* Turns the accelerations a (n x 3 of the scene) of all forces at x into those that a step of h is to be made with, and
 * adds h/2 times their change to v (NULL: none). */
void hk_short_steps_take(hk_short_steps *, const hk_host *, const double *x, double h, double *a, double *v);

#endif
