/* Methods that keep an energy of their own near that of the scene, and what a corrector that changes the state at the
 * end of their step does to it. */
#ifndef HK_PLUGIN_CORRECTED_H
#define HK_PLUGIN_CORRECTED_H

#include "core/plugin/integrator.h"

#define HK_CORRECTED_ID "corrected/2"

typedef struct hk_corrected_facet {
  size_t size;
  /* After a step of h s that ended at `end` (size doubles), and that correctors then changed to s->X; `reset` has been
   * called. *strayed, J: by how much the kinetic energy of the particles that correctors left as they were has grown
   * beyond the work of their accelerations (m a times the way, by its mean at both ends of the step, of which that at
   * the end is the one with which the next step begins); NAN: not known. Evaluates at s->X, with which the next step
   * begins. Required. */
  hk_status (*account)(void *self, const void *method, hk_system *s, const double *end, double h, double *strayed);
} hk_corrected_facet;

/* Whether correctors left particle i as it was at `end`: of X, n particles. */
static inline bool hk_corrected_left(const double *X, const double *end, size_t n, size_t i) {
  bool left = true;
  for (size_t k = 3 * i; k < 3 * i + 3; k++) left &= X[k] == end[k] && X[3 * n + k] == end[3 * n + k];
  return left;
}

#endif
