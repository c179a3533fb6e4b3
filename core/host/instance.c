/* Instances: memory, defaults and the host services that a plugin calls. The host table is the instance's first
 * member, so a service finds its instance by a cast. */
#include "core/host/instance.h"
#include "core/base/memory.h"
#include "core/base/random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static hk_instance *behind(const hk_host *host) {
  union {
    const hk_host *constant;
    hk_instance *instance;
  } u = {.constant = host}; /* services may write to the instance though plugins see a constant table */
  return u.instance;
}

static hk_status host_fail(const hk_host *host, hk_status status, const char *format, ...) {
  hk_instance *instance = behind(host);
  char text[900];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  const char *separator = *instance->where ? ": " : "";
  hk_error *error = instance->shared->error;
  if (instance->plugin->kind == HK_INTEGRATOR && error->status != HK_OK) { /* it has tried again since, and gives up */
    hk_error before = *error;
    *error = (hk_error){0};
    return hk_error_set(error, status, "%s%s%s: %s (first: %.400s)", instance->where, separator, instance->label, text,
                        before.text);
  }
  return hk_error_set(instance->shared->error, status, "%s%s%s: %s", instance->where, separator, instance->label, text);
}

static void host_warn(const hk_host *host, const char *format, ...) {
  hk_instance *instance = behind(host);
  char text[900], line[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  snprintf(line, sizeof line, "%s: %s", instance->label, text);
  if (instance->shared->warn) instance->shared->warn(instance->shared, line);
}

static void *host_allocate(const hk_host *host, size_t bytes) {
  hk_instance *instance = behind(host);
  hk_shared *shared = instance->shared;
  if (shared->allocations_left == 0) return NULL;
  if (shared->allocations_left > 0) shared->allocations_left--;
  return hk_memory_get(&instance->blocks, bytes);
}

static void host_release(const hk_host *host, void *memory) { hk_memory_put(&behind(host)->blocks, memory); }

static void host_parallel_for(const hk_host *host, size_t count, size_t grain,
                              void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  if (count <= grain && count > 0)
    body(context, 0, count, 0);
  else
    hk_threads_for(behind(host)->shared->threads, count, grain, body, context);
}

static double host_random(const hk_host *host) { return hk_random_uniform(behind(host)->random); }

static hk_status host_path(const hk_host *host, const char *name, char *buffer, size_t size) {
  hk_shared *shared = behind(host)->shared;
  if (!shared->path) return host->fail(host, HK_IO, "'%s': this run has no output folder", name);
  return shared->path(shared, name, buffer, size);
}

static const void *host_query(const hk_host *host, const char *service) {
  hk_shared *shared = behind(host)->shared;
  return shared->query ? shared->query(shared, service) : NULL;
}

static const hk_host host_table = {HK_ABI,      host_fail, host_warn, host_allocate, host_release, host_parallel_for,
                                   host_random, host_path, host_query};

static void *field_at(const hk_instance *instance, size_t offset) { return (char *)instance->self + offset; }

static size_t param_count(const hk_plugin *plugin) {
  size_t count = 0;
  while (plugin->params && plugin->params[count].name) count++;
  return count;
}

static hk_status set_default(hk_instance *instance, const hk_param *p, hk_error *error) {
  void *field = field_at(instance, p->offset);
  bool optional = p->flags & HK_OPTIONAL;
  switch (p->type) {
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
  case HK_PER_EDGE:
    if (!optional && !(p->flags & HK_REQUIRED)) {
      hk_value value = {.kind = HK_VALUE_NUMBER, .number = p->initial[0]};
      hk_status status = hk_instance_set(instance, p, &value, 0, error);
      instance->given[p - instance->plugin->params] = false;
      return status;
    }
    break;
  case HK_NUMBERS:
  case HK_PARTICLES:
  case HK_EDGES:
    break; /* empty, as the memory is zeroed */
  }
  return HK_OK;
}

static uint64_t stream_of(const hk_instance *instance) {
  uint64_t hash = 1469598103934665603u ^ instance->shared->seed; /* FNV-1a of kind and label */
  hash = (hash ^ (uint64_t)instance->plugin->kind) * 1099511628211u;
  for (const char *c = instance->label; *c; c++) hash = (hash ^ (unsigned char)*c) * 1099511628211u;
  return hash;
}

hk_instance *hk_instance_create(const hk_plugin *plugin, const char *label, const char *where, hk_shared *shared,
                                hk_error *error) {
  hk_instance *instance = calloc(1, sizeof *instance);
  if (!instance) goto no_memory;
  instance->host = host_table;
  instance->shared = shared;
  instance->plugin = plugin;
  instance->from = -INFINITY;
  instance->to = INFINITY;
  instance->self = hk_memory_get(&instance->blocks, plugin->instance_size);
  instance->label = hk_string_copy(label);
  instance->where = hk_string_copy(where ? where : "");
  instance->given = calloc(param_count(plugin) + 1, sizeof *instance->given);
  if (!instance->self || !instance->label || !instance->where || !instance->given) goto no_memory;
  hk_random_seed(instance->random, stream_of(instance));
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (set_default(instance, p, error) != HK_OK) goto no_memory;
  return instance;
no_memory:
  hk_error_set(error, HK_NO_MEMORY, "%s: no memory for the plugin", label);
  hk_instance_destroy(instance);
  return NULL;
}

void hk_instance_destroy(hk_instance *instance) {
  if (!instance) return;
  if (instance->started && instance->plugin->destroy) instance->plugin->destroy(instance->self, &instance->host);
  hk_memory_clear(&instance->blocks);
  free(instance->label);
  free(instance->where);
  free(instance->only);
  free(instance->group);
  free(instance->active);
  free(instance->is_active);
  free(instance->timed);
  free(instance->given);
  free(instance);
}

static size_t field_length(const hk_field *f, size_t n, size_t size) {
  return f->width * (f->type == HK_FIELD_STATE ? size : f->type == HK_FIELD_PER_PARTICLE ? n : 0);
}

static bool is_array(const hk_field *f) { return f->type == HK_FIELD_STATE || f->type == HK_FIELD_PER_PARTICLE; }

static hk_status no_fields(const hk_instance *instance, const hk_field *f, hk_error *error) {
  return hk_error_set(error, HK_NO_MEMORY, "%s: no memory for '%s'", instance->label, f->name);
}

hk_status hk_instance_start(hk_instance *instance, const hk_view *view, size_t size, hk_error *error) {
  const hk_plugin *plugin = instance->plugin;
  for (const hk_field *f = plugin->fields; f && f->name; f++) {
    if (!is_array(f)) continue;
    double **array = field_at(instance, f->offset);
    *array = instance->host.allocate(&instance->host, field_length(f, view->n, size) * sizeof **array);
    if (!*array) return no_fields(instance, f, error);
  }
  instance->started = true;
  hk_status status = plugin->create ? plugin->create(instance->self, &instance->host, view) : HK_OK;
  if (status != HK_OK)
    hk_error_set(error, status, "%s: %s: the plugin's create failed without saying why", instance->where,
                 instance->label);
  return status;
}

static hk_status remap_fields(hk_instance *instance, const uint32_t *map, size_t n_old, size_t n, size_t size,
                              hk_error *error) {
  for (const hk_field *f = instance->plugin->fields; f && f->name; f++) {
    if (!is_array(f)) continue;
    double **array = field_at(instance, f->offset), *old = *array;
    double *fresh = instance->host.allocate(&instance->host, field_length(f, n, size) * sizeof *fresh);
    if (!fresh) return no_fields(instance, f, error);
    for (size_t i = 0; f->type == HK_FIELD_PER_PARTICLE && i < n_old; i++)
      if (map[i] != UINT32_MAX) memcpy(fresh + f->width * map[i], old + f->width * i, f->width * sizeof *fresh);
    *array = fresh;
    instance->host.release(&instance->host, old);
  }
  return HK_OK;
}

/* Edges to the dead go, and with them their numbers in the lists per edge. */
static void remap_edges(hk_instance *instance, hk_edges *edges, const uint32_t *map) {
  uint32_t(*pair)[2] = (uint32_t(*)[2])(uintptr_t)edges->pair; /* the host's own memory */
  size_t kept = 0;
  for (size_t e = 0; e < edges->count; e++) {
    uint32_t i = map[pair[e][0]], j = map[pair[e][1]];
    if (i == UINT32_MAX || j == UINT32_MAX) continue;
    for (const hk_param *p = instance->plugin->params; p->name; p++) {
      hk_per_edge *list = field_at(instance, p->offset);
      if (p->type == HK_PER_EDGE && list->count > 1) list->value[kept] = list->value[e];
    }
    pair[kept][0] = i;
    pair[kept++][1] = j;
  }
  for (const hk_param *p = instance->plugin->params; p->name; p++) {
    hk_per_edge *list = field_at(instance, p->offset);
    if (p->type == HK_PER_EDGE && list->count > 1) list->count = kept;
  }
  edges->count = kept;
}

static size_t remap_indices(uint32_t *index, size_t count, const uint32_t *map) {
  size_t kept = 0;
  for (size_t k = 0; k < count; k++)
    if (map[index[k]] != UINT32_MAX) index[kept++] = map[index[k]];
  return kept;
}

hk_status hk_instance_remap(hk_instance *instance, const uint32_t *map, size_t n_old, const hk_view *view, size_t size,
                            hk_error *error) {
  for (const hk_param *p = instance->plugin->params; p && p->name; p++) {
    void *field = field_at(instance, p->offset);
    if (p->type == HK_EDGES) remap_edges(instance, field, map);
    if (p->type == HK_PARTICLES) {
      hk_particles *list = field;
      list->count = remap_indices((uint32_t *)(uintptr_t)list->index, list->count, map);
    }
  }
  if (instance->only) instance->only_count = remap_indices(instance->only, instance->only_count, map);
  hk_status status = remap_fields(instance, map, n_old, view->n, size, error);
  if (status == HK_OK) status = hk_instance_select(instance, view->model, error);
  if (status != HK_OK) return status;
  hk_view own = *view;
  own.host = &instance->host;
  own.acting = instance->is_active ? instance->acting : view->n;
  own.active = instance->active;
  own.is_active = instance->is_active;
  return instance->plugin->topology ? instance->plugin->topology(instance->self, &own) : HK_OK;
}

hk_status hk_instance_select(hk_instance *instance, const hk_model *model, hk_error *error) {
  if (!instance->only && !instance->group) return HK_OK;
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
    bool in_group = !instance->group || strcmp(model->group_name[model->group[i]], instance->group) == 0;
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
