/* The short steps of stiff springs within a long step, on flat arrays of the particles that these springs join. */
#ifndef HK_SHORT_STEPS_H
#define HK_SHORT_STEPS_H

#include "plugins/common/local/stiff_edges.h"
#include "plugins/common/springs/spring_kernel.h"

/* Zeroed before the first use; all memory is the instance's. */
typedef struct hk_short_steps {
  size_t n;                /* particles that stiff springs join */
  uint32_t *index;         /* n, rising: their indices in the scene */
  double *inverse_mass;    /* n, 1/kg */
  double (*projector)[9];  /* n: what sliding pins leave of a vector; NULL: none slides */
  hk_spring_layout layout; /* the springs without damping, on the particles 0 to n - 1 */
  double *memory;          /* the following arrays, n x 3 each */
  double *x, *q, *change, *a, *F_start, *F;
} hk_short_steps;

/* `scratch`: n x 3 of the whole scene. After HK_NO_MEMORY it can only be freed. */
hk_status hk_short_steps_build(hk_short_steps *, hk_system *, const hk_stiff_edges *, double *scratch);
void hk_short_steps_free(hk_short_steps *, const hk_host *);

/* Turns the accelerations a (n x 3 of the scene) of all forces at x into those that a step of h is to be made with, by
 * p short steps. */
void hk_short_steps_take(hk_short_steps *, const hk_host *, const double *x, double h, int p, double *a);

#endif
