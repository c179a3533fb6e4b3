/* The functions that a plugin calls through its host table. The table is the instance's first member, so a service
 * finds its instance by a cast. */
#include "core/engine/contract/contract.h"
#include "core/engine/host/host.h"

#include <stdio.h>
#include <string.h>

static hk_instance *instance_of(const hk_host *host) {
  union {
    const hk_host *constant;
    hk_instance *instance;
  } u = {.constant = host}; /* these functions may write to the instance, although plugins see a constant table */
  return u.instance;
}

/* Who called the function of a service that fails; NULL: the host, or it is not known. */
static const hk_instance *asker_of(const hk_instance *service) {
  const hk_instance *volatile *acting = service->shared->acting;
  const hk_instance *asker = acting && service->plugin->kind == HK_SERVICE ? *acting : NULL;
  return asker == service ? NULL : asker;
}

static hk_status host_fail(const hk_host *host, hk_status status, const char *format, ...) {
  hk_instance *instance = instance_of(host);
  const hk_instance *asker = asker_of(instance);
  char text[900];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (!*text) snprintf(text, sizeof text, "it failed without saying why");
  const char *separator = *instance->where ? ": " : "";
  hk_error *error = instance->shared->error;
  if (asker)
    return hk_error_set(error, status, "%s%s%s: %s: %s", asker->where, *asker->where ? ": " : "", asker->label,
                        instance->label, text);
  /* the message of an earlier attempt is replaced by that of the last one */
  if (instance->plugin->kind == HK_INTEGRATOR && error->status != HK_OK) {
    hk_error before = *error;
    *error = (hk_error){0};
    return hk_error_set(error, status, "%s%s%s: %s (first: %.400s)", instance->where, separator, instance->label, text,
                        before.text);
  }
  return hk_error_set(error, status, "%s%s%s: %s", instance->where, separator, instance->label, text);
}

hk_status hk_failure_explained(const hk_instance *instance, const char *function, hk_status status) {
  bool known = (unsigned)status <= HK_INTERRUPTED;
  const char *why = known ? "failed without saying why" : "returned a number that is no status";
  return hk_error_set(instance->shared->error, known ? status : HK_FAILED, "%s%s%s: the plugin's %s %s",
                      instance->where, *instance->where ? ": " : "", instance->label, function, why);
}

bool hk_survey(const hk_instance *instance) {
  hk_shared *shared = instance->shared;
  if (shared->disturber) return true;
  shared->surveys--;
  shared->disturbance = shared->disturbed();
  shared->disturber = shared->disturbance ? instance : NULL;
  return shared->disturber;
}

hk_status hk_disturbed(const hk_shared *shared) {
  const hk_instance *plugin = shared->disturber;
  return hk_error_set(shared->error, HK_FAILED, "%s%s%s: the plugin %s", plugin->where, *plugin->where ? ": " : "",
                      plugin->label, shared->disturbance);
}

static void host_warn(const hk_host *host, const char *format, ...) {
  hk_instance *instance = instance_of(host);
  char text[900];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (instance->shared->warnings)
    hk_warn(instance->shared->warnings, "%s%s%s: %s", instance->where, *instance->where ? ": " : "", instance->label,
            text);
}

static void *host_allocate(const hk_host *host, size_t bytes) {
  hk_instance *instance = instance_of(host);
  hk_shared *shared = instance->shared;
  if (shared->allocations_left == 0) return NULL;
  if (shared->allocations_left > 0) shared->allocations_left--;
  return hk_memory_get(&instance->blocks, bytes);
}

static void host_release(const hk_host *host, void *memory) { hk_memory_put(&instance_of(host)->blocks, memory); }

static void host_parallel_for(const hk_host *host, size_t count, size_t grain,
                              void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  if (count <= grain && count > 0)
    body(context, 0, count, 0);
  else
    hk_threads_for(instance_of(host)->shared->threads, count, grain, body, context);
}

static double host_random(const hk_host *host) { return hk_random_uniform(instance_of(host)->random); }

static hk_status host_path(const hk_host *host, const char *name, char *buffer, size_t size) {
  hk_shared *shared = instance_of(host)->shared;
  if (!shared->path) return host->fail(host, HK_IO, "'%s': this run has no output folder", name);
  return shared->path(shared->context, instance_of(host)->label, name, buffer, size);
}

static const void *host_query(const hk_host *host, const char *service) {
  hk_shared *shared = instance_of(host)->shared;
  return shared->query ? shared->query(shared->context, service) : NULL;
}

static const hk_field *array_field(const hk_instance *instance, const hk_array *array) {
  for (const hk_field *f = instance->plugin->fields; f && f->name; f++)
    if (f->array && hk_field_in(f, instance->self) == (const void *)array) return f;
  return NULL;
}

static hk_status host_resize(const hk_host *host, hk_array *array, size_t count) {
  const hk_field *field = array_field(instance_of(host), array);
  if (!field) return host->fail(host, HK_FAILED, "resize: this array is no field of the plugin");
  void *fresh = host_allocate(host, count * field->width);
  if (!fresh) return host->fail(host, HK_NO_MEMORY, "no memory for %zu items of '%s'", count, field->name);
  size_t kept = count < array->count ? count : array->count;
  if (kept) memcpy(fresh, array->item, kept * field->width);
  host_release(host, array->item);
  *array = (hk_array){count, fresh};
  return HK_OK;
}

static hk_status wrong_count(const hk_host *host, size_t got, const double *in, size_t n_in, size_t n_out) {
  return host->fail(host, HK_BAD_PARAM, "a function gave %zu numbers at t = %.9g s for particle %.0f, expected %zu",
                    got, in[0], in[n_in - 1], n_out);
}

static hk_status host_call(const hk_host *host, const hk_function *f, const double *in, size_t n_in, double *out,
                           size_t n_out) {
  size_t got = 0;
  hk_status status = f->call(f, NULL, in, n_in, out, n_out, &got, instance_of(host)->shared->error);
  if (status != HK_OK || got == n_out) return status;
  return wrong_count(host, got, in, n_in, n_out);
}

static hk_status host_call_each(const hk_host *host, const hk_function *f, const double *in, size_t n_in, double *out,
                                size_t n_out, size_t count) {
  hk_status status = HK_OK;
  size_t made = 0, got = n_out;
  if (f->each)
    status = f->each(f, in, n_in, out, n_out, count, &made, &got, instance_of(host)->shared->error);
  else
    for (; made < count && status == HK_OK; made++)
      status = host_call(host, f, in + made * n_in, n_in, out + made * n_out, n_out);
  if (status != HK_OK || got == n_out) return status;
  return wrong_count(host, got, in + made * n_in, n_in, n_out);
}

const hk_host hk_host_table = {.abi = HK_ABI,
                               .fail = host_fail,
                               .warn = host_warn,
                               .allocate = host_allocate,
                               .release = host_release,
                               .parallel_for = host_parallel_for,
                               .random = host_random,
                               .path = host_path,
                               .query = host_query,
                               .resize = host_resize,
                               .call = host_call,
                               .call_each = host_call_each};
