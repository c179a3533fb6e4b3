/* Parameters: checking the values of a script and storing them in the fields of the spec.
 *
 * The plugin's table is the only place that defines a name, a unit, a range or a default. A value is checked for type,
 * finiteness, range and indices before anything is written, so a refused value changes nothing. */
#include "core/host/host.h"
#include "core/base/base.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *param_name(const void *context, size_t k) {
  const hk_plugin *plugin = context;
  static const char *const common[] = {"label", "group", "only", "from", "to"};
  size_t own = 0;
  while (plugin->params && plugin->params[own].name) own++;
  if (k < own) return plugin->params[k].name;
  k -= own;
  size_t known = plugin->kind == HK_FORCE ? 5 : plugin->kind == HK_SOURCE ? 2 : 1;
  return k < known ? common[k] : NULL;
}

const hk_param *hk_spec_param(const hk_plugin_spec *spec, const char *name, hk_error *error) {
  for (const hk_param *p = spec->plugin->params; p && p->name; p++)
    if (strcmp(p->name, name) == 0) return p;
  const char *near = hk_nearest_name(name, param_name, spec->plugin);
  hk_error_set(error, HK_BAD_PARAM,
               near ? "%s: no parameter '%s'; did you mean '%s'?" : "%s: no parameter '%s'; see: hooke plugins %s",
               spec->label, name, near ? near : spec->plugin->name);
  return NULL;
}

static bool has_limits(const hk_param *p) { return p->min != 0 || p->max != 0; }

/* `position` 0: the value is not one of a list. */
static hk_status check_number(const char *label, const hk_param *p, double value, size_t position, hk_error *error) {
  char place[32] = "";
  if (position) snprintf(place, sizeof place, "[%zu]", position);
  const char *space = *p->unit ? " " : "";
  if (!isfinite(value))
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g is not a finite number", label, p->name, place, value);
  if (!has_limits(p) && !(p->flags & HK_ABOVE_MIN)) return HK_OK;
  if (value < p->min)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g%s%s is below the minimum %g", label, p->name, place, value,
                        space, p->unit, p->min);
  if (value == p->min && (p->flags & HK_ABOVE_MIN))
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: must be above %g%s%s", label, p->name, place, p->min, space,
                        p->unit);
  if (p->max > p->min && value > p->max)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g%s%s is above the maximum %g", label, p->name, place, value,
                        space, p->unit, p->max);
  return HK_OK;
}

hk_status hk_param_check_list(const char *label, const hk_param *p, const double *list, size_t count, hk_error *error) {
  for (size_t i = 0; i < count; i++) {
    hk_status status = check_number(label, p, list[i], i + 1, error);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

static hk_status wrong_type(const hk_plugin_spec *spec, const hk_param *p, const hk_value *value, const char *wanted,
                            hk_error *error) {
  static const char *const got[] = {"a number",          "a boolean",        "a string",
                                    "a list of numbers", "a list of tuples", "a function"};
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s: expected %s, got %s", spec->label, p->name, wanted,
                      got[value->kind]);
}

static hk_status no_memory(const hk_plugin_spec *spec, const hk_param *p, hk_error *error) {
  return hk_error_set(error, HK_NO_MEMORY, "%s: %s: no memory for the list", spec->label, p->name);
}

static hk_status set_number(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_NUMBER) return wrong_type(spec, p, value, "a number", error);
  hk_status status = check_number(spec->label, p, value->number, 0, error);
  if (status == HK_OK) *(double *)(void *)((char *)spec->values + p->offset) = value->number;
  return status;
}

static hk_status set_integer(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_NUMBER) return wrong_type(spec, p, value, "an integer", error);
  hk_status status = check_number(spec->label, p, value->number, 0, error);
  if (status != HK_OK) return status;
  if (floor(value->number) != value->number || fabs(value->number) > 9007199254740992.0)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s: %g is not an integer", spec->label, p->name, value->number);
  *(int64_t *)(void *)((char *)spec->values + p->offset) = (int64_t)value->number;
  return HK_OK;
}

static hk_status set_string(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_STRING) return wrong_type(spec, p, value, "a string", error);
  size_t bytes = strlen(value->text) + 1;
  char *copy = hk_memory_get(&spec->blocks, bytes);
  if (!copy) return no_memory(spec, p, error);
  memcpy(copy, value->text, bytes);
  *(const char **)(void *)((char *)spec->values + p->offset) = copy;
  return HK_OK;
}

static hk_status set_choice(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_STRING) return wrong_type(spec, p, value, "a string", error);
  size_t length = strlen(value->text);
  const char *choice = p->text;
  for (int k = 0; *choice; k++) {
    size_t end = strcspn(choice, "|");
    if (end == length && memcmp(choice, value->text, length) == 0) {
      *(int *)(void *)((char *)spec->values + p->offset) = k;
      return HK_OK;
    }
    choice += end + (choice[end] == '|');
  }
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s: '%s' is not one of %s", spec->label, p->name, value->text, p->text);
}

static hk_status set_vector(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_LIST) return wrong_type(spec, p, value, "a list of three numbers", error);
  if (value->count != 3)
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s: expected three numbers, got %zu", spec->label, p->name,
                        value->count);
  hk_status status = hk_param_check_list(spec->label, p, value->list, 3, error);
  if (status == HK_OK) memcpy((char *)spec->values + p->offset, value->list, 3 * sizeof(double));
  return status;
}

/* A copy of the value's numbers in the instance's memory. */
static hk_status copy_numbers(hk_plugin_spec *spec, const hk_param *p, const double *list, size_t count, double **copy,
                              hk_error *error) {
  hk_status status = hk_param_check_list(spec->label, p, list, count, error);
  if (status != HK_OK) return status;
  *copy = hk_memory_get(&spec->blocks, count * sizeof **copy);
  if (!*copy) return no_memory(spec, p, error);
  if (count) memcpy(*copy, list, count * sizeof **copy);
  return HK_OK;
}

static hk_status set_numbers(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  if (value->kind != HK_VALUE_LIST) return wrong_type(spec, p, value, "a list of numbers", error);
  double *copy;
  hk_status status = copy_numbers(spec, p, value->list, value->count, &copy, error);
  if (status == HK_OK) *(hk_numbers *)(void *)((char *)spec->values + p->offset) = (hk_numbers){value->count, copy};
  return status;
}

static hk_status set_per_tuple(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  bool number = value->kind == HK_VALUE_NUMBER;
  if (!number && value->kind != HK_VALUE_LIST)
    return wrong_type(spec, p, value, "a number or a list with one number per tuple", error);
  if (number) {
    hk_status status = check_number(spec->label, p, value->number, 0, error);
    if (status != HK_OK) return status;
  }
  double *copy;
  size_t count = number ? 1 : value->count;
  hk_status status = copy_numbers(spec, p, number ? &value->number : value->list, count, &copy, error);
  if (status == HK_OK) *(hk_per_tuple *)(void *)((char *)spec->values + p->offset) = (hk_per_tuple){count, copy};
  return status;
}

/* "{u, v}" */
static void print_tuple(char *text, size_t size, const uint32_t *tuple, unsigned arity) {
  size_t used = 0;
  for (unsigned c = 0; c < arity && used < size; c++)
    used += (size_t)snprintf(text + used, size - used, "%s%u", c ? ", " : "{", tuple[c]);
  if (used < size) snprintf(text + used, size - used, "}");
}

static hk_status no_particle(const hk_plugin_spec *spec, const hk_param *p, const uint32_t *tuple, unsigned arity,
                             unsigned member, size_t position, size_t n, hk_error *error) {
  char text[64];
  print_tuple(text, sizeof text, tuple, arity);
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s[%zu] = %s: there is no particle %u (ids are 1 to %zu)", spec->label,
                      p->name, position, text, tuple[member], n);
}

static hk_status check_tuple(const hk_plugin_spec *spec, const hk_param *p, const uint32_t *tuple, unsigned arity,
                             size_t position, size_t n, hk_error *error) {
  for (unsigned c = 0; c < arity; c++) {
    if (tuple[c] < 1 || tuple[c] > n) return no_particle(spec, p, tuple, arity, c, position, n, error);
    for (unsigned b = 0; b < c; b++)
      if (tuple[b] == tuple[c])
        return hk_error_set(error, HK_BAD_PARAM, "%s: %s[%zu] joins particle %u to itself", spec->label, p->name,
                            position, tuple[c]);
  }
  return HK_OK;
}

static hk_status set_particles(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, size_t n,
                               hk_error *error) {
  if (value->kind != HK_VALUE_LIST) return wrong_type(spec, p, value, "a list of particle ids", error);
  for (size_t i = 0; i < value->count; i++) {
    double id = value->list[i];
    if (!(id >= 1 && id <= (double)n && floor(id) == id))
      return hk_error_set(error, HK_BAD_PARAM, "%s: %s[%zu]: there is no particle %.15g (ids are 1 to %zu)",
                          spec->label, p->name, i + 1, id, n);
  }
  uint32_t *copy = hk_memory_get(&spec->blocks, value->count * sizeof *copy);
  if (!copy) return no_memory(spec, p, error);
  for (size_t i = 0; i < value->count; i++) copy[i] = (uint32_t)value->list[i] - 1;
  *(hk_tuples *)(void *)((char *)spec->values + p->offset) = (hk_tuples){value->count, 1, copy};
  return HK_OK;
}

static hk_status set_tuples(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, size_t n, hk_error *error) {
  static const char *const wanted[] = {"a list of edges, {{1, 2}, {2, 3}}", "a list of triangles, {{1, 2, 3}}",
                                       "a list of tetrahedra or hinges, {{1, 2, 3, 4}}"};
  unsigned arity = hk_param_arity(p);
  bool empty = value->kind == HK_VALUE_LIST && value->count == 0;
  if (!empty && (value->kind != HK_VALUE_TUPLES || value->arity != arity))
    return wrong_type(spec, p, value, wanted[arity - 2], error);
  for (size_t e = 0; e < value->count; e++) {
    hk_status status = check_tuple(spec, p, value->tuples + arity * e, arity, e + 1, n, error);
    if (status != HK_OK) return status;
  }
  uint32_t *copy = hk_memory_get(&spec->blocks, value->count * arity * sizeof *copy);
  if (!copy) return no_memory(spec, p, error);
  for (size_t e = 0; e < value->count * arity; e++) copy[e] = value->tuples[e] - 1;
  *(hk_tuples *)(void *)((char *)spec->values + p->offset) = (hk_tuples){value->count, arity, copy};
  return HK_OK;
}

static hk_status set_timed(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, hk_error *error) {
  if (!(p->flags & HK_TIMED)) return wrong_type(spec, p, value, "a constant", error);
  hk_timed *grown = realloc(spec->timed, (spec->timed_count + 1) * sizeof *grown);
  if (!grown) return no_memory(spec, p, error);
  spec->timed = grown;
  spec->timed[spec->timed_count++] = (hk_timed){p, value->function};
  return HK_OK;
}

static hk_status set_field(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, size_t n, hk_error *error) {
  if (value->kind == HK_VALUE_FUNCTION) return set_timed(spec, p, value, error);
  switch (p->type) {
  case HK_NUMBER:
    return set_number(spec, p, value, error);
  case HK_INTEGER:
    return set_integer(spec, p, value, error);
  case HK_BOOLEAN:
    if (value->kind != HK_VALUE_BOOLEAN) return wrong_type(spec, p, value, "true or false", error);
    *(bool *)(void *)((char *)spec->values + p->offset) = value->boolean;
    return HK_OK;
  case HK_STRING:
    return set_string(spec, p, value, error);
  case HK_CHOICE:
    return set_choice(spec, p, value, error);
  case HK_VECTOR:
    return set_vector(spec, p, value, error);
  case HK_NUMBERS:
    return set_numbers(spec, p, value, error);
  case HK_PARTICLES:
    return set_particles(spec, p, value, n, error);
  case HK_EDGES:
  case HK_TRIANGLES:
  case HK_TETRAHEDRA:
    return set_tuples(spec, p, value, n, error);
  case HK_PER_TUPLE:
    return set_per_tuple(spec, p, value, error);
  }
  return hk_error_set(error, HK_FAILED, "%s: %s: parameter of unknown type %d", spec->label, p->name, (int)p->type);
}

hk_status hk_spec_set(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, size_t n, hk_error *error) {
  hk_status status = set_field(spec, p, value, n, error);
  if (status == HK_OK) spec->given[p - spec->plugin->params] = true;
  return status;
}

unsigned hk_param_arity(const hk_param *p) {
  return p->type >= HK_PARTICLES && p->type <= HK_TETRAHEDRA ? (unsigned)(p->type - HK_PARTICLES) + 1 : 0;
}

const hk_param *hk_param_list(const hk_plugin *plugin, const hk_param *per_tuple) {
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (hk_param_arity(p) && (!per_tuple->text || strcmp(per_tuple->text, p->name) == 0)) return p;
  return NULL;
}

static hk_status check_count(const hk_plugin_spec *spec, const hk_param *p, hk_error *error) {
  const hk_param *list = hk_param_list(spec->plugin, p);
  const hk_per_tuple *values = (const hk_per_tuple *)(const void *)((const char *)spec->values + p->offset);
  bool given = spec->given[p - spec->plugin->params]; /* an empty list says nothing of any tuple */
  if (!list || values->count == 1 || (values->count == 0 && !given)) return HK_OK;
  const hk_tuples *tuples = (const hk_tuples *)(const void *)((const char *)spec->values + list->offset);
  if (values->count == tuples->count) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s has %zu numbers for %zu %s", spec->label, p->name, values->count,
                      tuples->count, list->name);
}

hk_status hk_spec_check(const hk_plugin_spec *spec, hk_error *error) {
  for (const hk_param *p = spec->plugin->params; p && p->name; p++) {
    if ((p->flags & HK_REQUIRED) && !spec->given[p - spec->plugin->params])
      return hk_error_set(error, HK_BAD_PARAM, "%s: the parameter '%s' (%s) is required", spec->label, p->name,
                          p->help);
    hk_status status = p->type == HK_PER_TUPLE ? check_count(spec, p, error) : HK_OK;
    if (status != HK_OK) return status;
  }
  return HK_OK;
}
