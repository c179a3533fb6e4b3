/* The instances of a run, by kind and in the script's order. */
#include "core/engine/host/host.h"

#include <stdlib.h>

hk_status hk_plugins_add(hk_plugins *plugins, const hk_plugin_spec *spec, hk_shared *shared, hk_instance **made,
                         hk_error *error) {
  hk_instances *list = &plugins->kind[spec->plugin->kind];
  hk_instance **grown = realloc(list->item, (list->count + 1) * sizeof *grown);
  if (!grown) return hk_error_set(error, HK_NO_MEMORY, "%s: no memory for the plugin", spec->label);
  list->item = grown;
  hk_instance *instance = hk_instance_create(spec, shared, error);
  if (!instance) return HK_NO_MEMORY;
  list->item[list->count++] = instance;
  if (made) *made = instance;
  return HK_OK;
}

void hk_plugins_clear(hk_plugins *plugins) {
  for (int kind = 0; kind < HK_KINDS; kind++) {
    hk_instances *list = &plugins->kind[kind];
    for (size_t k = 0; k < list->count; k++) hk_instance_destroy(list->item[k]);
    free(list->item);
    *list = (hk_instances){0};
  }
}

hk_instance *hk_plugins_one(const hk_plugins *plugins, hk_kind kind) {
  return plugins->kind[kind].count ? plugins->kind[kind].item[0] : NULL;
}

hk_status hk_plugins_remap(hk_plugins *plugins, const uint32_t *map, size_t n_old, const hk_view *view, size_t size,
                           hk_error *error) {
  static const hk_kind order[] = {HK_CONSTRAINT, HK_SERVICE, HK_SOURCE,     HK_FORCE,
                                  HK_CORRECTOR,  HK_OUTPUT,  HK_INTEGRATOR, HK_SOLVER};
  for (size_t o = 0; o < sizeof order / sizeof *order; o++)
    for (size_t k = 0; k < plugins->kind[order[o]].count; k++) {
      hk_instance *instance = plugins->kind[order[o]].item[k];
      if (!instance->started) continue;
      hk_status status = hk_instance_remap(instance, map, n_old, view, size, error);
      if (status != HK_OK) return status;
    }
  return HK_OK;
}
