/* A parameter by its name, for scripts and command lines: one that is not known is an error that names what was meant.
 */
#include "core/scene/scene/scene.h"

#include <string.h>

/* The plugin's own, then what the host gives plugins of its kind. */
static const char *name_at(const void *context, size_t k) {
  const hk_plugin *plugin = context;
  static const char *const common[] = {"label", "group", "only", "from", "to"};
  size_t own = 0;
  while (plugin->params && plugin->params[own].name) own++;
  if (k < own) return plugin->params[k].name;
  k -= own;
  size_t known = plugin->kind == HK_FORCE ? 5 : plugin->kind == HK_SOURCE ? 2 : 1;
  return k < known ? common[k] : NULL;
}

/* The parameter of which it is the plural; that of which the help says that it is
 * this (k, "stiffness"); a synonym; or the closest name. */
static const char *meant(const hk_registry *registry, const hk_plugin *plugin, const char *name) {
  const char *singular = hk_singular_name(name, name_at, plugin);
  if (singular) return singular;
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (p->help && hk_begins_with_words(p->help, name)) return p->name;
  return hk_registry_meant(registry, name, name_at, plugin);
}

const hk_param *hk_scene_param(const hk_scene *scene, const hk_plugin_spec *spec, const char *name, hk_error *error) {
  const hk_param *found = hk_spec_param(spec, name, NULL);
  const char *near = found ? NULL : meant(scene->registry, spec->plugin, name);
  if (!near) return hk_spec_param(spec, name, error);
  hk_error_set(error, HK_BAD_PARAM, "%s: no parameter '%s'; did you mean '%s'?", spec->label, name, near);
  return NULL;
}
