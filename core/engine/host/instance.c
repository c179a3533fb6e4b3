/* Instances: a copy of a spec's values with fields and the host's functions. An instance uses the spec's lists of
 * particles and tuples until particles are born or die; then it copies the lists and keeps the copies up to date. */
#include "core/engine/contract/contract.h"
#include "core/engine/host/host.h"

#include <stdlib.h>
#include <string.h>

_Thread_local const hk_instance *hk_acting_here;

static uint64_t stream_of(const hk_instance *instance) {
  uint64_t hash = 1469598103934665603u ^ instance->shared->seed; /* FNV-1a of kind and label */
  hash = (hash ^ (uint64_t)instance->plugin->kind) * 1099511628211u;
  for (const char *c = instance->label; *c; c++) hash = (hash ^ (unsigned char)*c) * 1099511628211u;
  return hash;
}

static void *copy_of(const void *from, size_t bytes) {
  void *copy = malloc(bytes + 1);
  if (copy && bytes) memcpy(copy, from, bytes);
  return copy;
}

hk_instance *hk_instance_create(const hk_plugin_spec *spec, hk_shared *shared, hk_error *error) {
  hk_instance *instance = calloc(1, sizeof *instance);
  if (!instance) goto no_memory;
  instance->host = hk_host_table;
  instance->host.lanes = shared->lanes < 2 ? 2 : shared->lanes;
  instance->shared = shared;
  instance->spec = spec;
  instance->plugin = spec->plugin;
  instance->label = spec->label;
  instance->where = spec->where;
  instance->self = hk_memory_get(&instance->blocks, spec->plugin->instance_size);
  if (!instance->self) goto no_memory;
  memcpy(instance->self, spec->values, spec->plugin->instance_size);
  instance->only_count = spec->only_count;
  if (spec->only) instance->only = copy_of(spec->only, spec->only_count * sizeof *spec->only);
  if (spec->only && !instance->only) goto no_memory;
  hk_random_seed(instance->random, stream_of(instance));
  return instance;
no_memory:
  hk_error_set(error, HK_NO_MEMORY, "%s: no memory for the plugin", spec->label);
  hk_instance_destroy(instance);
  return NULL;
}

void hk_instance_destroy(hk_instance *instance) {
  if (!instance) return;
  if (instance->started && instance->plugin->destroy) {
    const hk_instance *outer = hk_enter(instance);
    instance->plugin->destroy(instance->self, &instance->host);
    hk_leave(instance, outer);
  }
  if (instance->shared->acting && *instance->shared->acting == instance) *instance->shared->acting = NULL;
  hk_memory_clear(&instance->blocks);
  free(instance->only);
  free(instance->active);
  free(instance->is_active);
  free(instance);
}

hk_view hk_instance_view(const hk_instance *instance, const hk_view *scene) {
  hk_view view = *scene;
  view.host = &instance->host;
  view.active = instance->active;
  view.is_active = instance->is_active;
  view.acting = instance->is_active ? instance->acting : scene->n;
  return view;
}

hk_status hk_instance_start(hk_instance *instance, const hk_view *view, size_t size, hk_error *error) {
  const hk_plugin *plugin = instance->plugin;
  hk_status status = hk_fields_allocate(instance, view->n, size, error);
  if (status != HK_OK) return status;
  instance->started = true;
  const hk_instance *outer = hk_enter(instance);
  status = plugin->create ? plugin->create(instance->self, &instance->host, view) : HK_OK;
  return hk_leave_with(instance, outer, "create", status);
}

static void *field_of(const hk_instance *instance, const hk_param *p) { return hk_param_in(p, instance->self); }

static void *own_copy(hk_instance *instance, const void *list, size_t bytes) {
  void *copy = instance->host.allocate(&instance->host, bytes);
  if (copy && bytes) memcpy(copy, list, bytes);
  return copy;
}

/* Copies the lists of the spec, which must not change. */
static hk_status copy_lists(hk_instance *instance, hk_error *error) {
  for (const hk_param *p = instance->plugin->params; !instance->own_lists && p && p->name; p++) {
    hk_tuples *tuples = field_of(instance, p);
    hk_per_tuple *values = field_of(instance, p);
    bool fine = true;
    if (hk_param_arity(p))
      fine = (tuples->index = own_copy(instance, tuples->index, tuples->count * tuples->arity * sizeof(uint32_t)));
    if (p->per_tuple) fine = (values->value = own_copy(instance, values->value, values->count * 8));
    if (!fine) return hk_error_set(error, HK_NO_MEMORY, "%s: no memory for '%s'", instance->label, p->name);
  }
  instance->own_lists = true;
  return HK_OK;
}

/* In every HK_PER_TUPLE list of the tuples p, moves number e to position `to`; with SIZE_MAX it sets the length to
 * `e`. */
static void move_values(hk_instance *instance, const hk_param *p, size_t e, size_t to) {
  for (const hk_param *q = instance->plugin->params; q->name; q++) {
    hk_per_tuple *list = field_of(instance, q);
    if (!q->per_tuple || list->count <= 1 || hk_param_list(instance->plugin, q->list) != p) continue;
    if (to == SIZE_MAX)
      list->count = e;
    else
      list->value[to] = list->value[e];
  }
}

/* Removes tuples with dead members, and their numbers in the HK_PER_TUPLE lists and in fields. */
static void remap_tuples(hk_instance *instance, const hk_param *p, const uint32_t *map) {
  hk_tuples *tuples = field_of(instance, p);
  uint32_t *index = (uint32_t *)(uintptr_t)tuples->index; /* the host's own memory */
  size_t kept = 0, arity = tuples->arity;
  for (size_t e = 0; e < tuples->count; e++) {
    bool alive = true;
    for (size_t c = 0; c < arity; c++) alive = alive && map[index[arity * e + c]] != UINT32_MAX;
    if (!alive) continue;
    for (size_t c = 0; c < arity; c++) index[arity * kept + c] = map[index[arity * e + c]];
    hk_fields_move_tuple(instance, p, e, kept);
    move_values(instance, p, e, kept++);
  }
  move_values(instance, p, kept, SIZE_MAX);
  tuples->count = kept;
}

static void remap_selection(hk_instance *instance, const uint32_t *map) {
  size_t kept = 0;
  for (size_t k = 0; k < instance->only_count; k++)
    if (map[instance->only[k]] != UINT32_MAX) instance->only[kept++] = map[instance->only[k]];
  instance->only_count = kept;
}

hk_status hk_instance_renumber(hk_instance *instance, const uint32_t *map, hk_error *error) {
  hk_status status = copy_lists(instance, error);
  for (const hk_param *p = instance->plugin->params; status == HK_OK && p && p->name; p++)
    if (hk_param_arity(p)) remap_tuples(instance, p, map);
  if (status == HK_OK && instance->only) remap_selection(instance, map);
  return status;
}

hk_status hk_instance_remap(hk_instance *instance, const uint32_t *map, size_t n_old, const hk_view *view, size_t size,
                            hk_error *error) {
  hk_status status = hk_instance_renumber(instance, map, error);
  if (status == HK_OK) status = hk_fields_remap(instance, map, n_old, view->n, size, error);
  if (status == HK_OK) status = hk_instance_select(instance, view->model, error);
  if (status != HK_OK) return status;
  hk_view own = hk_instance_view(instance, view);
  const hk_instance *outer = hk_enter(instance);
  if (instance->plugin->topology) status = instance->plugin->topology(instance->self, &own);
  return hk_leave_with(instance, outer, "topology", status);
}

hk_status hk_instance_select(hk_instance *instance, const hk_model *model, hk_error *error) {
  const char *group = instance->spec->group;
  if (!instance->only && !group) return HK_OK;
  bool *mask = calloc(model->n + 1, sizeof *mask);
  uint32_t *active = malloc((model->n + 1) * sizeof *active);
  if (!mask || !active) {
    free(mask);
    free(active);
    return hk_error_set(error, HK_NO_MEMORY, "%s: no memory for the selection", instance->label);
  }
  for (size_t k = 0; k < instance->only_count; k++) mask[instance->only[k]] = true;
  size_t acting = 0;
  for (size_t i = 0; i < model->n; i++) {
    bool in_group = !group || strcmp(model->group_name[model->group[i]], group) == 0;
    mask[i] = in_group && (!instance->only || mask[i]);
    if (mask[i]) active[acting++] = (uint32_t)i;
  }
  free(instance->active);
  free(instance->is_active);
  instance->active = active;
  instance->is_active = mask;
  instance->acting = acting;
  return HK_OK;
}

hk_status hk_instance_set_time(hk_instance *instance, double t, hk_error *error) {
  for (size_t k = 0; k < instance->spec->timed_count; k++) {
    const hk_timed *timed = &instance->spec->timed[k];
    size_t wanted = timed->param->vector ? 3 : 1, got = 0;
    double value[3];
    hk_status status = timed->function.call(&timed->function, NULL, &t, 1, value, 3, &got, error);
    if (status != HK_OK) return status;
    if (got != wanted)
      return hk_error_set(error, HK_BAD_PARAM, "%s: %s: %s: the function gave %zu numbers at t = %g s, expected %zu",
                          instance->where, instance->label, timed->param->name, got, t, wanted);
    status = hk_param_check_list(instance->label, timed->param, value, wanted, error);
    if (status != HK_OK) return status;
    memcpy(field_of(instance, timed->param), value, wanted * sizeof(double));
  }
  return HK_OK;
}
