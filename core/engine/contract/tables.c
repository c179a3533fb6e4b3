/* The parameter table and the field table. Both end with a row without a name; where that row was forgotten, what
 * follows in memory is no row, and mostly not even memory. The fields that rows name are within the instance, aligned,
 * and no two share a byte, since each is written by the host alone. */
#include "core/engine/contract/contract.h"

#include <stdalign.h>
#include <string.h>

typedef struct place_of_row { /* of a row's field in the instance */
  const char *name;
  size_t offset, size, alignment;
} place_of_row;

#define PLACE(type) sizeof(type), alignof(type)

static const struct {
  size_t size, alignment;
} member[] = {[HK_NUMBER] = {PLACE(double)},
              [HK_INTEGER] = {PLACE(int64_t)},
              [HK_BOOLEAN] = {PLACE(bool)},
              [HK_STRING] = {PLACE(const char *)},
              [HK_CHOICE] = {PLACE(int)},
              [HK_VECTOR] = {PLACE(double[3])},
              [HK_NUMBERS] = {PLACE(hk_numbers)},
              [HK_PARTICLES] = {PLACE(hk_tuples)},
              [HK_EDGES] = {PLACE(hk_tuples)},
              [HK_TRIANGLES] = {PLACE(hk_tuples)},
              [HK_TETRAHEDRA] = {PLACE(hk_tuples)},
              [HK_PER_TUPLE] = {PLACE(hk_per_tuple)},
              [HK_FUNCTION] = {PLACE(const hk_function *)},
              [HK_FIELD_PER_PARTICLE] = {PLACE(double *)},
              [HK_FIELD_STATE] = {PLACE(double *)},
              [HK_FIELD_ARRAY] = {PLACE(hk_array)},
              [HK_FIELD_PER_TUPLE] = {PLACE(double *)}};

static bool place(const char *name, hk_type type, const void *in_none, place_of_row *at) {
  if (type == HK_TYPES) return false;
  *at = (place_of_row){name, (size_t)(uintptr_t)in_none, member[type].size, member[type].alignment};
  return true;
}

static bool place_of_param(const hk_param *p, place_of_row *at) {
  return place(p->name, hk_param_type(p), hk_param_in(p, NULL), at);
}

static bool place_of_field(const hk_field *f, place_of_row *at) {
  return place(f->name, hk_field_type(f), hk_field_in(f, NULL), at);
}

static bool fits(const hk_plugin *p, const char *what, const place_of_row *at, hk_reason_text *reason) {
  if (at->offset > p->instance_size || at->size > p->instance_size - at->offset)
    return hk_wrong(reason, "the %s '%s' lies outside the instance: bytes %zu to %zu of %zu", what, at->name,
                    at->offset, at->offset + at->size, p->instance_size);
  if (at->offset % at->alignment)
    return hk_wrong(reason, "the %s '%s' is at the odd offset %zu: use HK_AT", what, at->name, at->offset);
  return true;
}

static bool apart(const place_of_row *a, const place_of_row *b, hk_reason_text *reason) {
  if (strcmp(a->name, b->name) == 0) return hk_wrong(reason, "two rows of its tables are called '%s'", a->name);
  if (a->offset + a->size <= b->offset || b->offset + b->size <= a->offset) return true;
  return hk_wrong(reason, "'%s' and '%s' fill the same bytes of the instance: look at their HK_AT", a->name, b->name);
}

/* ---- parameters ---- */

static size_t choices_of(const char *text) {
  size_t count = 1;
  for (; *text; text++) count += *text == '|';
  return count;
}

static bool is_list(const hk_param *p) { return p->particles || p->edges || p->triangles || p->tetrahedra; }

/* NULL: the first one. */
static bool names_a_list(const hk_plugin *plugin, const char *list) {
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (is_list(p) && (!list || strcmp(list, p->name) == 0)) return true;
  return false;
}

static bool reserved(const hk_plugin *plugin, const char *name) {
  static const char *const words[] = {"label", "only", "group", "from", "to"};
  for (size_t k = 0; k < (plugin->kind == HK_FORCE ? sizeof words / sizeof *words : 1); k++)
    if (strcmp(name, words[k]) == 0) return true;
  return false;
}

/* t first, and a particle's id last where there is more. */
static bool tells_arguments(const char *text) {
  if (!text) return false;
  if (strncmp(text, "function(t) -> ", strlen("function(t) -> ")) == 0) return true;
  return strncmp(text, "function(t, ", strlen("function(t, ")) == 0 && strstr(text, "id) -> ");
}

static bool text_of_param(const hk_plugin *plugin, const hk_param *p, hk_reason_text *reason) {
  if (p->text && !hk_loaded_text(p->text)) return hk_wrong(reason, "the text of the parameter '%s' is none", p->name);
  if (p->choice && (!p->choices || !*p->choices))
    return hk_wrong(reason, "the parameter '%s' is a choice without choices: \"first|second\"", p->name);
  if (p->choice && !(p->initial[0] >= 0 && p->initial[0] < (double)choices_of(p->choices)))
    return hk_wrong(reason, "the default of the parameter '%s', %g, is none of its choices, %s", p->name, p->initial[0],
                    p->choices);
  if (p->function && !tells_arguments(p->signature))
    return hk_wrong(reason,
                    "the text of the parameter '%s' has to be like \"function(t, x, id) -> f\" or \"function(t) -> f\"",
                    p->name);
  if (p->per_tuple && !names_a_list(plugin, p->list))
    return hk_wrong(reason, "the parameter '%s' has a number per tuple of '%s', which is no list of its parameters",
                    p->name, p->list ? p->list : "");
  return true;
}

static bool one_param(const hk_plugin *plugin, const hk_param *p, hk_reason_text *reason) {
  const hk_range *l = &p->limits;
  if (!p->unit || !p->help) return hk_wrong(reason, "the parameter '%s' lacks its unit (\"\": none) or help", p->name);
  if (reserved(plugin, p->name))
    return hk_wrong(reason, "'%s' cannot be a parameter: every %s has it", p->name,
                    plugin->kind == HK_FORCE ? "force" : "plugin");
  if (l->kind == HK_NO_LIMITS ? l->least != 0 || l->most != 0 : !(l->least <= l->most))
    return hk_wrong(reason, "the limits of the parameter '%s' are none: write .limits = HK_AT_LEAST(0), say", p->name);
  if (p->flags & HK_TIMED && !p->number && !p->vector)
    return hk_wrong(reason, "the parameter '%s' is HK_TIMED: only a number or a vector can be a function of t",
                    p->name);
  if (p->flags & HK_NOT_EMPTY && !p->particles && !p->edges && !p->triangles && !p->tetrahedra)
    return hk_wrong(reason, "the parameter '%s' is HK_NOT_EMPTY: only a list of particles or tuples can be empty",
                    p->name);
  return text_of_param(plugin, p, reason);
}

/* Whether this row can be one at all: what follows a table that has no end is not. */
static bool is_param(const hk_param *p) {
  return hk_loaded_word(p->name) && (!p->unit || hk_loaded_text(p->unit)) && (!p->help || hk_loaded_text(p->help));
}

static bool rows_of_params(const hk_plugin *plugin, hk_reason_text *reason) {
  place_of_row at, other;
  for (const hk_param *p = plugin->params; p; p++) {
    size_t row = (size_t)(p - plugin->params) + 1;
    if (!hk_loaded_memory(p, sizeof *p) || (p->name && !is_param(p)))
      return hk_wrong(reason, "its table of parameters has no end: row %zu is none; close it with {0}", row);
    if (!p->name) return true;
    if (!place_of_param(p, &at))
      return hk_wrong(reason, "the parameter '%s' fills %s: .number = HK_AT(instance, member), say", p->name,
                      "no member of the instance, or several");
    if (!fits(plugin, "parameter", &at, reason)) return false;
    for (const hk_param *q = plugin->params; q < p; q++)
      if (place_of_param(q, &other) && !apart(&other, &at, reason)) return false;
  }
  return true;
}

/* ---- fields ---- */

static bool one_field(const hk_plugin *plugin, const hk_field *f, hk_reason_text *reason) {
  bool scalar = f->number || f->integer;
  if (!scalar && (f->width == 0 || f->width > 1 << 20))
    return hk_wrong(reason, "the field '%s' has the width %zu", f->name, f->width);
  if (f->flags & HK_PUBLISHED && !f->per_particle)
    return hk_wrong(reason, "the field '%s' is published and not per particle", f->name);
  if (f->list && !hk_loaded_text(f->list)) return hk_wrong(reason, "the list of the field '%s' is no text", f->name);
  if (f->per_tuple && !names_a_list(plugin, f->list))
    return hk_wrong(reason, "the field '%s' is per tuple of '%s', which is no list of its parameters", f->name,
                    f->list ? f->list : "");
  if (f->list && !f->per_tuple)
    return hk_wrong(reason, "the field '%s' names the list '%s' and is not per tuple", f->name, f->list);
  return true;
}

/* The row lies apart from the rows before it and from the parameters. */
static bool alone(const hk_plugin *plugin, size_t k, const place_of_row *at, hk_reason_text *reason) {
  place_of_row other;
  for (size_t m = 0; m < k; m++) {
    const hk_field before = hk_field_row(plugin, m);
    if (place_of_field(&before, &other) && !apart(&other, at, reason)) return false;
  }
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (place_of_param(p, &other) && !apart(&other, at, reason)) return false;
  return true;
}

static bool rows_of_fields(const hk_plugin *plugin, hk_reason_text *reason) {
  place_of_row at;
  size_t size = hk_field_size(plugin->abi);
  for (size_t k = 0; plugin->fields; k++) {
    const char *here = (const char *)plugin->fields + k * size;
    bool there = hk_loaded_memory(here, size);
    const hk_field f = there ? hk_field_row(plugin, k) : (hk_field){0};
    if (!there || (f.name && !hk_loaded_word(f.name)))
      return hk_wrong(reason, "its table of fields has no end: row %zu is none; close it with {0}", k + 1);
    if (!f.name) return true;
    if (!place_of_field(&f, &at))
      return hk_wrong(reason, "the field '%s' keeps %s: .state = HK_AT(instance, member), say", f.name,
                      "no member of the instance, or several");
    if (!fits(plugin, "field", &at, reason) || !one_field(plugin, &f, reason) || !alone(plugin, k, &at, reason))
      return false;
  }
  return true;
}

bool hk_contract_tables(const hk_plugin *plugin, hk_reason_text *reason) {
  if (!rows_of_params(plugin, reason)) return false;
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (!one_param(plugin, p, reason)) return false;
  return rows_of_fields(plugin, reason);
}
