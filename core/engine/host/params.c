/* Parameters: checking the values of a script and storing them in the fields of the spec.
 *
 * The plugin's table is the only place that defines a name, a unit, a range or a default. A value is checked for type,
 * finiteness, range and indices before anything is written, so a refused value changes nothing. */
#include "core/engine/base/base.h"
#include "core/engine/contract/contract.h"
#include "core/engine/host/host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const hk_param *hk_spec_param(const hk_plugin_spec *spec, const char *name, hk_error *error) {
  for (const hk_param *p = spec->plugin->params; p && p->name; p++)
    if (strcmp(p->name, name) == 0) return p;
  hk_error_set(error, HK_BAD_PARAM, "%s: no parameter '%s'; see: hooke plugins %s", spec->label, name,
               spec->plugin->name);
  return NULL;
}

/* `position` 0: the value is not one of a list. */
static hk_status check_number(const char *label, const hk_param *p, double value, size_t position, hk_error *error) {
  char place[32] = "";
  if (position) snprintf(place, sizeof place, "[%zu]", position);
  const char *space = *p->unit ? " " : "";
  if (!isfinite(value))
    return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g is not a finite number: give one", label, p->name, place,
                        value);
  const hk_range *l = &p->limits;
  bool excluded = l->kind == HK_LEAST_EXCLUDED, low = value < l->least || (excluded && value == l->least);
  if (l->kind == HK_NO_LIMITS || !(low || value > l->most)) return HK_OK;
  const char *relation = !low ? "above the maximum" : excluded ? "not above" : "below the minimum";
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s%s: %g%s%s is %s %g: give %s%s", label, p->name, place, value, space,
                      p->unit, relation, low ? l->least : l->most,
                      !low       ? "that or less"
                      : excluded ? "more"
                                 : "that or more",
                      p->flags & HK_OPTIONAL ? ", or leave it out" : "");
}

hk_status hk_param_check_list(const char *label, const hk_param *p, const double *list, size_t count, hk_error *error) {
  for (size_t i = 0; i < count; i++) {
    hk_status status = check_number(label, p, list[i], i + 1, error);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

/* What is written where: a value of the script for the parameter p of the spec. */
typedef struct setting {
  hk_plugin_spec *spec;
  const hk_param *p;
  const hk_value *value;
  size_t n; /* of particles */
  hk_error *error;
} setting;

static hk_status wrong_type(const setting *s, const char *wanted) {
  static const char *const got[] = {"a number",          "a boolean",        "a string",
                                    "a list of numbers", "a list of tuples", "a function"};
  return hk_error_set(s->error, HK_BAD_PARAM, "%s: %s: expected %s, got %s", s->spec->label, s->p->name, wanted,
                      got[s->value->kind]);
}

static hk_status no_memory(const setting *s) {
  return hk_error_set(s->error, HK_NO_MEMORY, "%s: %s: no memory for it", s->spec->label, s->p->name);
}

static void *field_of(const setting *s) { return hk_param_in(s->p, s->spec->values); }

static hk_status set_number(const setting *s) {
  if (s->value->kind != HK_VALUE_NUMBER) return wrong_type(s, "a number");
  hk_status status = check_number(s->spec->label, s->p, s->value->number, 0, s->error);
  if (status == HK_OK) *(double *)field_of(s) = s->value->number;
  return status;
}

static hk_status set_integer(const setting *s) {
  double number = s->value->number;
  if (s->value->kind != HK_VALUE_NUMBER) return wrong_type(s, "an integer");
  hk_status status = check_number(s->spec->label, s->p, number, 0, s->error);
  if (status != HK_OK) return status;
  if (floor(number) != number || fabs(number) > 9007199254740992.0)
    return hk_error_set(s->error, HK_BAD_PARAM, "%s: %s: %g is not an integer", s->spec->label, s->p->name, number);
  *(int64_t *)field_of(s) = (int64_t)number;
  return HK_OK;
}

static hk_status set_boolean(const setting *s) {
  if (s->value->kind != HK_VALUE_BOOLEAN) return wrong_type(s, "true or false");
  *(bool *)field_of(s) = s->value->boolean;
  return HK_OK;
}

static hk_status set_string(const setting *s) {
  if (s->value->kind != HK_VALUE_STRING) return wrong_type(s, "a string");
  size_t bytes = strlen(s->value->text) + 1;
  char *copy = hk_memory_get(&s->spec->blocks, bytes);
  if (!copy) return no_memory(s);
  memcpy(copy, s->value->text, bytes);
  *(const char **)field_of(s) = copy;
  return HK_OK;
}

static hk_status set_choice(const setting *s) {
  if (s->value->kind != HK_VALUE_STRING) return wrong_type(s, "a string");
  const char *choice = s->p->text, *text = s->value->text;
  size_t length = strlen(text);
  for (int k = 0; *choice; k++) {
    size_t end = strcspn(choice, "|");
    if (end == length && memcmp(choice, text, length) == 0) {
      *(int *)field_of(s) = k;
      return HK_OK;
    }
    choice += end + (choice[end] == '|');
  }
  return hk_error_set(s->error, HK_BAD_PARAM, "%s: %s: '%s' is not one of %s", s->spec->label, s->p->name, text,
                      s->p->text);
}

static hk_status set_vector(const setting *s) {
  if (s->value->kind != HK_VALUE_LIST) return wrong_type(s, "a list of three numbers");
  if (s->value->count != 3)
    return hk_error_set(s->error, HK_BAD_PARAM, "%s: %s: expected three numbers, got %zu", s->spec->label, s->p->name,
                        s->value->count);
  hk_status status = hk_param_check_list(s->spec->label, s->p, s->value->list, 3, s->error);
  if (status == HK_OK) memcpy(field_of(s), s->value->list, 3 * sizeof(double));
  return status;
}

/* A copy of the numbers in the instance's memory. */
static hk_status copy_numbers(const setting *s, const double *list, size_t count, double **copy) {
  hk_status status = s->value->kind == HK_VALUE_NUMBER
                         ? check_number(s->spec->label, s->p, *list, 0, s->error)
                         : hk_param_check_list(s->spec->label, s->p, list, count, s->error);
  if (status != HK_OK) return status;
  *copy = hk_memory_get(&s->spec->blocks, count * sizeof **copy);
  if (!*copy) return no_memory(s);
  if (count) memcpy(*copy, list, count * sizeof **copy);
  return HK_OK;
}

static hk_status set_numbers(const setting *s) {
  if (s->value->kind != HK_VALUE_LIST) return wrong_type(s, "a list of numbers");
  double *copy;
  hk_status status = copy_numbers(s, s->value->list, s->value->count, &copy);
  if (status == HK_OK) *(hk_numbers *)field_of(s) = (hk_numbers){s->value->count, copy};
  return status;
}

static hk_status set_per_tuple(const setting *s) {
  bool number = s->value->kind == HK_VALUE_NUMBER;
  if (!number && s->value->kind != HK_VALUE_LIST) return wrong_type(s, "a number or a list with one number per tuple");
  double *copy;
  size_t count = number ? 1 : s->value->count;
  hk_status status = copy_numbers(s, number ? &s->value->number : s->value->list, count, &copy);
  if (status == HK_OK) *(hk_per_tuple *)field_of(s) = (hk_per_tuple){count, copy};
  return status;
}

/* "{u, v}" */
static void print_tuple(char *text, size_t size, const uint32_t *tuple, unsigned arity) {
  size_t used = 0;
  for (unsigned c = 0; c < arity && used < size; c++)
    used += (size_t)snprintf(text + used, size - used, "%s%u", c ? ", " : "{", tuple[c]);
  if (used < size) snprintf(text + used, size - used, "}");
}

static hk_status no_particle(const setting *s, const uint32_t *tuple, unsigned arity, unsigned member,
                             size_t position) {
  char text[64], known[64];
  print_tuple(text, sizeof text, tuple, arity);
  return hk_error_set(s->error, HK_BAD_PARAM, "%s: %s[%zu] = %s: there is no particle %u (%s)", s->spec->label,
                      s->p->name, position, text, tuple[member], hk_known_ids(known, s->n));
}

static hk_status check_tuple(const setting *s, const uint32_t *tuple, unsigned arity, size_t position) {
  for (unsigned c = 0; c < arity; c++) {
    if (tuple[c] < 1 || tuple[c] > s->n) return no_particle(s, tuple, arity, c, position);
    for (unsigned b = 0; b < c; b++)
      if (tuple[b] == tuple[c])
        return hk_error_set(s->error, HK_BAD_PARAM, "%s: %s[%zu] joins particle %u to itself", s->spec->label,
                            s->p->name, position, tuple[c]);
  }
  return HK_OK;
}

static hk_status set_particles(const setting *s) {
  const hk_value *value = s->value;
  if (value->kind != HK_VALUE_LIST) return wrong_type(s, "a list of particle ids");
  char known[64];
  for (size_t i = 0; i < value->count; i++) {
    double id = value->list[i];
    if (!(id >= 1 && id <= (double)s->n && floor(id) == id))
      return hk_error_set(s->error, HK_BAD_PARAM, "%s: %s[%zu]: there is no particle %.15g (%s)", s->spec->label,
                          s->p->name, i + 1, id, hk_known_ids(known, s->n));
  }
  uint32_t *copy = hk_memory_get(&s->spec->blocks, value->count * sizeof *copy);
  if (!copy) return no_memory(s);
  for (size_t i = 0; i < value->count; i++) copy[i] = (uint32_t)value->list[i] - 1;
  *(hk_tuples *)field_of(s) = (hk_tuples){value->count, 1, copy};
  return HK_OK;
}

static hk_status set_tuples(const setting *s) {
  static const char *const wanted[] = {"a list of edges, {{1, 2}, {2, 3}}", "a list of triangles, {{1, 2, 3}}",
                                       "a list of quadruples, {{1, 2, 3, 4}}"};
  const hk_value *value = s->value;
  unsigned arity = hk_param_arity(s->p);
  bool empty = value->kind == HK_VALUE_LIST && value->count == 0;
  if (!empty && (value->kind != HK_VALUE_TUPLES || value->arity != arity)) return wrong_type(s, wanted[arity - 2]);
  for (size_t e = 0; e < value->count; e++) {
    hk_status status = check_tuple(s, value->tuples + arity * e, arity, e + 1);
    if (status != HK_OK) return status;
  }
  uint32_t *copy = hk_memory_get(&s->spec->blocks, value->count * arity * sizeof *copy);
  if (!copy) return no_memory(s);
  for (size_t e = 0; e < value->count * arity; e++) copy[e] = value->tuples[e] - 1;
  *(hk_tuples *)field_of(s) = (hk_tuples){value->count, arity, copy};
  return HK_OK;
}

static hk_status set_function(const setting *s) {
  if (s->value->kind != HK_VALUE_FUNCTION) return wrong_type(s, s->p->text);
  hk_function *copy = hk_memory_get(&s->spec->blocks, sizeof *copy);
  if (!copy) return no_memory(s);
  *copy = s->value->function;
  *(const hk_function **)field_of(s) = copy;
  return HK_OK;
}

static hk_status set_timed(const setting *s) {
  hk_plugin_spec *spec = s->spec;
  if (hk_param_arity(s->p)) return wrong_type(s, "a list (a handle's functions are called: cloth:edges())");
  if (!(s->p->flags & HK_TIMED)) return wrong_type(s, "a constant");
  hk_timed *grown = realloc(spec->timed, (spec->timed_count + 1) * sizeof *grown);
  if (!grown) return no_memory(s);
  spec->timed = grown;
  spec->timed[spec->timed_count++] = (hk_timed){s->p, s->value->function};
  return HK_OK;
}

hk_status hk_spec_set(hk_plugin_spec *spec, const hk_param *p, const hk_value *value, size_t n, hk_error *error) {
  static hk_status (*const set[])(const setting *) = {
      [HK_NUMBER] = set_number,    [HK_INTEGER] = set_integer,     [HK_BOOLEAN] = set_boolean,
      [HK_STRING] = set_string,    [HK_CHOICE] = set_choice,       [HK_VECTOR] = set_vector,
      [HK_NUMBERS] = set_numbers,  [HK_PARTICLES] = set_particles, [HK_EDGES] = set_tuples,
      [HK_TRIANGLES] = set_tuples, [HK_TETRAHEDRA] = set_tuples,   [HK_PER_TUPLE] = set_per_tuple,
      [HK_FUNCTION] = set_function};
  const setting s = {spec, p, value, n, error};
  bool timed = value->kind == HK_VALUE_FUNCTION && !p->function;
  hk_status status = timed ? set_timed(&s) : set[hk_param_type(p)](&s);
  if (status == HK_OK) spec->given[p - spec->plugin->params] = true;
  return status;
}

unsigned hk_param_arity(const hk_param *p) {
  return p->particles ? 1 : p->edges ? 2 : p->triangles ? 3 : p->tetrahedra ? 4 : 0;
}

const hk_param *hk_param_list(const hk_plugin *plugin, const char *list) {
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (hk_param_arity(p) && (!list || strcmp(list, p->name) == 0)) return p;
  return NULL;
}

static hk_status check_count(const hk_plugin_spec *spec, const hk_param *p, hk_error *error) {
  const hk_param *list = hk_param_list(spec->plugin, p->list);
  const hk_per_tuple *values = hk_param_in(p, spec->values);
  bool given = spec->given[p - spec->plugin->params]; /* an empty list says nothing of any tuple */
  if (!list || values->count == 1 || (values->count == 0 && !given)) return HK_OK;
  const hk_tuples *tuples = hk_param_in(list, spec->values);
  if (values->count == tuples->count) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s has %zu numbers for %zu %s: give one, or one for each", spec->label,
                      p->name, values->count, tuples->count, list->name);
}

/* For the plugin an empty list is as one that is left out, which may mean all. */
static hk_status check_list(const hk_plugin_spec *spec, const hk_param *p, hk_error *error) {
  const hk_tuples *list = hk_param_in(p, spec->values);
  bool given = spec->given[p - spec->plugin->params];
  if (!given || list->count > 0 || !(p->flags & HK_NOT_EMPTY)) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "%s: %s is an empty list: name some; where it is left out, all are meant",
                      spec->label, p->name);
}

hk_status hk_spec_check(const hk_plugin_spec *spec, hk_error *error) {
  for (const hk_param *p = spec->plugin->params; p && p->name; p++) {
    if ((p->flags & HK_REQUIRED) && !spec->given[p - spec->plugin->params])
      return hk_error_set(error, HK_BAD_PARAM, "%s: the parameter '%s' (%s) is required", spec->label, p->name,
                          p->help);
    hk_status status = p->per_tuple        ? check_count(spec, p, error)
                       : hk_param_arity(p) ? check_list(spec, p, error)
                                           : HK_OK;
    if (status != HK_OK) return status;
  }
  return HK_OK;
}
