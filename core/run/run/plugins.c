/* The plugins of a run: an instance of each that the scene names or the command line adds, the services that they ask
 * for, which come into being at the first request, and their start, in an order in which each finds what it needs. */
#include "core/run/run/install.h"
#include "core/run/run/run.h"

#include <stdlib.h>
#include <string.h>

/* ---- instances ---- */

/* One of the first `own` outputs is of this plugin: two would write the same files. */
static bool writes_already(const hk_instances *outputs, size_t own, const hk_plugin_spec *added) {
  bool found = false;
  for (size_t k = 0; k < own && added->plugin->kind == HK_OUTPUT; k++)
    found |= outputs->item[k]->plugin == added->plugin;
  return found;
}

/* The scene's plugins of a kind, and then those that the command line adds, but no output that the scene has. */
static hk_status make_kind(hk_run *run, hk_kind kind) {
  const hk_specs *specs = &run->scene->plugin[kind];
  const hk_overrides *o = &run->overrides;
  bool silent = kind == HK_OUTPUT && run->options.no_output, alone = kind == HK_OUTPUT && run->options.bare;
  hk_status status = HK_OK;
  for (size_t k = 0; !silent && k < specs->count && status == HK_OK; k++)
    if (!hk_overrides_leave_out(o, specs->item[k]))
      status = hk_plugins_add(&run->plugins, specs->item[k], &run->shared, NULL, &run->error);
  size_t own = run->plugins.kind[kind].count;
  for (size_t k = 0; !alone && k < o->added_count && status == HK_OK; k++)
    if (o->added[k]->plugin->kind == kind && !writes_already(&run->plugins.kind[kind], own, o->added[k]))
      status = hk_plugins_add(&run->plugins, o->added[k], &run->shared, NULL, &run->error);
  return status;
}

hk_status hk_run_make_plugins(hk_run *run) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR, HK_SOURCE, HK_OUTPUT};
  hk_status status = HK_OK;
  for (size_t k = 0; k < run->options.with_count && status == HK_OK; k++)
    status = hk_overrides_add(&run->overrides, run->scene, run->options.with[k], &run->error);
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds && status == HK_OK; k++) status = make_kind(run, kinds[k]);
  if (status != HK_OK) return status;
  return hk_plugins_add(&run->plugins, run->overrides.integrator, &run->shared, NULL, &run->error);
}

static hk_status check_groups(hk_run *run) {
  for (size_t k = 0; k < run->plugins.kind[HK_FORCE].count; k++) {
    const hk_plugin_spec *force = run->plugins.kind[HK_FORCE].item[k]->spec;
    bool found = !force->group;
    for (size_t g = 0; g < run->scene->particles.groups && !found; g++)
      found = strcmp(run->scene->particles.group_name[g], force->group) == 0;
    if (!found)
      return hk_error_set(&run->error, HK_BAD_PARAM, "%s: %s: group: no particle is in a group '%s'", force->where,
                          force->label, force->group);
  }
  return HK_OK;
}

hk_status hk_run_start_plugins(hk_run *run) {
  hk_status status = check_groups(run);
  return status == HK_OK ? hk_dynamics_start(&run->dynamics) : status;
}

/* ---- services that plugins ask for ---- */

static bool serves(const hk_plugin *plugin, const char *wanted) {
  return plugin->service->interface && strcmp(plugin->service->interface, wanted) == 0;
}

/* With the parameters that the scene gave; NULL: it names none of that interface. */
static const hk_plugin_spec *named_service(const hk_run *run, const char *wanted) {
  const hk_specs *named = &run->scene->plugin[HK_SERVICE];
  for (size_t k = 0; k < named->count; k++)
    if (serves(named->item[k]->plugin, wanted)) return named->item[k];
  return NULL;
}

static const void *table_of(const hk_instance *service) {
  const hk_service *functions = service->plugin->service;
  const hk_instance *outer = hk_enter(service);
  const void *table = functions->table ? functions->table(service->self) : NULL;
  hk_leave(service, outer);
  return table;
}

static const hk_plugin_spec *found_service(hk_run *run, const char *wanted) {
  char name[64];
  const hk_plugin *plugin;
  hk_error why = {0};
  snprintf(name, sizeof name, "%.*s", (int)strcspn(wanted, "/"), wanted);
  hk_status status = hk_registry_find(run->scene->registry, HK_SERVICE, name, false, &plugin, &why);
  if (status == HK_FAILED) hk_error_set(&run->error, status, "%s", why.text); /* it is there and cannot be used */
  if (status != HK_OK || !serves(plugin, wanted)) return NULL;
  hk_plugin_spec **grown = realloc(run->service_spec, (run->services + 1) * sizeof *grown);
  if (grown) run->service_spec = grown;
  hk_plugin_spec *spec = grown ? hk_spec_create(plugin, plugin->name, "", &run->error) : NULL;
  if (spec) run->service_spec[run->services++] = spec;
  return spec;
}

/* Each service has one instance per run, which is created and started at the first request. */
const void *hk_run_query(void *context, const char *wanted) {
  hk_run *run = context;
  if (strcmp(wanted, "checkpoint/1") == 0) return hk_run_checkpoints(run);
  if (strcmp(wanted, "interruption/1") == 0) return &run->interruption;
  if (strcmp(wanted, "draft/1") == 0) return &run->options.draft;
  if (strcmp(wanted, "strands/1") == 0) return &run->scene->strands;
  if (strcmp(wanted, "solvers/1") == 0) return hk_install_asked_solvers(&run->dynamics, run->overrides.solver);
  if (strcmp(wanted, "bodies/1") == 0) return hk_install_bodies(&run->dynamics);
  const hk_instances *services = &run->plugins.kind[HK_SERVICE];
  for (size_t k = 0; k < services->count; k++)
    if (serves(services->item[k]->plugin, wanted)) return table_of(services->item[k]);
  const hk_plugin_spec *spec = named_service(run, wanted);
  if (!spec) spec = found_service(run, wanted);
  hk_instance *service = NULL;
  if (!spec || hk_plugins_add(&run->plugins, spec, &run->shared, &service, &run->error) != HK_OK) return NULL;
  hk_view view = hk_instance_view(service, &run->state.view);
  if (hk_instance_start(service, &view, run->state.size, &run->error) != HK_OK) return NULL;
  return table_of(service);
}

void hk_warn_of_unused_services(hk_run *run) {
  const hk_specs *named = &run->scene->plugin[HK_SERVICE];
  const hk_instances *used = &run->plugins.kind[HK_SERVICE];
  for (size_t k = 0; k < named->count; k++) {
    bool asked = false;
    for (size_t j = 0; j < used->count; j++) asked |= used->item[j]->spec == named->item[k];
    if (!asked)
      hk_warn(&run->warnings, "%s%s%s: no plugin of the scene asks for this service", named->item[k]->where,
              *named->item[k]->where ? ": " : "", named->item[k]->label);
  }
}
