/* Methods that know what of the energy of a step that correctors ended is the correction's work, and what their own
 * error. Of others it is the change of the scene's energy by the correction. */
#ifndef HK_PLUGIN_CORRECTED_H
#define HK_PLUGIN_CORRECTED_H

#include "core/plugin/integrator.h"

/* J, for the energy balance of a step that correctors ended. */
typedef struct hk_corrected {
  double work; /* of pins, forces without a potential and the correction, beyond what the step had counted by its own
                  end; NAN: not known */
  double correction; /* of the correction */
} hk_corrected;

#define HK_CORRECTED_ID "corrected/2"

typedef struct hk_corrected_facet {
  size_t size;
  /* After a step of h s that ended at `end` (size doubles), and that correctors then changed to s->X; `reset` has been
   * called. Evaluates at s->X, with which the next step begins. Required. */
  hk_status (*account)(void *self, const void *method, hk_system *s, const double *end, double h, hk_corrected *out);
} hk_corrected_facet;

#endif
