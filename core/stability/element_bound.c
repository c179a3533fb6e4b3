/* An upper bound of the frequencies of a network of springs, from its elements alone.
 *
 * A spring along the unit vector n, of length l, stiffness k and rest length L, has the energy Hessian
 * k n n^T + k (1 - L/l) (I - n n^T) =: H for u = u_j - u_i. Its second term counts when positive (tension); leaving it
 * out when negative (compression) only raises the bound. By Young's inequality
 *   u^T H u <= (1 + s) u_i^T H u_i + (1 + 1/s) u_j^T H u_j,   s = sqrt(m_i/m_j),
 * so the mass-scaled stiffness is at most block-diagonal, the block of i being the sum over its springs of
 * H (1/m_i + 1/sqrt(m_i m_j)), and the largest eigenvalue of any block bounds w^2. This is the block form of
 * Gershgorin's theorem that keeps the directions of the springs: it does not depend on the axes, and it is reached by
 * regular grids of any spacing, where bounding each block by its norm would give up a factor of 2. */
#include "core/stability/element_bound.h"

#include <string.h>

/* Smith, Commun. ACM 4 (1961) 168. */
void hk_symmetric_eigenvalues(const double a[6], double value[3]) {
  double mean = (a[0] + a[3] + a[5]) / 3, x = a[0] - mean, y = a[3] - mean, z = a[5] - mean;
  double p = sqrt((x * x + y * y + z * z + 2 * (a[1] * a[1] + a[2] * a[2] + a[4] * a[4])) / 6), angle = 0;
  if (p > 0) {
    double half_det =
        (x * (y * z - a[4] * a[4]) - a[1] * (a[1] * z - a[4] * a[2]) + a[2] * (a[1] * a[4] - y * a[2])) / 2;
    angle = acos(fmax(-1, fmin(1, half_det / (p * p * p)))) / 3;
  }
  value[2] = mean + 2 * p * cos(angle);
  value[0] = mean + 2 * p * cos(angle + 2.0943951023931957);
  value[1] = 3 * mean - value[0] - value[2];
}

static double span(const double *x, const uint32_t pair[2], double d[3]) {
  for (size_t c = 0; c < 3; c++) d[c] = x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* Adds factor (along n n^T + across (I - n n^T)) to a block; d = l n. */
static void add_block(double *block, double factor, double along, double across, const double d[3], double l) {
  double lateral = factor * across, rest = l > 0 ? factor * (along - across) / (l * l) : 0;
  block[0] += lateral + rest * d[0] * d[0];
  block[1] += rest * d[0] * d[1];
  block[2] += rest * d[0] * d[2];
  block[3] += lateral + rest * d[1] * d[1];
  block[4] += rest * d[1] * d[2];
  block[5] += lateral + rest * d[2] * d[2];
}

static double value_of(const hk_per_edge *p, size_t e) { return p->count ? hk_edge_value(p, e) : 0; }

/* Stiffness across the spring. At length 0 there is no direction: the limit is k for L = 0, and else nothing. */
static double across_of(const hk_elements *list, size_t e, double l) {
  double k = value_of(&list->stiffness, e), L = value_of(&list->rest, e);
  if (L == 0) return k;
  return l > 0 ? fmax(0, k * (1 - L / l)) : 0;
}

static void add_element(const hk_model *model, const hk_elements *list, size_t e, const double *x, bool tension_only,
                        double *blocks) {
  double d[3], l = span(x, list->pair[e], d), across = across_of(list, e, l);
  double along = tension_only ? 0 : value_of(&list->stiffness, e);
  size_t i = list->pair[e][0], j = list->pair[e][1];
  double wi = model->inverse_mass[i], wj = model->inverse_mass[j], both = sqrt(wi * wj);
  add_block(blocks + 6 * i, wi + both, along, across, d, l);
  add_block(blocks + 6 * j, wj + both, along, across, d, l);
}

static double largest_block(const hk_model *model, const double *x, bool tension_only, double *blocks) {
  double largest = 0, value[3];
  memset(blocks, 0, 6 * model->n * sizeof *blocks);
  for (size_t k = 0; k < model->element_lists; k++)
    for (size_t e = 0; e < model->element_list[k].elements.count; e++)
      add_element(model, &model->element_list[k].elements, e, x, tension_only, blocks);
  for (size_t i = 0; i < model->n; i++) {
    if (!(model->inverse_mass[i] > 0)) continue;
    hk_symmetric_eigenvalues(blocks + 6 * i, value);
    largest = fmax(largest, value[2]);
  }
  return largest;
}

static void note_lengths(hk_element_bound *b, const double *x, size_t count, const uint32_t (*pair)[2]) {
  double d[3];
  for (size_t e = 0; e < count; e++) {
    double l = span(x, pair[e], d);
    if (l > 0 && l < b->length) b->length = l;
  }
}

static double least_ratio(const hk_model *model) {
  double least = INFINITY;
  for (size_t k = 0; k < model->element_lists; k++) {
    const hk_elements *list = &model->element_list[k].elements;
    for (size_t e = 0; e < list->count; e++) {
      double stiffness = value_of(&list->stiffness, e);
      if (stiffness > 0) least = fmin(least, value_of(&list->damping, e) / stiffness);
    }
  }
  return isfinite(least) ? least : 0;
}

hk_element_bound hk_element_bound_at(const hk_model *model, const double *x, double *scratch) {
  hk_element_bound b = {.length = INFINITY, .beta = least_ratio(model)};
  note_lengths(&b, x, model->edges.count, model->edges.pair);
  for (size_t k = 0; k < model->element_lists; k++) {
    const hk_elements *list = &model->element_list[k].elements;
    note_lengths(&b, x, list->count, list->pair);
  }
  b.stiffness = largest_block(model, x, false, scratch);
  if (b.beta > 0) b.tension = largest_block(model, x, true, scratch);
  return b;
}
