/* The strain of an element, for figures, verdicts, pictures and recordings: its numbers C over the rest value, of
 * several the largest by magnitude; of an edge (|x_j - x_i| - rest)/rest. */
#ifndef HK_PLUGIN_STRAIN_H
#define HK_PLUGIN_STRAIN_H

#include "core/plugin.h"

#include <math.h>

/* Whether elements have strains: else none of them has. */
static inline bool hk_elements_strained(const hk_elements *e) {
  return e->rest.count && (e->evaluate || hk_elements_are_edges(e));
}

static inline bool hk_element_is_strained(const hk_elements *e, size_t k) {
  return e->evaluate ? hk_tuple_value(&e->rest, k) != 0 : hk_tuple_value(&e->rest, k) > 0;
}

/* NAN: element k has none, as its rest value is 0. */
static inline double hk_element_strain(const hk_elements *e, const double *x, size_t k) {
  double rest = hk_tuple_value(&e->rest, k), largest = 0;
  if (!hk_element_is_strained(e, k)) return NAN;
  if (!e->evaluate) {
    const uint32_t *pair = hk_tuple(&e->node, k);
    const double *a = x + 3 * (size_t)pair[0], *b = x + 3 * (size_t)pair[1];
    double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return (sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - rest) / rest;
  }
  double C[HK_ELEMENT_VALUES] = {0}, dC[4 * HK_ELEMENT_VALUES][3];
  e->evaluate(e->self, x, k, k + 1, C, dC);
  for (unsigned j = 0; j < e->values; j++)
    if (!(fabs(C[j] / rest) <= fabs(largest))) largest = C[j] / rest;
  return largest;
}

#endif
