/* hooke.definition(path, name): the table that a script returns through hooke.NAME{}. The script only describes
 * something, a sweep for example, so it runs as untrusted scenes do, in a Lua state of its own with their sandbox and
 * limits, where hooke has nothing but that function. What comes out is copied: texts, numbers, booleans and tables. */
#include "core/text/text.h"
#include "core/tools/tools.h"

#include <lauxlib.h>
#include <math.h>
#include <string.h>

enum { DEEPEST = 16 };
static const char marked;              /* its address is the key of the table in the registry */
static const double most_values = 1e7; /* of all tables, one that stands in several places counted there */

typedef struct definition {
  lua_State *to; /* the tool's, in which the table is put on the stack */
  const char *path, *name;
  double values;
} definition;

static int mark(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lua_pushvalue(L, 1);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &marked);
  return 1;
}

/* Texts are printed and stored: one with a zero or with orders to a terminal is none. */
static void copy_text(const definition *d, lua_State *L) {
  size_t length;
  const char *text = lua_tolstring(L, -1, &length);
  bool plain = strlen(text) == length;
  for (const char *c = text; plain && *c;) {
    uint32_t code;
    size_t bytes = hk_utf8_next(c, &code);
    plain = bytes > 0 && !hk_commands_terminal(code);
    c += bytes;
  }
  if (!plain)
    hk_lua_fail(L, HK_SCRIPT, "%s: the text '%s' of hooke.%s{} has control characters, or is no UTF-8", d->path, text,
                d->name);
  lua_pushlstring(d->to, text, length);
}

static void copy(definition *d, lua_State *L, int depth) {
  lua_State *to = d->to;
  if (++d->values > most_values || depth > DEEPEST)
    hk_lua_fail(L, HK_SCRIPT, "%s: the table of hooke.%s is too large, or contains itself", d->path, d->name);
  switch (lua_type(L, -1)) {
  case LUA_TBOOLEAN:
    lua_pushboolean(to, lua_toboolean(L, -1));
    return;
  case LUA_TNUMBER:
    if (lua_isinteger(L, -1))
      lua_pushinteger(to, lua_tointeger(L, -1));
    else
      lua_pushnumber(to, lua_tonumber(L, -1));
    return;
  case LUA_TSTRING:
    copy_text(d, L);
    return;
  case LUA_TTABLE:
    break;
  default:
    hk_lua_fail(L, HK_SCRIPT, "%s: a %s cannot be a part of hooke.%s{}", d->path, luaL_typename(L, -1), d->name);
  }
  luaL_checkstack(L, 4, "tables in tables");
  luaL_checkstack(to, 4, "tables in tables");
  lua_newtable(to);
  for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
    lua_pushvalue(L, -2);
    copy(d, L, depth + 1);
    lua_pop(L, 1);
    copy(d, L, depth + 1);
    lua_rawset(to, -3);
  }
}

static int run(lua_State *L) {
  definition *d = lua_touserdata(L, 1);
  lua_createtable(L, 0, 2); /* in the place of hooke: no scene is made here */
  lua_getglobal(L, "hooke");
  lua_getfield(L, -1, "version");
  lua_setfield(L, -3, "version");
  lua_pop(L, 1);
  lua_pushcfunction(L, mark);
  lua_setfield(L, -2, d->name);
  lua_setglobal(L, "hooke");
  hk_lua_run_file(L);
  lua_rawgetp(L, LUA_REGISTRYINDEX, &marked);
  if (!lua_istable(L, -1) || !lua_rawequal(L, -1, -2))
    hk_lua_fail(L, HK_SCRIPT, "%s: a %s script ends with return hooke.%s { ... }", d->path, d->name, d->name);
  copy(d, L, 0);
  return 0;
}

int hk_tool_definition(lua_State *L) {
  definition d = {.to = L, .path = luaL_checkstring(L, 1), .name = luaL_checkstring(L, 2)};
  hk_script_options options = *hk_script_asked(hk_lua_script(L));
  hk_error error = {0};
  int top = lua_gettop(L);
  options.trust = false;
  options.given_count = 0;
  hk_status status = hk_script_host(d.path, &options, run, &d, &error);
  if (status == HK_OK) return 1;
  lua_settop(L, top);
  lua_pushnil(L);
  lua_pushstring(L, error.text);
  return 2;
}
