#include "plugins/common/elements/element_strain.h"

static double edge_strain(const hk_elements *e, const double *x, size_t k) {
  const uint32_t *pair = hk_tuple(&e->node, k);
  double square = 0, rest = hk_tuple_value(&e->rest, k);
  for (int c = 0; c < 3; c++) {
    double d = x[3 * (size_t)pair[1] + (size_t)c] - x[3 * (size_t)pair[0] + (size_t)c];
    square += d * d;
  }
  return rest > 0 ? (sqrt(square) - rest) / rest : NAN;
}

static double general_strain(const hk_elements *e, const double *x, size_t k) {
  double C[HK_ELEMENT_VALUES], dC[4 * HK_ELEMENT_VALUES][3], rest = hk_tuple_value(&e->rest, k), largest = 0;
  if (rest == 0) return NAN;
  e->evaluate(e->self, x, k, k + 1, C, dC);
  for (unsigned j = 0; j < e->values; j++)
    if (fabs(C[j] / rest) > fabs(largest)) largest = C[j] / rest;
  return largest;
}

bool hk_elements_strained(const hk_elements *e) { return e->rest.count && (e->evaluate || hk_elements_are_edges(e)); }

double hk_element_strain(const hk_elements *e, const double *x, size_t k) {
  return e->evaluate ? general_strain(e, x, k) : edge_strain(e, x, k);
}
