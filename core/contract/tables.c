/* The parameter table and the field table. Both end with a row without a name; where that row was forgotten, what
 * follows in memory is no row, and mostly not even memory. The fields that rows name are within the instance, aligned,
 * and no two share a byte, since each is written by the host alone. */
#include "core/contract/contract.h"

#include <stdalign.h>
#include <string.h>

typedef struct place { /* of a row's field in the instance */
  const char *name;
  size_t offset, size, alignment;
} place;

#define PLACE(type) sizeof(type), alignof(type)

static bool place_of_param(const hk_param *p, place *at) {
  static const struct {
    size_t size, alignment;
  } field[] = {[HK_NUMBER] = {PLACE(double)},
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
               [HK_FUNCTION] = {PLACE(const hk_function *)}};
  if ((unsigned)p->type >= sizeof field / sizeof *field) return false;
  *at = (place){p->name, p->offset, field[p->type].size, field[p->type].alignment};
  return true;
}

static bool place_of_field(const hk_field *f, place *at) {
  static const struct {
    size_t size, alignment;
  } field[] = {[HK_FIELD_NUMBER] = {PLACE(double)},
               [HK_FIELD_INTEGER] = {PLACE(int64_t)},
               [HK_FIELD_PER_PARTICLE] = {PLACE(double *)},
               [HK_FIELD_STATE] = {PLACE(double *)},
               [HK_FIELD_ARRAY] = {PLACE(hk_array)}};
  if ((unsigned)f->type >= sizeof field / sizeof *field) return false;
  *at = (place){f->name, f->offset, field[f->type].size, field[f->type].alignment};
  return true;
}

static bool fits(const hk_plugin *p, const char *what, const place *at, hk_reason_text *reason) {
  if (at->offset > p->instance_size || at->size > p->instance_size - at->offset)
    return hk_wrong(reason, "the %s '%s' lies outside the instance: bytes %zu to %zu of %zu", what, at->name,
                    at->offset, at->offset + at->size, p->instance_size);
  if (at->offset % at->alignment)
    return hk_wrong(reason, "the %s '%s' is at the odd offset %zu: use offsetof", what, at->name, at->offset);
  return true;
}

static bool apart(const place *a, const place *b, hk_reason_text *reason) {
  if (strcmp(a->name, b->name) == 0) return hk_wrong(reason, "two rows of its tables are called '%s'", a->name);
  if (a->offset + a->size <= b->offset || b->offset + b->size <= a->offset) return true;
  return hk_wrong(reason, "'%s' and '%s' fill the same bytes of the instance: look at their offsetof", a->name,
                  b->name);
}

/* ---- parameters ---- */

static size_t choices_of(const char *text) {
  size_t count = 1;
  for (; *text; text++) count += *text == '|';
  return count;
}

static unsigned is_list(const hk_param *p) { return p->type >= HK_PARTICLES && p->type <= HK_TETRAHEDRA; }

static bool names_a_list(const hk_plugin *plugin, const hk_param *per_tuple) {
  for (const hk_param *p = plugin->params; p->name; p++)
    if (is_list(p) && (!per_tuple->text || strcmp(per_tuple->text, p->name) == 0)) return true;
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
  if (p->type == HK_CHOICE && (!p->text || !*p->text))
    return hk_wrong(reason, "the parameter '%s' is a choice without choices: \"first|second\"", p->name);
  if (p->type == HK_CHOICE && !(p->initial[0] >= 0 && p->initial[0] < (double)choices_of(p->text)))
    return hk_wrong(reason, "the default of the parameter '%s', %g, is none of its choices, %s", p->name, p->initial[0],
                    p->text);
  if (p->type == HK_FUNCTION && !tells_arguments(p->text))
    return hk_wrong(reason,
                    "the text of the parameter '%s' has to be like \"function(t, x, id) -> f\" or \"function(t) -> f\"",
                    p->name);
  if (p->type == HK_PER_TUPLE && !names_a_list(plugin, p))
    return hk_wrong(reason, "the parameter '%s' has a number per tuple of '%s', which is no list of its parameters",
                    p->name, p->text ? p->text : "");
  return true;
}

static bool one_param(const hk_plugin *plugin, const hk_param *p, hk_reason_text *reason) {
  bool timed = p->type == HK_NUMBER || p->type == HK_VECTOR;
  if (!p->unit || !p->help) return hk_wrong(reason, "the parameter '%s' lacks its unit (\"\": none) or help", p->name);
  if (reserved(plugin, p->name))
    return hk_wrong(reason, "'%s' cannot be a parameter: every %s has it", p->name,
                    plugin->kind == HK_FORCE ? "force" : "plugin");
  if (isnan(p->min) || isnan(p->max)) return hk_wrong(reason, "the limits of the parameter '%s' are NaN", p->name);
  if (p->flags & HK_TIMED && !timed)
    return hk_wrong(reason, "the parameter '%s' is HK_TIMED: only a number or a vector can be a function of t",
                    p->name);
  return text_of_param(plugin, p, reason);
}

/* Whether this row can be one at all: what follows a table that has no end is not. */
static bool is_param(const hk_param *p) {
  return hk_loaded_word(p->name) && (!p->unit || hk_loaded_text(p->unit)) && (!p->help || hk_loaded_text(p->help));
}

static bool rows_of_params(const hk_plugin *plugin, hk_reason_text *reason) {
  place at, other;
  for (const hk_param *p = plugin->params; p; p++) {
    size_t row = (size_t)(p - plugin->params) + 1;
    if (!hk_loaded_memory(p, sizeof *p) || (p->name && !is_param(p)))
      return hk_wrong(reason, "its table of parameters has no end: row %zu is none; close it with {0}", row);
    if (!p->name) return true;
    if (!place_of_param(p, &at))
      return hk_wrong(reason, "the parameter '%s' is of the unknown type %d", p->name, (int)p->type);
    if (!fits(plugin, "parameter", &at, reason)) return false;
    for (const hk_param *q = plugin->params; q < p; q++)
      if (place_of_param(q, &other) && !apart(&other, &at, reason)) return false;
  }
  return true;
}

/* ---- fields ---- */

static bool one_field(const hk_field *f, hk_reason_text *reason) {
  bool scalar = f->type == HK_FIELD_NUMBER || f->type == HK_FIELD_INTEGER;
  if (!scalar && (f->width == 0 || f->width > 1 << 20))
    return hk_wrong(reason, "the field '%s' has the width %zu", f->name, f->width);
  if (f->flags & HK_PUBLISHED && f->type != HK_FIELD_PER_PARTICLE)
    return hk_wrong(reason, "the field '%s' is published and not per particle", f->name);
  return true;
}

static bool rows_of_fields(const hk_plugin *plugin, hk_reason_text *reason) {
  place at, other;
  for (const hk_field *f = plugin->fields; f; f++) {
    size_t row = (size_t)(f - plugin->fields) + 1;
    if (!hk_loaded_memory(f, sizeof *f) || (f->name && !hk_loaded_word(f->name)))
      return hk_wrong(reason, "its table of fields has no end: row %zu is none; close it with {0}", row);
    if (!f->name) return true;
    if (!place_of_field(f, &at))
      return hk_wrong(reason, "the field '%s' is of the unknown type %d", f->name, (int)f->type);
    if (!fits(plugin, "field", &at, reason) || !one_field(f, reason)) return false;
    for (const hk_field *g = plugin->fields; g < f; g++)
      if (place_of_field(g, &other) && !apart(&other, &at, reason)) return false;
    for (const hk_param *p = plugin->params; p && p->name; p++)
      if (place_of_param(p, &other) && !apart(&other, &at, reason)) return false;
  }
  return true;
}

bool hk_contract_tables(const hk_plugin *plugin, hk_reason_text *reason) {
  if (!rows_of_params(plugin, reason)) return false;
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (!one_param(plugin, p, reason)) return false;
  return rows_of_fields(plugin, reason);
}
