/* The description of one plugin by the script: label, selection, times, and the values of its parameters in memory laid
 * out like an instance. A spec is plain data: no code of the plugin runs for it, and any number of instances can be
 * made of it. */
#include "core/engine/contract/contract.h"
#include "core/engine/host/host.h"

#include <stdlib.h>
#include <string.h>

static size_t param_count(const hk_plugin *plugin) {
  size_t count = 0;
  while (plugin->params && plugin->params[count].name) count++;
  return count;
}

static hk_status set_default(hk_plugin_spec *spec, const hk_param *p, hk_error *error) {
  void *field = hk_param_in(p, spec->values);
  bool optional = p->flags & HK_OPTIONAL;
  if (hk_param_arity(p)) ((hk_tuples *)field)->arity = hk_param_arity(p);
  switch (hk_param_type(p)) {
  case HK_NUMBER:
    *(double *)field = optional ? NAN : p->initial[0];
    break;
  case HK_INTEGER:
    *(int64_t *)field = (int64_t)p->initial[0];
    break;
  case HK_BOOLEAN:
    *(bool *)field = p->initial[0] != 0;
    break;
  case HK_STRING:
    *(const char **)field = p->text;
    break;
  case HK_CHOICE:
    *(int *)field = (int)p->initial[0];
    break;
  case HK_VECTOR:
    for (int c = 0; c < 3; c++) ((double *)field)[c] = optional ? NAN : p->initial[c];
    break;
  case HK_PER_TUPLE:
    if (!optional && !(p->flags & HK_REQUIRED)) {
      hk_value value = {.kind = HK_VALUE_NUMBER, .number = p->initial[0]};
      hk_status status = hk_spec_set(spec, p, &value, 0, error);
      spec->given[p - spec->plugin->params] = false;
      return status;
    }
    break;
  default: /* lists are empty, as the memory is zeroed */
    break;
  }
  return HK_OK;
}

hk_plugin_spec *hk_spec_create(const hk_plugin *plugin, const char *label, const char *where, hk_error *error) {
  hk_plugin_spec *spec = calloc(1, sizeof *spec);
  if (!spec) goto no_memory;
  spec->plugin = plugin;
  spec->from = -INFINITY;
  spec->to = INFINITY;
  spec->values = hk_memory_get(&spec->blocks, plugin->instance_size);
  spec->label = hk_string_copy(label);
  spec->where = hk_string_copy(where ? where : "");
  spec->given = calloc(param_count(plugin) + 1, sizeof *spec->given);
  if (!spec->values || !spec->label || !spec->where || !spec->given) goto no_memory;
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (set_default(spec, p, error) != HK_OK) goto no_memory;
  return spec;
no_memory:
  hk_error_set(error, HK_NO_MEMORY, "%s: no memory for the plugin", label);
  hk_spec_destroy(spec);
  return NULL;
}

void hk_spec_destroy(hk_plugin_spec *spec) {
  if (!spec) return;
  hk_memory_clear(&spec->blocks);
  free(spec->label);
  free(spec->where);
  free(spec->only);
  free(spec->group);
  free(spec->timed);
  free(spec->given);
  free(spec);
}
