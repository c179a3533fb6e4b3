/* Products of hinges for adjoints and tangents where C = sum weight x is linear, and its own transpose. The stiffness
 * is the rigidity times a number of the shape at rest, so that u.F has the derivative of its stiffness times that
 * number. */
#include "plugins/common/shells/bending.h"

/* -k C(u) w to `to`; returns -C(x).C(u), the derivative of u.F by the stiffness, where that is wanted. */
static double add_linear(const uint32_t *member, const double *w, double stiffness, const double *x, const double *u,
                         bool wanted, double *to) {
  size_t at[4] = {3 * (size_t)member[0], 3 * (size_t)member[1], 3 * (size_t)member[2], 3 * (size_t)member[3]};
  double Cu[3], by_stiffness = 0;
  for (size_t c = 0; c < 3; c++) {
    double base = u[at[0] + c];
    Cu[c] = w[1] * (u[at[1] + c] - base) + w[2] * (u[at[2] + c] - base) + w[3] * (u[at[3] + c] - base);
  }
  for (size_t c = 0; c < 3 && wanted; c++) {
    double base = x[at[0] + c];
    by_stiffness -=
        Cu[c] * (w[1] * (x[at[1] + c] - base) + w[2] * (x[at[2] + c] - base) + w[3] * (x[at[3] + c] - base));
  }
  for (size_t c = 0; c < 3; c++) Cu[c] *= stiffness;
  for (int m = 0; m < 4; m++)
    for (size_t c = 0; c < 3; c++) to[at[m] + c] -= Cu[c] * w[m];
  return by_stiffness;
}

void hk_bending_transposed(const hk_bending *b, const hk_view *view, const hk_bending_params *given, const double *u,
                           const hk_transposed *into) {
  const hk_elements *a = &b->element.acting;
  double *by_rigidity = into->parameter ? into->parameter[HK_BENDING_RIGIDITY] : NULL;
  for (size_t k = 0; k < a->node.count; k++) {
    size_t start = b->number[k];
    double by_k =
        add_linear(hk_tuple(&a->node, k), b->weight[start], a->stiffness.value[k], view->x, u, by_rigidity, into->x);
    if (by_rigidity) by_rigidity[given->hinges.count ? start : 0] += b->per_rigidity[start] * by_k;
  }
}

/* -(k C(dx) + dk C(x)) w to `to`. */
static inline void add_change(const uint32_t *member, const double *w, double stiffness, double change, const double *x,
                              const double *dx, double *to) {
  size_t at[4] = {3 * (size_t)member[0], 3 * (size_t)member[1], 3 * (size_t)member[2], 3 * (size_t)member[3]};
  double along[3];
  for (size_t c = 0; c < 3; c++) {
    double base = dx[at[0] + c];
    along[c] = w[1] * (dx[at[1] + c] - base) + w[2] * (dx[at[2] + c] - base) + w[3] * (dx[at[3] + c] - base);
    along[c] *= stiffness;
  }
  for (size_t c = 0; c < 3 && change != 0; c++) {
    double base = x[at[0] + c];
    along[c] += change * (w[1] * (x[at[1] + c] - base) + w[2] * (x[at[2] + c] - base) + w[3] * (x[at[3] + c] - base));
  }
  for (int m = 0; m < 4; m++)
    for (size_t c = 0; c < 3; c++) to[at[m] + c] -= along[c] * w[m];
}

void hk_bending_along(const hk_bending *b, const hk_view *view, const hk_bending_params *given,
                      const hk_tangent *directions, size_t count) {
  const hk_elements *a = &b->element.acting;
  for (const hk_tangent *t = directions; t < directions + count; t++) {
    const double *rigidity = t->parameter ? t->parameter[HK_BENDING_RIGIDITY] : NULL;
    for (size_t k = 0; k < a->node.count; k++) {
      size_t start = b->number[k];
      double change = rigidity ? b->per_rigidity[start] * rigidity[given->hinges.count ? start : 0] : 0;
      add_change(hk_tuple(&a->node, k), b->weight[start], a->stiffness.value[k], change, view->x, t->x, t->force);
    }
  }
}
