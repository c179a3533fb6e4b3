/* The elements (on edges, triangles, ...) and the published fields of forces, and the pairs that constraints join,
 * collected in the model for other plugins. */
#include "core/engine/contract/contract.h"
#include "core/engine/evaluate/evaluate.h"

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

static bool is_published(const hk_field *f) { return f->flags & HK_PUBLISHED && f->per_particle; }

/* Of all instances; `into` NULL: only counts. */
static size_t list_publications(const hk_plugins *plugins, hk_publication *into) {
  size_t count = 0;
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < plugins->kind[kind].count; k++) {
      const hk_instance *instance = plugins->kind[kind].item[k];
      for (const hk_field *f = instance->plugin->fields; f && f->name; f++) {
        if (!is_published(f)) continue;
        const void *at = hk_field_in(f, instance->self);
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

size_t hk_force_element_lists(const hk_plugin *force) {
  const hk_elements_facet *f = &hk_force_of(force)->elements;
  return f->list ? (f->lists ? f->lists : 1) : 0;
}

static bool one_or_each(const hk_per_tuple *p, const hk_tuples *node, bool optional) {
  return p->count == 1 || p->count == node->count || (optional && p->count == 0);
}

/* What the methods that work element by element rely on. */
static hk_status check_list(hk_dynamics *d, const char *label, const hk_elements *e) {
  const char *fault = NULL;
  if (e->node.arity < 1 || e->node.arity > 4)
    fault = "tuples of an arity that is not 1 to 4";
  else if (e->values < 1 || e->values > HK_ELEMENT_VALUES)
    fault = "a number of values per tuple that is not 1 to 16";
  else if (!e->evaluate && (e->node.arity != 2 || e->values != 1 || e->rest.count == 0))
    fault = "no evaluate, which only edges with a rest length can do without";
  else if (!one_or_each(&e->stiffness, &e->node, false) || !one_or_each(&e->damping, &e->node, true) ||
           !one_or_each(&e->rest, &e->node, true))
    fault = "stiffness, damping or rest that are neither one number nor one per tuple";
  if (!fault || e->node.count == 0) return HK_OK;
  return hk_error_set(d->error, HK_FAILED, "force '%s': its elements have %s: the plugin is at fault", label, fault);
}

/* The pairs in parameters of constraints that keep them as they are, or of the others. */
static size_t list_joins(const hk_instances *constraints, bool kept, const hk_tuples **into) {
  size_t count = 0;
  for (size_t k = 0; k < constraints->count; k++) {
    const hk_instance *instance = constraints->item[k];
    if (kept != !!(instance->plugin->constraint->flags & (HK_DISTANCES | HK_DIFFERENCES))) continue;
    for (const hk_param *p = instance->plugin->params; p && p->name; p++)
      if (p->edges) into[count++] = hk_joined_in(instance->plugin->constraint, p, instance->self);
  }
  return count;
}

hk_status hk_joins_refresh(hk_dynamics *d) {
  const hk_instances *constraints = &d->plugins->kind[HK_CONSTRAINT];
  size_t room = 1;
  for (size_t k = 0; k < constraints->count; k++)
    for (const hk_param *p = constraints->item[k]->plugin->params; p && p->name; p++) room++;
  const hk_tuples **list = realloc(d->join, room * sizeof *list);
  if (!list) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu lists of pairs", room);
  hk_model *m = &d->state->model;
  m->join = d->join = list, m->kept_lists = list_joins(constraints, true, list);
  m->join_lists = m->kept_lists + list_joins(constraints, false, list + m->kept_lists);
  return HK_OK;
}

hk_status hk_elements_refresh(hk_dynamics *d) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  hk_status status = hk_joins_refresh(d);
  size_t lists = 0;
  for (size_t k = 0; k < forces->count; k++) {
    const hk_instance *force = forces->item[k];
    size_t own = hk_force_element_lists(force->plugin);
    if (own == 0) continue;
    for (size_t l = 0; l < own; l++) d->offered[l] = (hk_elements){.values = 1};
    const hk_instance *outer = hk_enter(force);
    hk_force_of(force->plugin)->elements.list(force->self, &d->force_view[k], d->offered);
    hk_leave(force, outer);
    d->force_info[k].elements = d->offered[0].values > 0;
    if (!d->force_info[k].elements) continue;
    for (size_t l = 0; l < own && status == HK_OK; l++) status = check_list(d, force->label, &d->offered[l]);
    for (size_t l = 0; l < own; l++)
      d->element_list[lists++] = (hk_element_list){force->label, d->offered[l], k, d->force_acts[k]};
  }
  d->state->model.element_lists = lists;
  d->state->model.element_list = d->element_list;
  return status == HK_OK ? hk_tiles_arrange(&d->tiles, d->error) : status;
}
