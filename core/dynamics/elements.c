/* The elements (on edges, triangles, ...) and the published fields of forces, collected in the model for other
 * plugins. */
#include "core/dynamics/dynamics.h"

#include <stdlib.h>

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

static bool is_published(const hk_field *f) { return f->flags & HK_PUBLISHED && f->type == HK_FIELD_PER_PARTICLE; }

/* Of all instances; `into` NULL: only counts. */
static size_t list_publications(const hk_plugins *plugins, hk_publication *into) {
  size_t count = 0;
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < plugins->kind[kind].count; k++) {
      const hk_instance *instance = plugins->kind[kind].item[k];
      for (const hk_field *f = instance->plugin->fields; f && f->name; f++) {
        if (!is_published(f)) continue;
        const void *at = (const char *)instance->self + f->offset;
        if (into) into[count] = (hk_publication){f->name, instance->label, f->width, (const double *const *)at};
        count++;
      }
    }
  return count;
}

hk_status hk_publications_list(hk_dynamics *d) {
  size_t room = list_publications(d->plugins, NULL);
  hk_publication *list = realloc(d->publication, (room + 1) * sizeof *list);
  if (!list) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu published fields", room);
  d->publication = list;
  d->state->model.publications = list_publications(d->plugins, list);
  d->state->model.published = list;
  return HK_OK;
}

void hk_elements_refresh(hk_dynamics *d) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  size_t lists = 0;
  for (size_t k = 0; k < forces->count; k++) {
    const hk_instance *force = forces->item[k];
    if (!force->plugin->force->elements) continue;
    hk_element_list *list = &d->element_list[lists++];
    *list = (hk_element_list){.force = force->label, .elements = {.values = 1}, .index = k, .acts = d->force_acts[k]};
    const hk_instance *outer = hk_enter(force);
    force->plugin->force->elements(force->self, &d->force_view[k], &list->elements);
    hk_leave(force, outer);
  }
  d->state->model.element_lists = lists;
  d->state->model.element_list = d->element_list;
}
