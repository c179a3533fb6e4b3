/* What scripts ask of the engine's objects that these do not have: errors that name the object, the nearest name and
 * the right form. */
#include "core/app/script/script.h"

#include <string.h>

void *hk_lua_self(lua_State *L, const char *type, const char *form) {
  void *self = luaL_testudata(L, 1, type);
  if (!self) hk_lua_fail(L, HK_SCRIPT, "functions of a %s are called with a colon: %s", strchr(type, '.') + 1, form);
  return self;
}

const char *hk_lua_method_name(const void *context, size_t k) { return ((const luaL_Reg *)context)[k].name; }

int hk_lua_no_member(lua_State *L, const char *what, hk_name_at *names, const void *context, const char *otherwise) {
  if (lua_type(L, 2) != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "%s has no members by %s; %s", what, luaL_typename(L, 2), otherwise);
  const char *name = lua_tostring(L, 2);
  const char *near = hk_registry_meant(hk_lua_script(L)->options.registry, name, names, context);
  return near ? hk_lua_fail(L, HK_BAD_PARAM, "%s has no '%s'; did you mean '%s'?", what, name, near)
              : hk_lua_fail(L, HK_BAD_PARAM, "%s has no '%s'; %s", what, name, otherwise);
}

void hk_lua_check_table(lua_State *L, int index, const char *what, const char *form) {
  if (!lua_istable(L, index))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: expected a table, %s, got a %s", what, form, luaL_typename(L, index));
}

const char *hk_lua_kind(lua_State *L, int index) {
  static const char *const kinds[] = {"nothing", "true or false", "something of C", "a number",   "a text",
                                      "a table", "a function",    "an object",      "a coroutine"};
  int type = lua_type(L, index);
  return kinds[type < 0 ? LUA_TNIL : type];
}

const char *hk_lua_text(lua_State *L, int index, const char *form) {
  if (lua_type(L, index) != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "expected a text, as in %s, got %s", form, hk_lua_kind(L, index));
  return lua_tostring(L, index);
}

lua_Integer hk_lua_integer(lua_State *L, int index, const char *form) {
  int whole = 0;
  lua_Integer value = lua_type(L, index) == LUA_TNUMBER ? lua_tointegerx(L, index, &whole) : 0;
  if (whole) return value;
  if (lua_type(L, index) == LUA_TNUMBER)
    hk_lua_fail(L, HK_BAD_PARAM, "expected a whole number, as in %s, got %g", form, lua_tonumber(L, index));
  hk_lua_fail(L, HK_BAD_PARAM, "expected a whole number, as in %s, got %s", form, hk_lua_kind(L, index));
}
