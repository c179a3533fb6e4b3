/* The sandbox: the environment that scenes run in. It holds the harmless part of Lua's library, `hooke` and `param`.
 * Using a function that is excluded on purpose is an error that says so; using a name that does not exist is an error
 * that suggests the nearest name. */
#include "core/app/lua/internal.h"
#include "core/run/storage/storage.h"
#include "core/engine/text/text.h"

#include <errno.h>
#include <string.h>

static int refuse(lua_State *L) {
  const char *library = lua_tostring(L, lua_upvalueindex(1)), *name = lua_tostring(L, 2);
  return hk_lua_fail(L, HK_SCRIPT, "%s%s%s is not available to scenes; --trust lifts this for scripts that you trust",
                     library, name ? "." : "", name ? name : "");
}

static int refuse_call(lua_State *L) {
  lua_settop(L, 0);
  return refuse(L);
}

/* Replaces a library by a table whose members raise an error with their name. */
static void forbid_library(lua_State *L, const char *name) {
  lua_newtable(L);
  lua_createtable(L, 0, 2);
  lua_pushstring(L, name);
  lua_pushcclosure(L, refuse, 1);
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_setmetatable(L, -2);
  lua_setfield(L, -2, name);
}

static void forbid_function(lua_State *L, const char *name) {
  lua_pushstring(L, name);
  lua_pushcclosure(L, refuse_call, 1);
  lua_setfield(L, -2, name);
}

/* Finalizers run outside the script's limits, so scenes may not define any. */
static int set_metatable(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  if (!lua_isnil(L, 2)) luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  if (luaL_getmetafield(L, 1, "__metatable") != LUA_TNIL) return luaL_error(L, "cannot change a protected metatable");
  if (lua_istable(L, 2)) {
    lua_pushliteral(L, "__gc");
    if (lua_rawget(L, 2) != LUA_TNIL) return hk_lua_fail(L, HK_SCRIPT, "setmetatable: __gc is not available to scenes");
  }
  lua_settop(L, 2);
  lua_setmetatable(L, 1);
  return 1;
}

static int print_nothing(lua_State *L) {
  int count = lua_gettop(L);
  for (int k = 1; k <= count; k++) luaL_tolstring(L, k, NULL); /* what makes texts is called as otherwise */
  return 0;
}

/* Runs a module's file in the environment that is the function's first upvalue; false: there is none. */
static bool load_module(lua_State *L, const char *folder, const char *name) {
  lua_pushfstring(L, "%s.lua", name);
  lua_pushfstring(L, "%s/%s", folder, lua_tostring(L, -1));
  const char *folders[3];
  int code = hk_lua_load(L, lua_tostring(L, -1), lua_tostring(L, -2), hk_lua_readable(hk_lua_script(L), folders));
  if (code == LUA_ERRFILE && errno != ENOENT)
    hk_lua_fail(L, HK_IO, "require: cannot read %s.lua: %s", name, hk_file_reason(errno));
  if (code == LUA_ERRFILE) return false;
  if (code != LUA_OK) lua_error(L);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_setupvalue(L, -2, 1);
  lua_call(L, 0, 1);
  return true;
}

static void mark_module(lua_State *L, const char *name, const void *mark) {
  if (mark)
    lua_pushlightuserdata(L, (void *)(uintptr_t)mark);
  else
    lua_pushnil(L);
  lua_setfield(L, lua_upvalueindex(2), name);
}

/* The second upvalue holds the modules loaded; a module that is being loaded is marked, so that circular loading is
 * detected. */
static int require_module(lua_State *L) {
  static const char loading;
  const hk_script *s = hk_lua_script(L);
  const char *name = hk_lua_text(L, 1, "require(\"drape\")");
  if (lua_getfield(L, lua_upvalueindex(2), name) != LUA_TNIL && lua_touserdata(L, -1) != &loading) return 1;
  if (!lua_isnil(L, -1)) return hk_lua_fail(L, HK_SCRIPT, "require: '%s' requires itself, in a circle", name);
  if (strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") != strlen(name))
    return hk_lua_fail(L, HK_SCRIPT, "require: '%s' is not the name of a module", name);
  mark_module(L, name, &loading);
  if (!load_module(L, s->folder, name) && !(s->options.library && load_module(L, s->options.library, name))) {
    mark_module(L, name, NULL);
    return hk_lua_fail(L, HK_SCRIPT, "require: there is no module '%s' beside the scene or in scripts/lib", name);
  }
  if (lua_isnil(L, -1)) lua_pushboolean(L, 1);
  lua_pushvalue(L, -1);
  lua_setfield(L, lua_upvalueindex(2), name);
  return 1;
}

typedef struct key_list {
  size_t count;
  const char *key[256];
} key_list;

static const char *key_at(const void *context, size_t k) {
  const key_list *list = context;
  return k < list->count ? list->key[k] : NULL;
}

/* __index of the environment: raises the error of a name that does not exist. */
static int undefined(lua_State *L) {
  if (!lua_istable(L, 1) || lua_type(L, 2) != LUA_TSTRING) return 0;
  const char *name = lua_tostring(L, 2);
  key_list list = {0};
  for (lua_pushnil(L); list.count < 256 && lua_next(L, 1); lua_pop(L, 1))
    if (lua_type(L, -2) == LUA_TSTRING) list.key[list.count++] = lua_tostring(L, -2);
  const char *near = hk_nearest_name(name, key_at, &list);
  if (near) return hk_lua_fail(L, HK_SCRIPT, "'%s' is not defined; did you mean '%s'?", name, near);
  return hk_lua_fail(L, HK_SCRIPT, "'%s' is not defined; a text stands in quotes, \"%s\"", name, name);
}

static void copy_table(lua_State *L, const char *name, const char *without) {
  lua_newtable(L);
  lua_getglobal(L, name);
  for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
    lua_pushvalue(L, -2);
    lua_pushvalue(L, -2);
    lua_settable(L, -6);
  }
  lua_pop(L, 1);
  lua_pushnil(L);
  lua_setfield(L, -2, without);
  lua_setfield(L, -2, name);
}

/* Makes the sandbox's own table the methods of strings. The environment is on top of the stack. */
static void seal_strings(lua_State *L) {
  lua_pushliteral(L, "");
  lua_getmetatable(L, -1);
  lua_getfield(L, -3, "string");
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 2);
}

static void add_require(lua_State *L) {
  lua_pushvalue(L, -1);
  lua_newtable(L);
  lua_pushcclosure(L, require_module, 2);
  lua_pushvalue(L, -1);
  lua_setfield(L, LUA_REGISTRYINDEX, HK_LUA_REQUIRE);
  lua_setfield(L, -2, "require");
}

void hk_lua_push_sandbox(lua_State *L) {
  static const char *const kept[] = {"assert",       "error",        "ipairs", "next",     "pairs",  "pcall",  "select",
                                     "tonumber",     "tostring",     "type",   "rawequal", "rawget", "rawlen", "rawset",
                                     "setmetatable", "getmetatable", "xpcall", "hooke",    "param",  NULL};
  static const char *const tables[] = {"math", "string", "table", "utf8", "coroutine", NULL};
  static const char *const libraries[] = {"os", "io", "debug", "package", NULL};
  static const char *const functions[] = {"load", "loadstring", "loadfile", "dofile", "collectgarbage", NULL};
  bool silent = hk_lua_script(L)->options.silent;
  lua_getglobal(L, "hooke");
  hk_lua_name_functions(L);
  lua_pop(L, 1);
  if (hk_lua_script(L)->options.trust) {
    lua_pushglobaltable(L);
    if (silent) {
      lua_pushcfunction(L, print_nothing);
      lua_setfield(L, -2, "print");
    }
    add_require(L);
    return;
  }
  lua_newtable(L);
  for (size_t k = 0; kept[k]; k++) {
    lua_getglobal(L, kept[k]);
    lua_setfield(L, -2, kept[k]);
  }
  for (size_t k = 0; tables[k]; k++) copy_table(L, tables[k], "dump");
  for (size_t k = 0; libraries[k]; k++) forbid_library(L, libraries[k]);
  for (size_t k = 0; functions[k]; k++) forbid_function(L, functions[k]);
  lua_pushcfunction(L, set_metatable);
  lua_setfield(L, -2, "setmetatable");
  hk_lua_guard(L);
  hk_lua_hide_addresses(L, silent);
  seal_strings(L);
  lua_pushvalue(L, -1);
  lua_setfield(L, -2, "_G");
  add_require(L);
  lua_createtable(L, 0, 2);
  lua_pushcfunction(L, undefined);
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_setmetatable(L, -2);
}
