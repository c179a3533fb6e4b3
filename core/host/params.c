/* Parameters: from what the script wrote to the field of the instance.
 *
 * The plugin's table is the only place where a name, a unit, a range or a default stands. A value is checked for type,
 * finiteness, range and indices before anything is written, so a refused value changes nothing. */
#include "core/host/instance.h"
#include "core/base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *param_name(const void *context, size_t k) {
  const hk_plugin *plugin = context;
  static const char *const common[] = {"label", "only", "group", "from", "to"};
  size_t own = 0;
  while (plugin->params && plugin->params[own].name) own++;
  if (k < own) return plugin->params[k].name;
  k -= own;
  if (plugin->kind != HK_FORCE) return k == 0 ? common[0] : NULL;
  return k < sizeof common / sizeof *common ? common[k] : NULL;
}

const hk_param *hk_instance_param(const hk_instance *instance, const char *name, hk_error *error) {
  for (const hk_param *p = instance->plugin->params; p && p->name; p++)
    if (strcmp(p->name, name) == 0) return p;
  const char *near = hk_nearest_name(name, param_name, instance->plugin);
  hk_error_set(error, HK_BAD_PARAM,
               near ? "%s: no parameter '%s'; did you mean '%s'?" : "%s: no parameter '%s'; see: hooke plugins %s",
               instance->label, name, near ? near : instance->plugin->name);
  return NULL;
}

static bool has_limits(const hk_param *p) { return p->min != 0 || p->max != 0; }

/* `position` 0: the value is not one of a list. */
static hk_status check_number(const hk_instance *instance, const hk_param *p, double value, size_t position,
                              hk_error *error) {
  char place[32] = "";
  if (position) snprintf(place, sizeof place, "[%zu]", position);
  const char *space = *p->unit ? " " : "";
  if (!isfinite(value))
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g is not a finite number", instance->label, p->name, place,
                        value);
  if (!has_limits(p) && !(p->flags & HK_ABOVE_MIN)) return HK_OK;
  if (value < p->min)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g%s%s is below the minimum %g", instance->label, p->name,
                        place, value, space, p->unit, p->min);
  if (value == p->min && (p->flags & HK_ABOVE_MIN))
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: must be above %g%s%s", instance->label, p->name, place, p->min,
                        space, p->unit);
  if (p->max > p->min && value > p->max)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g%s%s is above the maximum %g", instance->label, p->name,
                        place, value, space, p->unit, p->max);
  return HK_OK;
}

static hk_status check_list(const hk_instance *instance, const hk_param *p, const double *list, size_t count,
                            hk_error *error) {
  for (size_t i = 0; i < count; i++) {
    hk_status status = check_number(instance, p, list[i], i + 1, error);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

static hk_status wrong_type(const hk_instance *instance, const hk_param *p, const hk_value *value, const char *wanted,
                            hk_error *error) {
  static const char *const got[] = {"a number",          "a boolean",       "a string",
                                    "a list of numbers", "a list of edges", "a function"};
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s: expected %s, got %s", instance->label, p->name, wanted,
                      got[value->kind]);
}

static hk_status no_memory(const hk_instance *instance, const hk_param *p, hk_error *error) {
  return hk_error_set(error, HK_NO_MEMORY, "%s: %s: no memory for the list", instance->label, p->name);
}

static hk_status set_number(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_NUMBER) return wrong_type(instance, p, value, "a number", error);
  hk_status status = check_number(instance, p, value->number, 0, error);
  if (status == HK_OK) *(double *)(void *)((char *)instance->self + p->offset) = value->number;
  return status;
}

static hk_status set_integer(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_NUMBER) return wrong_type(instance, p, value, "an integer", error);
  hk_status status = check_number(instance, p, value->number, 0, error);
  if (status != HK_OK) return status;
  if (floor(value->number) != value->number || fabs(value->number) > 9007199254740992.0)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s: %g is not an integer", instance->label, p->name, value->number);
  *(int64_t *)(void *)((char *)instance->self + p->offset) = (int64_t)value->number;
  return HK_OK;
}

static hk_status set_string(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_STRING) return wrong_type(instance, p, value, "a string", error);
  size_t bytes = strlen(value->text) + 1;
  char *copy = instance->host.allocate(&instance->host, bytes);
  if (!copy) return no_memory(instance, p, error);
  memcpy(copy, value->text, bytes);
  *(const char **)(void *)((char *)instance->self + p->offset) = copy;
  return HK_OK;
}

static hk_status set_choice(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_STRING) return wrong_type(instance, p, value, "a string", error);
  size_t length = strlen(value->text);
  const char *choice = p->text;
  for (int k = 0; *choice; k++) {
    size_t end = strcspn(choice, "|");
    if (end == length && memcmp(choice, value->text, length) == 0) {
      *(int *)(void *)((char *)instance->self + p->offset) = k;
      return HK_OK;
    }
    choice += end + (choice[end] == '|');
  }
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s: '%s' is not one of %s", instance->label, p->name, value->text,
                      p->text);
}

static hk_status set_vector(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_LIST) return wrong_type(instance, p, value, "a list of three numbers", error);
  if (value->count != 3)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s: expected three numbers, got %zu", instance->label, p->name,
                        value->count);
  hk_status status = check_list(instance, p, value->list, 3, error);
  if (status == HK_OK) memcpy((char *)instance->self + p->offset, value->list, 3 * sizeof(double));
  return status;
}

/* A copy of the value's numbers in the instance's memory. */
static hk_status copy_numbers(hk_instance *instance, const hk_param *p, const double *list, size_t count, double **copy,
                              hk_error *error) {
  hk_status status = check_list(instance, p, list, count, error);
  if (status != HK_OK) return status;
  *copy = instance->host.allocate(&instance->host, count * sizeof **copy);
  if (!*copy) return no_memory(instance, p, error);
  if (count) memcpy(*copy, list, count * sizeof **copy);
  return HK_OK;
}

static hk_status set_numbers(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_LIST) return wrong_type(instance, p, value, "a list of numbers", error);
  double *copy;
  hk_status status = copy_numbers(instance, p, value->list, value->count, &copy, error);
  if (status == HK_OK) *(hk_numbers *)(void *)((char *)instance->self + p->offset) = (hk_numbers){value->count, copy};
  return status;
}

static hk_status set_per_edge(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  bool number = value->kind == HK_VALUE_NUMBER;
  if (!number && value->kind != HK_VALUE_LIST)
    return wrong_type(instance, p, value, "a number or a list with one number per edge", error);
  if (number) {
    hk_status status = check_number(instance, p, value->number, 0, error);
    if (status != HK_OK) return status;
  }
  double *copy;
  size_t count = number ? 1 : value->count;
  hk_status status = copy_numbers(instance, p, number ? &value->number : value->list, count, &copy, error);
  if (status == HK_OK) *(hk_per_edge *)(void *)((char *)instance->self + p->offset) = (hk_per_edge){count, copy};
  return status;
}

static hk_status set_particles(hk_instance *instance, const hk_param *p, const hk_value *value, size_t n,
                               hk_error *error) {
  if (value->kind != HK_VALUE_LIST) return wrong_type(instance, p, value, "a list of particle ids", error);
  for (size_t i = 0; i < value->count; i++) {
    double id = value->list[i];
    if (!(id >= 1 && id <= (double)n && floor(id) == id))
      return hk_error_set(error, HK_BAD_PARAM, "%s: %s[%zu]: there is no particle %.15g (ids are 1 to %zu)",
                          instance->label, p->name, i + 1, id, n);
  }
  uint32_t *copy = instance->host.allocate(&instance->host, value->count * sizeof *copy);
  if (!copy) return no_memory(instance, p, error);
  for (size_t i = 0; i < value->count; i++) copy[i] = (uint32_t)value->list[i] - 1;
  *(hk_particles *)(void *)((char *)instance->self + p->offset) = (hk_particles){value->count, copy};
  return HK_OK;
}

static hk_status set_edges(hk_instance *instance, const hk_param *p, const hk_value *value, size_t n, hk_error *error) {
  bool empty = value->kind == HK_VALUE_LIST && value->count == 0;
  if (value->kind != HK_VALUE_EDGES && !empty)
    return wrong_type(instance, p, value, "a list of edges, {{1, 2}, {2, 3}}", error);
  for (size_t e = 0; e < value->count; e++) {
    uint32_t i = value->edges[e][0], j = value->edges[e][1];
    if (i < 1 || i > n || j < 1 || j > n)
      return hk_error_set(error, HK_BAD_PARAM, "%s: %s[%zu] = {%u, %u}: there is no particle %u (ids are 1 to %zu)",
                          instance->label, p->name, e + 1, i, j, i < 1 || i > n ? i : j, n);
    if (i == j)
      return hk_error_set(error, HK_BAD_PARAM, "%s: %s[%zu] joins particle %u to itself", instance->label, p->name,
                          e + 1, i);
  }
  uint32_t(*copy)[2] = instance->host.allocate(&instance->host, value->count * sizeof *copy);
  if (!copy) return no_memory(instance, p, error);
  for (size_t e = 0; e < value->count; e++) {
    copy[e][0] = value->edges[e][0] - 1;
    copy[e][1] = value->edges[e][1] - 1;
  }
  *(hk_edges *)(void *)((char *)instance->self + p->offset) = (hk_edges){value->count, (const uint32_t(*)[2])copy};
  return HK_OK;
}

static hk_status set_timed(hk_instance *instance, const hk_param *p, const hk_value *value, hk_error *error) {
  if (!(p->flags & HK_TIMED)) return wrong_type(instance, p, value, "a constant", error);
  hk_timed *grown = realloc(instance->timed, (instance->timed_count + 1) * sizeof *grown);
  if (!grown) return no_memory(instance, p, error);
  instance->timed = grown;
  instance->timed[instance->timed_count++] = (hk_timed){p, value->function};
  return HK_OK;
}

static hk_status set_field(hk_instance *instance, const hk_param *p, const hk_value *value, size_t n, hk_error *error) {
  if (value->kind == HK_VALUE_FUNCTION) return set_timed(instance, p, value, error);
  switch (p->type) {
  case HK_NUMBER:
    return set_number(instance, p, value, error);
  case HK_INTEGER:
    return set_integer(instance, p, value, error);
  case HK_BOOLEAN:
    if (value->kind != HK_VALUE_BOOLEAN) return wrong_type(instance, p, value, "true or false", error);
    *(bool *)(void *)((char *)instance->self + p->offset) = value->boolean;
    return HK_OK;
  case HK_STRING:
    return set_string(instance, p, value, error);
  case HK_CHOICE:
    return set_choice(instance, p, value, error);
  case HK_VECTOR:
    return set_vector(instance, p, value, error);
  case HK_NUMBERS:
    return set_numbers(instance, p, value, error);
  case HK_PARTICLES:
    return set_particles(instance, p, value, n, error);
  case HK_EDGES:
    return set_edges(instance, p, value, n, error);
  case HK_PER_EDGE:
    return set_per_edge(instance, p, value, error);
  }
  return hk_error_set(error, HK_FAILED, "%s: %s: parameter of unknown type %d", instance->label, p->name, (int)p->type);
}

hk_status hk_instance_set(hk_instance *instance, const hk_param *p, const hk_value *value, size_t n, hk_error *error) {
  hk_status status = set_field(instance, p, value, n, error);
  if (status == HK_OK) instance->given[p - instance->plugin->params] = true;
  return status;
}

const hk_edges *hk_instance_edges(const hk_instance *instance) {
  for (const hk_param *p = instance->plugin->params; p && p->name; p++)
    if (p->type == HK_EDGES) return (const hk_edges *)(const void *)((const char *)instance->self + p->offset);
  return NULL;
}

hk_status hk_instance_check(hk_instance *instance, hk_error *error) {
  const hk_edges *edges = hk_instance_edges(instance);
  for (const hk_param *p = instance->plugin->params; p && p->name; p++) {
    bool given = instance->given[p - instance->plugin->params];
    if ((p->flags & HK_REQUIRED) && !given)
      return hk_error_set(error, HK_BAD_PARAM, "%s: the parameter '%s' (%s) is required", instance->label, p->name,
                          p->help);
    if (p->type != HK_PER_EDGE) continue;
    const hk_per_edge *list = (const hk_per_edge *)(const void *)((const char *)instance->self + p->offset);
    if (edges && list->count > 1 && list->count != edges->count)
      return hk_error_set(error, HK_BAD_PARAM, "%s: %s has %zu numbers for %zu edges", instance->label, p->name,
                          list->count, edges->count);
  }
  return HK_OK;
}

hk_status hk_instance_set_time(hk_instance *instance, double t, hk_error *error) {
  for (size_t k = 0; k < instance->timed_count; k++) {
    const hk_timed *timed = &instance->timed[k];
    size_t wanted = timed->param->type == HK_VECTOR ? 3 : 1, got = 0;
    double value[3];
    hk_status status = timed->function.call(&timed->function, &t, 1, value, 3, &got, error);
    if (status != HK_OK) return status;
    if (got != wanted)
      return hk_error_set(error, HK_BAD_PARAM, "%s: %s: %s: the function gave %zu numbers at t = %g s, expected %zu",
                          instance->where, instance->label, timed->param->name, got, t, wanted);
    status = check_list(instance, timed->param, value, wanted, error);
    if (status != HK_OK) return status;
    memcpy((char *)instance->self + timed->param->offset, value, wanted * sizeof(double));
  }
  return HK_OK;
}
