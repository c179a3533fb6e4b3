/* What the script says and the run does not use, or what contradicts something else that it says: each is a warning
 * before the first step, with the line of the script. What cannot be meant is an error where the script says it. */
#include "core/engine/contract/contract.h"
#include "core/run/run/run.h"

#include <stdio.h>
#include <stdlib.h>

/* Kinds that act on particles. */
static const hk_kind acting_kinds[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR};
enum { ACTING_KINDS = sizeof acting_kinds / sizeof *acting_kinds };

static const char *before_text(const hk_plugin_spec *spec) { return *spec->where ? ": " : ""; }

static void warn(hk_run *run, const hk_plugin_spec *spec, const char *why) {
  hk_warn(&run->warnings, "%s%s%s has no effect: %s", spec->where, before_text(spec), spec->label, why);
}

/* ---- a plugin that acts on nothing ---- */

/* The list that the plugin has to be given and that is empty; NULL: there is none, or another list is not empty. */
static const hk_param *empty_list(const hk_plugin_spec *spec) {
  const hk_param *empty = NULL;
  for (const hk_param *p = spec->plugin->params; p && p->name; p++) {
    const hk_tuples *list = hk_param_arity(p) ? hk_param_in(p, spec->values) : NULL;
    if (list && list->count > 0) return NULL;
    if (list && p->flags & HK_REQUIRED) empty = p;
  }
  return empty;
}

static void warn_of_times(hk_run *run, const hk_plugin_spec *spec) {
  double end = run->scene->duration;
  char why[128];
  if (spec->from >= end && end > 0)
    snprintf(why, sizeof why, "it acts from %g s on, and the scene ends at %g s; let it begin before", spec->from, end);
  else if (spec->to <= 0)
    snprintf(why, sizeof why, "it acts up to %g s, and the scene begins at 0 s; let it end later", spec->to);
  else
    return;
  warn(run, spec, why);
}

static void warn_of_idle(hk_run *run, const hk_instance *instance) {
  const hk_param *empty = empty_list(instance->spec);
  bool births = run->scene->plugin[HK_SOURCE].count > 0;
  char why[128];
  if (empty) {
    snprintf(why, sizeof why, "its list '%.64s' is empty; name some, or leave it out", empty->name);
    warn(run, instance->spec, why);
  } else if (instance->is_active && instance->acting == 0 && !births)
    warn(run, instance->spec, "no particle is among those of its `only` and `group`; name some, or leave it out");
  warn_of_times(run, instance->spec);
}

static void warn_of_empty_pins(hk_run *run) {
  const hk_particles *p = &run->scene->particles;
  for (size_t k = 0; k < p->pins; k++)
    if (p->pin[k].count == 0)
      hk_warn(&run->warnings, "%s: pin has no effect: its list of particles is empty; name some, or leave it out",
              p->pin[k].where);
}

/* ---- a pair that constraints of one plugin join twice ---- */

typedef struct joined_pair {
  const hk_plugin_spec *by;
  const hk_param *list;
  size_t at, number; /* in the list, and of all */
  uint32_t low, high;
} joined_pair;

static int compare_pairs(const joined_pair *p, const joined_pair *q) {
  if (p->by->plugin != q->by->plugin) return p->by->plugin < q->by->plugin ? -1 : 1;
  if (p->low != q->low) return p->low < q->low ? -1 : 1;
  return (p->high > q->high) - (p->high < q->high);
}

/* Equal ones are in the script's order. */
static int by_members(const void *a, const void *b) {
  const joined_pair *p = a, *q = b;
  int order = compare_pairs(p, q);
  return order ? order : (p->number > q->number) - (p->number < q->number);
}

/* Those of all lists of edges of constraints; NULL `into`: their number. */
static size_t list_pairs(const hk_run *run, joined_pair *into) {
  const hk_instances *constraints = &run->plugins.kind[HK_CONSTRAINT];
  size_t count = 0;
  for (size_t k = 0; k < constraints->count; k++)
    for (const hk_param *p = constraints->item[k]->plugin->params; p && p->name; p++) {
      const hk_plugin_spec *by = constraints->item[k]->spec;
      const hk_tuples *list = p->edges ? hk_param_in(p, by->values) : NULL;
      for (size_t e = 0; list && e < list->count; e++, count++) {
        const uint32_t *id = hk_tuple(list, e);
        bool rises = id[0] < id[1];
        if (into) into[count] = (joined_pair){by, p, e, count, id[!rises], id[rises]};
      }
    }
  return count;
}

static void warn_of_repeated(hk_run *run) {
  size_t count = list_pairs(run, NULL);
  joined_pair *pair = count > 1 ? malloc(count * sizeof *pair) : NULL;
  if (!pair) return; /* without memory a warning less */
  list_pairs(run, pair);
  qsort(pair, count, sizeof *pair, by_members);
  for (size_t k = 1; k < count; k++) {
    const joined_pair *p = &pair[k], *before = &pair[k - 1];
    if (compare_pairs(p, before) != 0) continue;
    hk_warn(&run->warnings,
            "%s%s%s: %s[%zu] joins particles %u and %u, as %s[%zu] of %s does, and has no effect of its own: leave one "
            "of them out",
            p->by->where, before_text(p->by), p->by->label, p->list->name, p->at + 1, p->low + 1, p->high + 1,
            before->list->name, before->at + 1, before->by->label);
    break;
  }
  free(pair);
}

/* ---- a pair that is twice in a list of a force: it acts twice ---- */

static size_t hash_of_pair(const uint32_t *id) {
  uint64_t low = id[id[0] > id[1]], high = id[id[0] <= id[1]];
  uint64_t mixed = (low * 0x9e3779b97f4a7c15u ^ high) * 0xc2b2ae3d27d4eb4fu; /* multipliers of many bits, both odd */
  return (size_t)(mixed >> 32);
}

static bool same_pair(const uint32_t *a, const uint32_t *b) {
  return (a[0] == b[0] && a[1] == b[1]) || (a[0] == b[1] && a[1] == b[0]);
}

/* The first entry whose pair, in any direction, comes before it, and where; in a table of open addressing. */
static bool find_repeated(const hk_tuples *list, size_t *before, size_t *at) {
  size_t room = 4;
  while (room < 2 * list->count) room *= 2;
  uint32_t *entry = list->count > 1 && list->count < UINT32_MAX ? calloc(room, sizeof *entry) : NULL; /* from 1 */
  bool found = false;
  for (size_t e = 0; entry && e < list->count && !found; e++) {
    size_t k = hash_of_pair(hk_tuple(list, e)) & (room - 1);
    while (entry[k] && !same_pair(hk_tuple(list, entry[k] - 1), hk_tuple(list, e))) k = (k + 1) & (room - 1);
    found = entry[k];
    *before = found ? entry[k] - 1 : 0, *at = e;
    entry[k] = (uint32_t)(e + 1);
  }
  free(entry);
  return found;
}

static void warn_of_doubled(hk_run *run, const hk_plugin_spec *spec) {
  size_t before, at;
  for (const hk_param *p = spec->plugin->params; p && p->name; p++) {
    const hk_tuples *list = p->edges ? hk_param_in(p, spec->values) : NULL;
    if (!list || !find_repeated(list, &before, &at)) continue;
    const uint32_t *id = hk_tuple(list, at);
    hk_warn(&run->warnings,
            "%s%s%s: %s[%zu] joins particles %u and %u, as %s[%zu] does, and both act: leave one of them out, or give "
            "one of them the stiffness of both",
            spec->where, before_text(spec), spec->label, p->name, at + 1, id[0] + 1, id[1] + 1, p->name, before + 1);
  }
}

/* ---- particles that the scene joins, and no force does ---- */

static void mark(bool *marked, const hk_tuples *list) {
  for (size_t k = 0; list->arity > 1 && k < list->count * list->arity; k++) marked[list->index[k]] = true;
}

/* A force between any particles that are near, or between all: it needs no list, and does not only keep them apart. */
static bool joins_any(const hk_plugin *plugin) {
  bool listed = false;
  if (plugin->kind != HK_FORCE || !(plugin->force->flags & HK_CONSERVES_MOMENTUM)) return false;
  for (const hk_param *p = plugin->params; p && p->name; p++) listed = listed || hk_param_arity(p) > 1;
  return !listed && !hk_force_of(plugin)->surfaces.step_limit;
}

/* By indices: those in lists of plugins and in elements of forces. False: any may be joined, or nothing acts at all. */
static bool mark_held(const hk_run *run, bool *held) {
  size_t acts = 0;
  for (int kind = 0; kind < ACTING_KINDS; kind++)
    for (size_t k = 0; k < run->plugins.kind[acting_kinds[kind]].count; k++, acts++) {
      const hk_instance *instance = run->plugins.kind[acting_kinds[kind]].item[k];
      if (joins_any(instance->plugin)) return false;
      for (const hk_param *p = instance->plugin->params; p && p->name; p++)
        if (hk_param_arity(p) > 1) mark(held, hk_param_in(p, instance->self));
    }
  const hk_model *m = &run->state.model;
  for (size_t k = 0; k < m->element_lists; k++) mark(held, &m->element_list[k].elements.node);
  return acts > 0;
}

/* The number of particles that move, that the scene's edges or triangles join, and that are not held; the least id. */
static size_t count_loose(const hk_model *m, const bool *held, const bool *joined, uint32_t *first) {
  size_t loose = 0;
  *first = UINT32_MAX;
  for (size_t i = 0; i < m->n; i++) {
    if (!joined[i] || held[i] || m->inverse_mass[i] == 0) continue;
    loose++;
    *first = m->id[i] < *first ? m->id[i] : *first;
  }
  return loose;
}

/* Grids, strands and meshes whose particles fall apart. */
static void warn_of_loose(hk_run *run) {
  const hk_model *m = &run->state.model;
  bool *held = calloc(m->n + 1, sizeof *held), *joined = calloc(m->n + 1, sizeof *joined);
  size_t loose = 0;
  uint32_t first;
  if (held && joined && m->edges.count + m->triangles.count > 0 && mark_held(run, held)) {
    mark(joined, &m->edges);
    mark(joined, &m->triangles);
    loose = count_loose(m, held, joined, &first);
  }
  free(held);
  free(joined);
  if (loose > 0)
    hk_warn(&run->warnings,
            "%s: nothing holds together %zu particles of a mesh, grid or strand, such as particle %u, so that each "
            "moves by itself: name its edges or triangles in a force or constraint, scene:force(NAME, { edges = "
            "mesh:edges(), ... })",
            hk_scene_place_of(run->scene, first), loose, first);
}

/* ---- periodic boxes ---- */

static unsigned flags_of(const hk_plugin *plugin) {
  if (plugin->kind == HK_FORCE) return plugin->force->flags;
  return plugin->kind == HK_CONSTRAINT ? plugin->constraint->flags : plugin->corrector->flags;
}

/* What it does is the same wherever the images of a particle are: see HK_PERIODIC. */
static bool needs_no_images(const hk_plugin *plugin) {
  if (plugin->kind == HK_FORCE && !(plugin->force->flags & HK_DEPENDS_ON_X)) return true;
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (hk_param_arity(p) > 1 && !(p->flags & HK_OPTIONAL)) return true;
  return false;
}

static void warn_without_images(hk_run *run) {
  bool across = false;
  for (int kind = 0; kind < ACTING_KINDS; kind++)
    for (size_t k = 0; k < run->plugins.kind[acting_kinds[kind]].count; k++) {
      const hk_plugin_spec *spec = run->plugins.kind[acting_kinds[kind]].item[k]->spec;
      bool knows = flags_of(spec->plugin) & HK_PERIODIC;
      across |= knows;
      if (knows || needs_no_images(spec->plugin)) continue;
      hk_warn(&run->warnings,
              "%s%s%s knows no periodic box: it acts on particles where they are, which may be outside of the box, and "
              "not on their images",
              spec->where, before_text(spec), spec->label);
    }
  if (!across)
    hk_warn(&run->warnings,
            "the periodic box has no effect: no plugin of the scene acts across its faces; leave it out, "
            "or add a force between particles that are near each other");
}

/* ---- rigid bodies ---- */

static bool has_surface(const hk_particles *p, const hk_body_skin *body) {
  bool found = false;
  for (size_t k = 0; k < p->riders && !found; k++)
    found = p->rider[k].touches && p->rider[k].carrier[0] == body->carrier[0];
  return found;
}

/* Bodies that meet nothing, as no point of them is said to be of their surface. */
static void warn_without_surface(hk_run *run, const hk_plugin_spec *spec) {
  const hk_particles *p = &run->scene->particles;
  size_t count = 0, first = 0;
  for (size_t k = p->skins; k-- > 0;)
    if (!has_surface(p, &p->skin[k])) count++, first = k;
  if (count > 0)
    hk_warn(&run->warnings,
            "%s%s%s meets %zu rigid bodies nowhere, such as that of particle %u: they have no surface; name it with "
            "body:surface()",
            spec->where, before_text(spec), spec->label, count, p->skin[first].carrier[0]);
}

/* Forces that keep surfaces apart go by the masses of these, and points of bodies have none. */
static void warn_of_forces(hk_run *run) {
  const hk_particles *p = &run->scene->particles;
  bool touches = false;
  for (size_t k = 0; k < p->riders && !touches; k++) touches = p->rider[k].touches;
  for (size_t k = 0; k < run->plugins.kind[HK_FORCE].count && touches; k++) {
    const hk_plugin_spec *spec = run->plugins.kind[HK_FORCE].item[k]->spec;
    if (!hk_force_of(spec->plugin)->surfaces.step_limit) continue;
    hk_warn(&run->warnings,
            "%s%s%s does not know rigid bodies: where their surfaces meet something, the run ends; let a "
            "corrector keep them apart",
            spec->where, before_text(spec), spec->label);
  }
}

/* Other correctors move particles by their masses, and know nothing of what holds them together. */
static void warn_of_bodies(hk_run *run) {
  bool said = false;
  for (size_t k = 0; k < run->plugins.kind[HK_CORRECTOR].count; k++) {
    const hk_plugin_spec *spec = run->plugins.kind[HK_CORRECTOR].item[k]->spec;
    bool takes = spec->plugin->corrector->flags & HK_TAKES_BODIES;
    if (takes && !said) warn_without_surface(run, spec);
    said |= takes;
    if (takes || spec->plugin->corrector->flags & HK_TAKES_SKINS) continue;
    hk_warn(&run->warnings,
            "%s%s%s does not know rigid bodies: it moves their particles one by one, and takes their points for "
            "immovable; let a force act on points of the bodies instead",
            spec->where, before_text(spec), spec->label);
  }
}

/* ---- */

void hk_warn_of_no_effect(hk_run *run) {
  for (size_t k = 0; k < run->scene->warnings.count; k++) hk_warn(&run->warnings, "%s", run->scene->warnings.text[k]);
  for (int kind = 0; kind < ACTING_KINDS; kind++)
    for (size_t k = 0; k < run->plugins.kind[acting_kinds[kind]].count; k++)
      warn_of_idle(run, run->plugins.kind[acting_kinds[kind]].item[k]);
  warn_of_repeated(run);
  for (size_t k = 0; k < run->plugins.kind[HK_FORCE].count; k++)
    warn_of_doubled(run, run->plugins.kind[HK_FORCE].item[k]->spec);
  warn_of_empty_pins(run);
  warn_of_loose(run);
  if (run->state.model.box) warn_without_images(run);
  if (run->scene->distances.spec) warn_of_bodies(run);
  if (run->scene->distances.spec) warn_of_forces(run);
}
