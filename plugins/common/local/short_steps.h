/* The short steps of stiff springs within a long step, on flat arrays of the particles that these springs join. */
#ifndef HK_SHORT_STEPS_H
#define HK_SHORT_STEPS_H

#include "plugins/common/local/local_filter.h"
#include "plugins/common/local/stiff_edges.h"
#include "plugins/common/springs/spring_kernel.h"

enum { HK_SHORT_PARTS = 48 };

/* Springs that take the same number of short steps, with no particle in common with those of other parts. */
typedef struct hk_short_part {
  size_t begin, n; /* its particles in the arrays */
  hk_local_modes modes;
  hk_spring_layout layout; /* without damping, on the particles 0 to n - 1 of the part */
} hk_short_part;

/* Zeroed before the first use; all memory is the instance's. */
typedef struct hk_short_steps {
  size_t parts, n; /* n: particles that stiff springs join */
  hk_short_part part[HK_SHORT_PARTS];
  uint32_t *index;                           /* n: their indices in the scene */
  double (*projector)[9];                    /* n: what sliding pins leave of a vector; NULL: none slides */
  double *inverse_mass, *q, *change, *a, *F; /* n x 3 each, in one allocation; 1/kg three times */
} hk_short_steps;

/* `scratch`: n x 3 of the whole scene. After HK_NO_MEMORY it can only be freed. */
hk_status hk_short_steps_build(hk_short_steps *, hk_system *, const hk_stiff_edges *, double *scratch);
void hk_short_steps_free(hk_short_steps *, const hk_host *);

/* Turns the accelerations a (n x 3 of the scene) of all forces at x into those that a step of h is to be made with. */
void hk_short_steps_take(hk_short_steps *, const hk_host *, const double *x, double h, double *a);

#endif
