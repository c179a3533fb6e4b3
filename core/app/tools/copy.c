/* Tables of one Lua state copied into another: texts, numbers, booleans and tables, past metatables. What an untrusted
 * script gives is bounded in size and depth, and its texts are harmless for terminals. */
#include "core/engine/text/text.h"
#include "core/app/tools/tools.h"

#include <lauxlib.h>
#include <string.h>

enum { DEEPEST = 16 };
static const double most_values = 1e7; /* of all tables, one that stands in several places counted there */

typedef struct copying {
  lua_State *to;
  const char *what; /* "x.lua: the table of hooke.sweep{}" */
  double values;
} copying;

/* Texts are printed and stored: one with a zero or with orders to a terminal is none. */
static void copy_text(const copying *c, lua_State *from) {
  size_t length;
  const char *text = lua_tolstring(from, -1, &length);
  bool plain = strlen(text) == length;
  for (const char *at = text; plain && *at;) {
    uint32_t code;
    size_t bytes = hk_utf8_next(at, &code);
    plain = bytes > 0 && !hk_commands_terminal(code);
    at += bytes;
  }
  if (!plain) hk_lua_fail(from, HK_SCRIPT, "%s: the text '%s' has control characters, or is no UTF-8", c->what, text);
  lua_pushlstring(c->to, text, length);
}

static void copy(copying *c, lua_State *from, int depth) {
  lua_State *to = c->to;
  if (++c->values > most_values || depth > DEEPEST)
    hk_lua_fail(from, HK_SCRIPT, "%s is too large, or contains itself", c->what);
  switch (lua_type(from, -1)) {
  case LUA_TBOOLEAN:
    lua_pushboolean(to, lua_toboolean(from, -1));
    return;
  case LUA_TNUMBER:
    if (lua_isinteger(from, -1))
      lua_pushinteger(to, lua_tointeger(from, -1));
    else
      lua_pushnumber(to, lua_tonumber(from, -1));
    return;
  case LUA_TSTRING:
    copy_text(c, from);
    return;
  case LUA_TTABLE:
    break;
  default:
    hk_lua_fail(from, HK_SCRIPT, "%s: a %s cannot be a part of it", c->what, luaL_typename(from, -1));
  }
  luaL_checkstack(from, 4, "tables in tables");
  luaL_checkstack(to, 4, "tables in tables");
  lua_newtable(to);
  for (lua_pushnil(from); lua_next(from, -2); lua_pop(from, 1)) {
    lua_pushvalue(from, -2);
    copy(c, from, depth + 1);
    lua_pop(from, 1);
    copy(c, from, depth + 1);
    lua_rawset(to, -3);
  }
}

void hk_tool_copy(lua_State *to, lua_State *from, const char *what) {
  copying c = {.to = to, .what = what};
  copy(&c, from, 0);
}
