/* The evolving data of an instance, described by its field table: their memory, their remapping after births and
 * deaths (of what belongs to tuples, one by one with them: instance.c), and the visit of all fields that writes and
 * reads checkpoints. */
#include "core/engine/contract/contract.h"
#include "core/engine/host/host.h"

#include <string.h>

static void *field_at(const hk_instance *instance, const hk_field *f) { return hk_field_in(f, instance->self); }

static bool is_vector(const hk_field *f) { return f->state || f->per_particle || f->per_tuple; }

static size_t tuples_of(const hk_instance *instance, const hk_field *f) {
  const hk_tuples *list = hk_param_in(hk_param_list(instance->plugin, f->list), instance->self);
  return list->count;
}

static size_t length_of(const hk_instance *instance, const hk_field *f, size_t n, size_t size) {
  return f->width * (f->per_tuple ? tuples_of(instance, f) : f->state ? size : n);
}

static hk_status no_memory(const hk_instance *instance, const hk_field *f, hk_error *error) {
  return hk_error_set(error, HK_NO_MEMORY, "%s: no memory for '%s'", instance->label, f->name);
}

hk_status hk_fields_allocate(hk_instance *instance, size_t n, size_t size, hk_error *error) {
  for (const hk_field *f = instance->plugin->fields; f && f->name; f++) {
    if (!is_vector(f)) continue;
    double **vector = field_at(instance, f);
    *vector = instance->host.allocate(&instance->host, length_of(instance, f, n, size) * sizeof **vector);
    if (!*vector) return no_memory(instance, f, error);
  }
  return HK_OK;
}

/* In place where the memory is enough. What is newborn is zero; a state vector is left as it is. */
static hk_status remap_field(hk_instance *instance, const hk_field *f, const uint32_t *map, size_t n_old, size_t n,
                             size_t size, hk_error *error) {
  double **vector = field_at(instance, f), *old = *vector, *fresh = old;
  size_t length = length_of(instance, f, n, size);
  bool grows = length * sizeof *fresh > hk_memory_size(old);
  if (grows) fresh = instance->host.allocate(&instance->host, (length + length / 8) * sizeof *fresh);
  if (!fresh) return no_memory(instance, f, error);
  if (f->per_particle) {
    size_t kept = f->width * hk_array_move(fresh, old, f->width * sizeof *old, map, n_old);
    memset(fresh + kept, 0, (length - kept) * sizeof *fresh);
  }
  if (grows) instance->host.release(&instance->host, old);
  *vector = fresh;
  return HK_OK;
}

hk_status hk_fields_remap(hk_instance *instance, const uint32_t *map, size_t n_old, size_t n, size_t size,
                          hk_error *error) {
  hk_status status = HK_OK;
  for (const hk_field *f = instance->plugin->fields; f && f->name && status == HK_OK; f++)
    if (is_vector(f) && !f->per_tuple) status = remap_field(instance, f, map, n_old, n, size, error);
  return status;
}

void hk_fields_move_tuple(hk_instance *instance, const hk_param *list, size_t from, size_t to) {
  if (!instance->started || from == to) return;
  for (const hk_field *f = instance->plugin->fields; f && f->name; f++) {
    if (!f->per_tuple || hk_param_list(instance->plugin, f->list) != list) continue;
    double *values = *(double **)field_at(instance, f);
    memcpy(values + f->width * to, values + f->width * from, f->width * sizeof *values);
  }
}

static bool visit_array(hk_instance *instance, const hk_field *f, bool (*visit)(void *, void *, size_t),
                        void *context) {
  hk_array *array = field_at(instance, f);
  uint64_t count = array->count;
  if (!visit(context, &count, sizeof count) || (count != array->count && f->flags & HK_COUNTED)) return false;
  if (count != array->count && (count > SIZE_MAX / (f->width + 1) || !visit(context, NULL, (size_t)count * f->width) ||
                                instance->host.resize(&instance->host, array, (size_t)count) != HK_OK))
    return false;
  return visit(context, array->item, array->count * f->width);
}

/* No run counts to 2^53: it is a damaged checkpoint's, with which counting on would overflow. */
static bool is_absurd(int64_t count) { return count > INT64_C(1) << 53 || count < -(INT64_C(1) << 53); }

bool hk_fields_visit(hk_instance *instance, size_t n, size_t size,
                     bool (*visit)(void *context, void *data, size_t bytes), void *context) {
  bool fine = true;
  for (const hk_field *f = instance->plugin->fields; f && f->name && fine; f++) {
    if (f->flags & HK_SCRATCH) continue;
    if (f->array)
      fine = visit_array(instance, f, visit, context);
    else if (is_vector(f))
      fine = visit(context, *(double **)field_at(instance, f), length_of(instance, f, n, size) * sizeof(double));
    else
      fine = visit(context, field_at(instance, f), 8) && !(f->integer && is_absurd(*(int64_t *)field_at(instance, f)));
  }
  return fine;
}
