/* Conversion of Lua values to parameters: the plugin's table gives the type, hk_spec_set checks the value. The options
 * that every force has (only, group, from, to), and `fastest`, are set here; `label` was read before. */
#include "core/app/script/script.h"
#include "core/engine/base/base.h"
#include "core/engine/contract/contract.h"
#include "core/engine/text/text.h"

#include <stdlib.h>
#include <string.h>

double hk_lua_number(lua_State *L, int index, const char *what) {
  if (lua_type(L, index) != LUA_TNUMBER)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: expected a number, got a %s", what, luaL_typename(L, index));
  double value = lua_tonumber(L, index);
  if (!isfinite(value)) hk_lua_fail(L, HK_BAD_PARAM, "%s: %g is not a finite number", what, value);
  return value;
}

void hk_lua_vector(lua_State *L, int index, const char *what, double into[3]) {
  index = lua_absindex(L, index);
  if (!lua_istable(L, index) || lua_rawlen(L, index) != 3)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: expected three numbers, {x, y, z}", what);
  for (int c = 0; c < 3; c++) {
    lua_rawgeti(L, index, c + 1);
    into[c] = hk_lua_number(L, -1, what);
    lua_pop(L, 1);
  }
}

int hk_lua_field(lua_State *L, int table, const char *key) {
  table = lua_absindex(L, table);
  lua_pushstring(L, key);
  return lua_rawget(L, table);
}

void hk_lua_check_plain(lua_State *L, int index, const char *what) {
  if (luaL_getmetafield(L, index, "__index") != LUA_TNIL)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: fields from a metatable (__index) are not read: give the table its own", what);
}

static void name_field(char *name, size_t size, const char *what, const char *key) {
  snprintf(name, size, "%s: %s", what, key);
}

bool hk_lua_field_vector(lua_State *L, int table, const char *what, const char *key, double into[3]) {
  char name[128];
  name_field(name, sizeof name, what, key);
  bool there = hk_lua_field(L, table, key) != LUA_TNIL;
  if (there) hk_lua_vector(L, -1, name, into);
  lua_pop(L, 1);
  return there;
}

bool hk_lua_field_function(lua_State *L, int table, const char *what, const char *key, hk_function *function) {
  bool there = hk_lua_field(L, table, key) != LUA_TNIL;
  if (there && !lua_isfunction(L, -1)) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: expected a function of t", what, key);
  if (there) *function = hk_lua_function(L, lua_gettop(L));
  lua_pop(L, 1);
  return there;
}

double hk_lua_field_number(lua_State *L, int table, const char *what, const char *key, double otherwise) {
  char name[128];
  name_field(name, sizeof name, what, key);
  double value = otherwise;
  if (hk_lua_field(L, table, key) != LUA_TNIL) value = hk_lua_number(L, -1, name);
  lua_pop(L, 1);
  return value;
}

uint64_t hk_lua_field_whole(lua_State *L, int table, const char *what, const char *key, uint64_t otherwise,
                            double most) {
  double value = hk_lua_field_number(L, table, what, key, (double)otherwise);
  if (!(value >= 0 && value <= most && floor(value) == value))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: %g is not a whole number from 0 to %g", what, key, value, most);
  return (uint64_t)value;
}

static const char *known_at(const void *context, size_t k) { return ((const char *const *)context)[k]; }

/* Pushes "its keys are a, b". */
static const char *keys_text(lua_State *L, const char *const *known) {
  luaL_Buffer text;
  luaL_buffinit(L, &text);
  for (size_t k = 0; known[k]; k++) {
    luaL_addstring(&text, k ? ", " : "its keys are ");
    luaL_addstring(&text, known[k]);
  }
  luaL_pushresult(&text);
  return lua_tostring(L, -1);
}

void hk_lua_check_keys(lua_State *L, int index, const char *what, const char *const *known) {
  index = lua_absindex(L, index);
  hk_lua_check_plain(L, index, what);
  for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING)
      hk_lua_fail(L, HK_BAD_PARAM, "%s: only named values are expected, as in { key = value }", what);
    const char *key = lua_tostring(L, -2);
    size_t k = 0;
    while (known[k] && strcmp(known[k], key) != 0) k++;
    if (known[k]) continue;
    const char *near = hk_registry_meant(hk_lua_script(L)->options.registry, key, known_at, known);
    if (near) hk_lua_fail(L, HK_BAD_PARAM, "%s: unknown key '%s'; did you mean '%s'?", what, key, near);
    hk_lua_fail(L, HK_BAD_PARAM, "%s: unknown key '%s'; %s", what, key, keys_text(L, known));
  }
}

/* Converts a list of numbers to a block on the Lua stack; NULL: the value is no such list. */
static double *to_numbers(lua_State *L, int index, size_t *count) {
  if (!lua_istable(L, index)) return NULL;
  *count = lua_rawlen(L, index);
  double *list = lua_newuserdatauv(L, (*count + 1) * sizeof *list, 0);
  for (size_t k = 0; k < *count; k++) {
    bool number = lua_rawgeti(L, index, (lua_Integer)k + 1) == LUA_TNUMBER;
    list[k] = lua_tonumber(L, -1);
    lua_pop(L, 1);
    if (!number) return NULL;
  }
  return list;
}

/* Whether there is a table of `arity` ids at the index; into: NULL, or where they go. */
static bool to_tuple(lua_State *L, int index, unsigned arity, uint32_t *into) {
  bool fine = lua_istable(L, index) && lua_rawlen(L, index) == arity;
  for (unsigned c = 0; c < arity && fine; c++) {
    fine = lua_rawgeti(L, index, (lua_Integer)c + 1) == LUA_TNUMBER;
    double id = lua_tonumber(L, -1);
    lua_pop(L, 1);
    fine = fine && id >= 0 && id <= UINT32_MAX && floor(id) == id;
    if (fine && into) into[c] = (uint32_t)id;
  }
  return fine;
}

/* Counts the tuples of a list of tuples and of such lists, and writes them unless `into` is NULL. False: it holds
 * something else, or itself. */
static bool collect_tuples(lua_State *L, int table, unsigned arity, int depth, uint32_t *into, size_t *count) {
  enum { DEEPEST = 16, VISIT = 8 }; /* instructions that looking at a member costs, about */
  int top = lua_gettop(L);
  bool fine = depth < DEEPEST && lua_istable(L, table) && lua_rawlen(L, table) > 0;
  for (lua_Integer k = 1; fine && lua_rawgeti(L, table, k) != LUA_TNIL; k++, lua_settop(L, top)) {
    hk_limits_count(L, VISIT);
    int member = lua_gettop(L);
    if (to_tuple(L, member, arity, into ? into + arity * *count : NULL))
      ++*count;
    else
      fine = collect_tuples(L, member, arity, depth + 1, into, count);
  }
  lua_settop(L, top);
  return fine;
}

/* Lists of tuples, in any mix, as a block left on the stack. False: it is none. */
static bool to_tuples(lua_State *L, int index, unsigned arity, hk_value *value) {
  size_t count = 0, written = 0;
  luaL_checkstack(L, 64, "lists of tuples");
  if (!collect_tuples(L, index, arity, 0, NULL, &count)) return false;
  uint32_t *block = lua_newuserdatauv(L, (count * arity + 1) * sizeof *block, 0);
  collect_tuples(L, index, arity, 0, block, &written);
  *value = (hk_value){.kind = HK_VALUE_TUPLES, .count = count, .arity = arity, .tuples = block};
  return true;
}

/* Converts the value at `index` to the type of parameter p; memory that the result points to is on the Lua stack. */
static hk_value to_value(lua_State *L, int index, const hk_param *p, const char *label) {
  hk_value value = {.kind = HK_VALUE_NUMBER};
  const hk_lua_edges *edges;
  switch (lua_type(L, index)) {
  case LUA_TNUMBER:
    value.number = lua_tonumber(L, index);
    return value;
  case LUA_TBOOLEAN:
    return (hk_value){.kind = HK_VALUE_BOOLEAN, .boolean = lua_toboolean(L, index)};
  case LUA_TSTRING:
    return (hk_value){.kind = HK_VALUE_STRING, .text = lua_tostring(L, index)};
  case LUA_TFUNCTION:
    value = (hk_value){.kind = HK_VALUE_FUNCTION, .function = hk_lua_function(L, index)};
    if (p->function) value.function.id = hk_function_arguments(p) - 1;
    return value;
  default:
    break;
  }
  if (p->edges && (edges = hk_lua_to_edges(L, index)) != NULL)
    return (hk_value){.kind = HK_VALUE_TUPLES, .count = edges->count, .arity = 2, .tuples = &edges->pair[0][0]};
  unsigned arity = hk_param_arity(p);
  if (arity > 2 && to_tuples(L, index, arity, &value)) return value;
  value.kind = HK_VALUE_LIST;
  value.list = p->particles ? hk_lua_to_ids(L, index, &value.count) : to_numbers(L, index, &value.count);
  if (!value.list) {
    static const char *const wanted[] = {"a number",
                                         "an integer",
                                         "true or false",
                                         "a string",
                                         "a string",
                                         "a list of three numbers",
                                         "a list of numbers",
                                         "a list of particle ids",
                                         "a list of edges, {{1, 2}, {2, 3}}",
                                         "a list of triangles, {{1, 2, 3}}",
                                         "a list of quadruples, {{1, 2, 3, 4}}",
                                         "a number or a list with one number per tuple",
                                         "a function"};
    hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: expected %s, got %s", label, p->name, wanted[hk_param_type(p)],
                lua_istable(L, index)        ? "another kind of list"
                : hk_lua_to_handle(L, index) ? "a handle; its functions give lists, such as cloth:edges()"
                                             : luaL_typename(L, index));
  }
  return value;
}

/* Bytes that a spec needs to keep the value. */
static size_t size_of(const hk_value *value) {
  if (value->kind == HK_VALUE_STRING) return strlen(value->text) + 64;
  if (value->kind == HK_VALUE_TUPLES) return value->count * value->arity * sizeof(uint32_t) + 64;
  return value->kind == HK_VALUE_LIST ? value->count * sizeof(double) + 64 : 0;
}

static int by_index(const void *a, const void *b) {
  uint32_t i = *(const uint32_t *)a, j = *(const uint32_t *)b;
  return (i > j) - (i < j);
}

static void set_only(lua_State *L, const hk_scene *scene, hk_plugin_spec *spec) {
  char known[64];
  size_t count, kept = 0;
  const double *ids = hk_lua_to_ids(L, -1, &count);
  if (!ids) hk_lua_fail(L, HK_BAD_PARAM, "%s: only: expected a list of particle ids", spec->label);
  for (size_t k = 0; k < count; k++)
    if (!(ids[k] >= 1 && ids[k] <= (double)scene->particles.n && floor(ids[k]) == ids[k]))
      hk_lua_fail(L, HK_BAD_PARAM, "%s: only[%d]: there is no particle %g (%s)", spec->label, (int)k + 1, ids[k],
                  hk_known_ids(known, scene->particles.n));
  hk_limits_take(L, (count + 1) * sizeof *spec->only);
  spec->only = malloc((count + 1) * sizeof *spec->only);
  if (!spec->only) hk_lua_fail(L, HK_NO_MEMORY, "%s: no memory for the selection", spec->label);
  for (size_t k = 0; k < count; k++) spec->only[k] = (uint32_t)ids[k] - 1;
  qsort(spec->only, count, sizeof *spec->only, by_index);
  for (size_t k = 0; k < count; k++)
    if (kept == 0 || spec->only[kept - 1] != spec->only[k]) spec->only[kept++] = spec->only[k];
  spec->only_count = kept;
  lua_pop(L, 1); /* the ids */
}

double hk_lua_fastest(lua_State *L, const char *what) {
  double seconds = hk_lua_number(L, -1, what);
  if (seconds <= 0) hk_lua_fail(L, HK_BAD_PARAM, "%s: %g s is no time in which anything changes", what, seconds);
  return seconds;
}

static void add_group(lua_State *L, hk_scene *scene, const char *name) {
  hk_error error = {0};
  uint32_t group;
  hk_limits_take(L, strlen(name) + 64);
  if (hk_scene_add_group(scene, name, &group, &error) != HK_OK) hk_lua_raise(L, &error);
}

/* True: `key` is an option that the host handles; its value is on top of the stack. */
static bool common_option(lua_State *L, hk_scene *scene, hk_plugin_spec *spec, const char *key) {
  char name[160];
  snprintf(name, sizeof name, "%s: %s", spec->label, key);
  if (strcmp(key, "label") == 0) return true;
  if (strcmp(key, "fastest") == 0) {
    spec->fastest = hk_lua_fastest(L, name);
    return true;
  }
  if (strcmp(key, "group") == 0 && (spec->plugin->kind == HK_FORCE || spec->plugin->kind == HK_SOURCE)) {
    if (lua_type(L, -1) != LUA_TSTRING) hk_lua_fail(L, HK_BAD_PARAM, "%s: expected the name of a group", name);
    spec->group = hk_string_copy(lua_tostring(L, -1));
    if (spec->plugin->kind == HK_SOURCE) add_group(L, scene, spec->group); /* its particles will be the first */
    return true;
  }
  if (spec->plugin->kind != HK_FORCE) return false;
  if (strcmp(key, "only") == 0)
    set_only(L, scene, spec);
  else if (strcmp(key, "from") == 0)
    spec->from = hk_lua_number(L, -1, name);
  else if (strcmp(key, "to") == 0)
    spec->to = hk_lua_number(L, -1, name);
  else
    return false;
  return true;
}

static bool has_state_function(const hk_plugin_spec *spec) {
  for (const hk_param *p = spec->plugin->params; p && p->name; p++)
    if (p->function && spec->given[p - spec->plugin->params]) return true;
  return false;
}

void hk_lua_set_params(lua_State *L, hk_scene *scene, hk_plugin_spec *spec, int table) {
  hk_error error = {0};
  if (table == 0 || lua_isnoneornil(L, table))
    table = 0;
  else if (!lua_istable(L, table))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: parameters are a table, { k = 1000 }", spec->label);
  if (table) {
    hk_lua_check_plain(L, table, spec->label);
    for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
      if (lua_type(L, -2) != LUA_TSTRING)
        hk_lua_fail(L, HK_BAD_PARAM, "%s: parameters are named, { k = 1000 }", spec->label);
      const char *key = lua_tostring(L, -2);
      int top = lua_gettop(L);
      const hk_param *own = NULL;
      for (const hk_param *p = spec->plugin->params; p && p->name; p++)
        if (strcmp(p->name, key) == 0) own = p;
      if (!own && common_option(L, scene, spec, key)) continue;
      const hk_param *param = hk_scene_param(scene, spec, key, &error);
      if (!param) hk_lua_raise(L, &error);
      hk_value value = to_value(L, top, param, spec->label);
      hk_limits_take(L, size_of(&value));
      if (hk_spec_set(spec, param, &value, scene->particles.n, &error) != HK_OK) hk_lua_raise(L, &error);
      lua_settop(L, top);
    }
  }
  if (spec->from >= spec->to)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: from: %g s is not before to: %g s", spec->label, spec->from, spec->to);
  if (spec->fastest > 0 && spec->timed_count == 0 && !has_state_function(spec))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: fastest: no parameter is a function of time", spec->label);
  if (hk_spec_check(spec, &error) != HK_OK) hk_lua_raise(L, &error);
}
