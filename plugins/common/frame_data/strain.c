/* Strains at a frame. A cell has the strain of its own element, a particle one of all elements that it belongs to, also
 * of those that are no cell. */
#include "plugins/common/frame_data/strain.h"

#include "core/plugin/strain.h"

static void note(const uint32_t *place, const uint32_t *member, unsigned arity, double strain, double *largest) {
  for (unsigned m = 0; m < arity; m++) {
    uint32_t j = place ? place[member[m]] : member[m];
    if (j != UINT32_MAX && fabs(strain) > fabs(largest[j])) largest[j] = strain;
  }
}

void hk_particle_strains(const hk_view *view, const uint32_t *place, size_t count, double *strain) {
  const hk_model *m = view->model;
  for (size_t j = 0; j < count; j++) strain[j] = 0;
  for (size_t l = 0; l < m->element_lists; l++) {
    const hk_elements *e = &m->element_list[l].elements;
    for (size_t k = 0; hk_elements_strained(e) && k < e->node.count; k++)
      note(place, hk_tuple(&e->node, k), e->node.arity, hk_element_strain(e, view->x, k), strain);
  }
}

static void of_cells(hk_gatherer *s, const hk_view *view) {
  for (size_t k = 0; k < hk_cell_count(&s->data.cells); k++) {
    hk_cell_source from = s->source[k];
    const hk_elements *e = from.list == UINT32_MAX ? NULL : &view->model->element_list[from.list].elements;
    s->data.cell_strain[k] = e && hk_elements_strained(e) ? hk_element_strain(e, view->x, from.tuple) : NAN;
  }
}

void hk_gatherer_strain(hk_gatherer *s, const hk_view *view) {
  if (!s->strained) return;
  hk_particle_strains(view, s->place, s->data.n, s->data.strain);
  of_cells(s, view);
}
