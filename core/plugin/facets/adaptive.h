/* Facet of a method with HK_ADAPTIVE for which the usual tolerance, 1e-6, is not worth its cost, or which reaches
 * rounding. */
#ifndef HK_PLUGIN_ADAPTIVE_H
#define HK_PLUGIN_ADAPTIVE_H

#include <stddef.h>

#define HK_ADAPTIVE_ID "adaptive/1"

typedef struct hk_adaptive_facet {
  size_t size;
  double tolerance; /* hk_system.tol where nobody asks for one: what the order makes worth while. Required. */
  /* The smallest tolerance to which the errors of its runs still fall; 0: 1e-13, where the rounding errors of many
   * short steps add up. A method that states 1e-15 or less reaches rounding: nothing but that is left in its runs of
   * smooth motion, so that the host takes it as the reference of others. */
  double finest;
  double evaluations; /* per step, on average, of a method that iterates on f; 0: hk_integrator.stages */
} hk_adaptive_facet;

#endif
