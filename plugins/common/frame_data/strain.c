/* Strains at a frame. A cell has the strain of its own element, a particle the largest of all elements that it
 * belongs to, also of those that are no cell. */
#include "plugins/common/frame_data/strain.h"

#include "plugins/common/elements/element_strain.h"

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
    for (size_t k = 0; hk_elements_strained(e) && k < e->node.count; k++)
      note(s, hk_tuple(&e->node, k), e->node.arity, hk_element_strain(e, view->x, k));
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
  of_particles(s, view);
  of_cells(s, view);
}
