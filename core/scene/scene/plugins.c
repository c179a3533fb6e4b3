/* The plugins that a script names: their labels, and the one integrator and solver of a scene. */
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"
#include "core/scene/scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool label_taken(hk_scene *scene, const char *label) {
  for (int kind = 0; kind < HK_KINDS; kind++) {
    const hk_specs *list = &scene->plugin[kind];
    for (size_t k = 0; k < list->count; k++)
      if (strcmp(list->item[k]->label, label) == 0) return true;
  }
  return false;
}

static hk_status choose_label(hk_scene *scene, const char *name, const char *label, char *chosen, size_t size,
                              hk_error *error) {
  snprintf(chosen, size, "%s", label ? label : name);
  if (label && label_taken(scene, label))
    return hk_error_set(error, HK_BAD_PARAM, "%s: the label '%s' is taken", name, label);
  for (int k = 2; !label && label_taken(scene, chosen); k++) snprintf(chosen, size, "%s#%d", name, k);
  return HK_OK;
}

/* A path that begins with a dot is relative to the script's folder. */
static const char *beside_script(const hk_scene *scene, const char *name, char *path, size_t size) {
  const char *slash = strrchr(scene->script, '/');
  if (name[0] != '.' || !slash) return name;
  return snprintf(path, size, "%.*s/%s", (int)(slash - scene->script), scene->script, name) < (int)size ? path : name;
}

static bool is_single(hk_kind kind) { return kind == HK_INTEGRATOR || kind == HK_SOLVER; }

hk_status hk_scene_add_plugin(hk_scene *scene, hk_kind kind, const char *name, const char *label, const char *where,
                              hk_plugin_spec **spec, hk_error *error) {
  const hk_plugin *plugin;
  char chosen[128], path[4096];
  const char *from = beside_script(scene, name, path, sizeof path);
  const hk_stand_in *other = &scene->stand_in;
  bool replaced = kind == HK_FORCE && other->force && strcmp(other->force, name) == 0;
  if (replaced) from = other->path;
  hk_status status = hk_registry_find(scene->registry, kind, from, scene->trusted || replaced, &plugin, error);
  /* A stand-in has the label of the force, by which the script asks for it. */
  if (status == HK_OK)
    status = choose_label(scene, replaced ? name : plugin->name, label, chosen, sizeof chosen, error);
  if (status != HK_OK) return status;
  hk_plugin_spec *fresh = hk_spec_create(plugin, chosen, where, error);
  if (!fresh) return HK_NO_MEMORY;
  hk_specs *list = &scene->plugin[kind];
  if (is_single(kind) && list->count) hk_scene_drop(scene, list->item[0]);
  hk_plugin_spec **item = realloc(list->item, (list->count + 1) * sizeof *item);
  if (!item) {
    hk_spec_destroy(fresh);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the plugin");
  }
  list->item = item;
  list->item[list->count++] = fresh;
  *spec = fresh;
  return HK_OK;
}

const hk_plugin_spec *hk_scene_one(const hk_scene *scene, hk_kind kind) {
  return scene->plugin[kind].count ? scene->plugin[kind].item[0] : NULL;
}

void hk_scene_drop(hk_scene *scene, hk_plugin_spec *spec) {
  hk_specs *list = &scene->plugin[spec->plugin->kind];
  size_t kept = 0;
  for (size_t k = 0; k < list->count; k++)
    if (list->item[k] != spec) list->item[kept++] = list->item[k];
  list->count = kept;
  hk_spec_destroy(spec);
}
