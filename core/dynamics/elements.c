/* What forces offer to others, kept in the model: their elements (on edges, triangles, ...) and the fields that they
 * publish. */
#include "core/dynamics/dynamics.h"

bool hk_force_acts_at(const hk_instance *force, double t) { return t >= force->spec->from && t < force->spec->to; }

hk_view hk_force_view_at(const hk_dynamics *d, size_t k, double t, const double *X, size_t n) {
  hk_view view = d->force_view[k];
  view.t = t;
  view.x = X;
  view.v = X + 3 * n;
  view.y = d->state->width ? X + 6 * n : NULL;
  view.power = NULL;
  return view;
}

static void refresh_publications(hk_dynamics *d) {
  size_t count = 0;
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < d->plugins->kind[kind].count; k++) {
      const hk_instance *instance = d->plugins->kind[kind].item[k];
      for (const hk_field *f = instance->plugin->fields; f && f->name && d->publication; f++) {
        if (!(f->flags & HK_PUBLISHED) || f->type != HK_FIELD_PER_PARTICLE) continue;
        const void *at = (const char *)instance->self + f->offset;
        d->publication[count++] = (hk_publication){f->name, instance->label, f->width, (const double *const *)at};
      }
    }
  d->state->model.publications = count;
  d->state->model.published = d->publication;
}

void hk_elements_refresh(hk_dynamics *d) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  size_t lists = 0;
  for (size_t k = 0; k < forces->count; k++) {
    const hk_instance *force = forces->item[k];
    if (!force->plugin->force->elements) continue;
    hk_element_list *list = &d->element_list[lists++];
    *list = (hk_element_list){.force = force->label, .elements = {.values = 1}, .index = k, .acts = d->force_acts[k]};
    force->plugin->force->elements(force->self, &d->force_view[k], &list->elements);
  }
  d->state->model.element_lists = lists;
  d->state->model.element_list = d->element_list;
  refresh_publications(d);
}
