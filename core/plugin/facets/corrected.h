/* Methods that keep an energy of their own near that of the scene, and what a corrector that changes the state at the
 * end of their step does to it. */
#ifndef HK_PLUGIN_CORRECTED_H
#define HK_PLUGIN_CORRECTED_H

#include "core/plugin/integrator.h"

/* J, what the energy balance needs beside the change of the scene's energy, which the host measures. */
typedef struct hk_corrected {
  double work;       /* of all that correctors did */
  double correction; /* of it what is not the power of forces: of the correction itself */
} hk_corrected;

#define HK_CORRECTED_ID "corrected/1"

typedef struct hk_corrected_facet {
  size_t size;
  /* After a step of h s that ended at `end` (size doubles), and that correctors then changed to s->X; `reset` has been
   * called. Evaluates at s->X, with which the next step begins. Required. */
  hk_status (*account)(void *self, const void *method, hk_system *s, const double *end, double h, hk_corrected *out);
} hk_corrected_facet;

#endif
