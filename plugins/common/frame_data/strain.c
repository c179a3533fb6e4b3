/* Strains at a frame: of each element C over its rest value, as the figures of a run have it; of several numbers C the
 * largest by magnitude. A cell has the strain of its own element, a particle the largest of all elements that it
 * belongs to, also of those that are no cell. */
#include "plugins/common/frame_data/strain.h"

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

static double strain_of(const hk_elements *e, const double *x, size_t k) {
  return e->evaluate ? general_strain(e, x, k) : edge_strain(e, x, k);
}

static void note(hk_gatherer *s, const uint32_t *member, unsigned arity, double strain) {
  for (unsigned m = 0; m < arity; m++) {
    uint32_t j = s->place[member[m]];
    if (j != UINT32_MAX && fabs(strain) > fabs(s->data.strain[j])) s->data.strain[j] = strain;
  }
}

static void of_particles(hk_gatherer *s, const hk_view *view) {
  const hk_model *m = view->model;
  for (size_t j = 0; j < s->data.n; j++) s->data.strain[j] = 0;
  for (size_t l = 0; l < m->element_lists; l++) {
    const hk_elements *e = &m->element_list[l].elements;
    for (size_t k = 0; k < e->node.count && e->rest.count; k++)
      note(s, hk_tuple(&e->node, k), e->node.arity, strain_of(e, view->x, k));
  }
}

static void of_cells(hk_gatherer *s, const hk_view *view) {
  for (size_t k = 0; k < hk_cell_count(&s->data.cells); k++) {
    hk_cell_source from = s->source[k];
    const hk_elements *e = from.list == UINT32_MAX ? NULL : &view->model->element_list[from.list].elements;
    s->data.cell_strain[k] = e && e->rest.count ? strain_of(e, view->x, from.tuple) : NAN;
  }
}

void hk_gatherer_strain(hk_gatherer *s, const hk_view *view) {
  if (!s->strained) return;
  of_particles(s, view);
  of_cells(s, view);
}
