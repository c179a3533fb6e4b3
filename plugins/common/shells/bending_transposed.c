/* Products of hinges for adjoints. The stiffness is the rigidity times a number of the shape at rest, so that u.F has
 * the derivative of its stiffness times that number; what is C = sum weight x is linear, and its own transpose. */
#include "plugins/common/shells/bending.h"

/* -k C(u) w to into->x; returns -C(x).C(u), the derivative of u.F by the stiffness. */
static double add_linear(const hk_bending *b, const hk_view *view, size_t k, const double *u, double *to) {
  const hk_elements *a = &b->element.acting;
  const uint32_t *member = hk_tuple(&a->node, k);
  const double *w = b->weight[b->number[k]];
  double by_stiffness = 0;
  for (size_t c = 0; c < 3; c++) {
    double C = 0, Cu = 0;
    for (int m = 1; m < 4; m++) {
      size_t at = 3 * (size_t)member[m] + c, base = 3 * (size_t)member[0] + c;
      C += w[m] * (view->x[at] - view->x[base]);
      Cu += w[m] * (u[at] - u[base]);
    }
    by_stiffness -= C * Cu;
    for (int m = 0; m < 4; m++) to[3 * (size_t)member[m] + c] -= a->stiffness.value[k] * Cu * w[m];
  }
  return by_stiffness;
}

void hk_bending_transposed(const hk_bending *b, const hk_view *view, const hk_bending_params *given, const double *u,
                           const hk_transposed *into, bool all_rows) {
  for (size_t k = 0; k < b->element.acting.node.count; k++) {
    size_t start = b->number[k], at = given->hinges.count ? start : 0;
    double by_k = 0, by_c = 0, by_rest = 0;
    if (b->weight)
      by_k = add_linear(b, view, k, u, into->x);
    else
      hk_element_force_transposed(&b->element, view, k, u, into, &(hk_element_slopes){&by_k, &by_c, &by_rest});
    if (!into->parameter) continue;
    into->parameter[HK_BENDING_RIGIDITY][at] += b->per_rigidity[start] * by_k;
    if (!all_rows) continue;
    into->parameter[HK_BENDING_DAMPING][at] += b->per_rigidity[start] * by_c;
    into->parameter[HK_BENDING_REST][at] += by_rest;
  }
}
