/* Facet of forces that are not computed to rounding (by a tree or a mesh): they say how large their errors are, which
 * the energy balance and half the step do not show. */
#ifndef HK_PLUGIN_APPROXIMATION_H
#define HK_PLUGIN_APPROXIMATION_H

#include "core/plugin/force.h"

/* From a sample of the particles, whose forces are computed exactly. */
typedef struct hk_force_errors {
  size_t particles;         /* in the sample */
  double rms, p99, largest; /* relative to the exact force: root mean square, 99th percentile, largest */
  double power;             /* W, of all particles: sum of the size of the errors' power, |dF.v| */
} hk_force_errors;

#define HK_APPROXIMATION_ID "approximation/1"
#define HK_APPROXIMATION_FACET(...) HK_FACET(HK_APPROXIMATION_ID, hk_approximation_facet, __VA_ARGS__)

/* Both are required. */
typedef struct hk_approximation_facet {
  size_t size;
  /* The errors that `add` makes at `view`. Called at frames; it should cost less than an `add`. False: here it is exact
   * to rounding. */
  bool (*errors)(void *self, const hk_view *view, hk_force_errors *out);
  /* Makes the errors `part` times (0 to 1) of what they were, at most: called before the first step of a run that
   * another one is compared with. */
  void (*sharpen)(void *self, double part);
} hk_approximation_facet;

#endif
