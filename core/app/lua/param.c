/* param(name, default, help [, {min =, max =}]): the value given on the command line, converted to the type of the
 * default, or the default. All declared parameters are kept for --help. */
#include "core/app/lua/internal.h"
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"

#include <string.h>

/* Pushes the value as text. */
static const char *text_of(lua_State *L, int index) {
  return lua_isnil(L, index) ? lua_pushliteral(L, "") : hk_lua_plain_text(L, index);
}

static const char *type_name(lua_State *L, int index) {
  return lua_isinteger(L, index) ? "integer" : lua_type(L, index) == LUA_TSTRING ? "string" : luaL_typename(L, index);
}

/* The parameter stands in the list, without limits. */
static hk_param_declared *declare(lua_State *L, const char *name, const char *help, int initial, int value) {
  hk_script *s = hk_lua_script(L);
  const char *first = text_of(L, initial), *now = text_of(L, value);
  hk_limits_take(L, sizeof *s->param + strlen(name) + strlen(help) + strlen(first) + strlen(now));
  void *list = s->param;
  int failed = hk_array_reserve(&list, &s->param_capacity, s->params + 1, sizeof *s->param);
  s->param = list;
  if (failed) hk_lua_fail(L, HK_NO_MEMORY, "no memory for parameter '%s'", name);
  hk_param_declared *p = &s->param[s->params];
  *p = (hk_param_declared){.type = type_name(L, initial), .min = NAN, .max = NAN};
  s->params++;
  p->name = hk_string_copy(name);
  p->help = hk_string_copy(help);
  p->initial = hk_string_copy(first);
  p->value = hk_string_copy(now);
  return p;
}

/* Of the table at `limits`, for the number at `value`. */
static void limit(lua_State *L, hk_param_declared *p, int limits, int value) {
  static const char *const keys[] = {"min", "max", NULL};
  hk_lua_check_keys(L, limits, "param", keys);
  p->min = hk_lua_field_number(L, limits, "param", "min", NAN);
  p->max = hk_lua_field_number(L, limits, "param", "max", NAN);
  double number = lua_tonumber(L, value);
  if (number < p->min)
    hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: %g is below the minimum %g", p->name, number, p->min);
  if (number > p->max)
    hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: %g is above the maximum %g", p->name, number, p->max);
}

/* Pushes the given text converted to the type of the default. */
static void convert(lua_State *L, const char *name, const char *text) {
  int type = lua_type(L, 2);
  if (type == LUA_TBOOLEAN) {
    bool yes = strcmp(text, "true") == 0;
    if (!yes && strcmp(text, "false") != 0)
      hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: '%s' is not true or false", name, text);
    lua_pushboolean(L, yes);
  } else if (type == LUA_TNUMBER) {
    if (lua_stringtonumber(L, text) == 0)
      hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: '%s' is not a number", name, text);
    double value = lua_tonumber(L, -1);
    if (!isfinite(value)) hk_lua_fail(L, HK_BAD_PARAM, "parameter %s: '%s' is not finite", name, text);
    if (lua_isinteger(L, 2) && !lua_isinteger(L, -1) && floor(value) == value && fabs(value) < 9e15) {
      lua_pop(L, 1);
      lua_pushinteger(L, (lua_Integer)value);
    }
  } else
    lua_pushstring(L, text);
}

/* The name; what stands beside it is checked, too. */
static const char *name_of(lua_State *L) {
  static const char usage[] = "param(\"k\", 1000, \"stiffness, N/m\", { min = 0 })";
  if (lua_type(L, 1) != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "param: expected a name and a default, as in %s", usage);
  const char *name = lua_tostring(L, 1);
  int type = lua_type(L, 2);
  if (type == LUA_TNIL)
    hk_lua_fail(L, HK_BAD_PARAM, "param: '%s' has no default, which says its type, too: give one, as in %s", name,
                usage);
  if (type != LUA_TNUMBER && type != LUA_TSTRING && type != LUA_TBOOLEAN)
    hk_lua_fail(L, HK_BAD_PARAM, "param: the default of '%s' is %s: expected a number, a text, or true or false", name,
                hk_lua_kind(L, 2));
  if (!lua_isnil(L, 3) && lua_type(L, 3) != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "param: the help of '%s' is %s: expected a text, as in %s", name, hk_lua_kind(L, 3),
                usage);
  if (!lua_isnil(L, 4) && !lua_istable(L, 4))
    hk_lua_fail(L, HK_BAD_PARAM, "param: the limits of '%s' are %s: expected { min =, max = }, as in %s", name,
                hk_lua_kind(L, 4), usage);
  return name;
}

int hk_lua_param(lua_State *L) {
  hk_script *s = hk_lua_script(L);
  lua_settop(L, 4);
  const char *name = name_of(L), *help = lua_isnil(L, 3) ? "" : lua_tostring(L, 3);
  lua_pushvalue(L, 2);
  for (size_t k = 0; k < s->options.given_count; k++) {
    if (strcmp(s->options.given[k].name, name) != 0) continue;
    s->options.given[k].used = true;
    convert(L, name, s->options.given[k].value);
  }
  int value = lua_gettop(L);
  hk_param_declared *p = declare(L, name, help, 2, value);
  lua_settop(L, value);
  if (lua_istable(L, 4)) limit(L, p, 4, value);
  lua_pushvalue(L, value);
  return 1;
}

static const char *declared_name(const void *context, size_t k) {
  const hk_script *s = context;
  return k < s->params ? s->param[k].name : NULL;
}

/* The parameter of which it is the plural; that of which the help says that it is
 * this; a synonym; or the closest name. */
static const char *meant(const hk_script *s, const char *name) {
  const char *singular = hk_singular_name(name, declared_name, s);
  if (singular) return singular;
  for (size_t k = 0; k < s->params; k++)
    if (s->param[k].help && hk_begins_with_words(s->param[k].help, name)) return s->param[k].name;
  return hk_registry_meant(s->options.registry, name, declared_name, s);
}

hk_status hk_lua_check_given(const hk_script *s, hk_error *error) {
  for (size_t k = 0; k < s->options.given_count; k++) {
    const hk_param_given *given = &s->options.given[k];
    if (given->used) continue;
    const char *near = meant(s, given->name);
    if (near)
      return hk_error_set(error, HK_BAD_PARAM, "%s has no parameter '%s'; did you mean '%s'?", s->name, given->name,
                          near);
    return hk_error_set(error, HK_BAD_PARAM, "%s has no parameter '%s'; see: hooke run %s --help", s->name, given->name,
                        s->path);
  }
  return HK_OK;
}
