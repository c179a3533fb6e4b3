/* Values as text for untrusted scripts: tostring, print and string.format show no addresses, which would tell a script
 * where to aim. What has no text of its own (__tostring) is shown by its type. */
#include "core/app/lua/internal.h"
#include "core/engine/text/text.h"

#include <stdio.h>
#include <string.h>

const char *hk_lua_plain_text(lua_State *L, int index) {
  int type = lua_type(L, index);
  bool named = type == LUA_TUSERDATA && luaL_getmetafield(L, index, "__name") == LUA_TSTRING;
  if (named) return lua_tostring(L, -1);
  if (type == LUA_TNUMBER || type == LUA_TSTRING || type == LUA_TBOOLEAN || type == LUA_TNIL)
    return luaL_tolstring(L, index, NULL);
  return lua_pushstring(L, lua_typename(L, type));
}

void hk_lua_push_plain(lua_State *L, const char *text) {
  char plain[4096];
  hk_plain_copy(plain, sizeof plain, text);
  lua_pushstring(L, plain);
}

/* Pushes the value's text, its own where it has one. */
static const char *text_of(lua_State *L, int index) {
  luaL_checkany(L, index);
  if (luaL_getmetafield(L, index, "__tostring") == LUA_TNIL) return hk_lua_plain_text(L, index);
  lua_pop(L, 1);
  return luaL_tolstring(L, index, NULL);
}

static int to_string(lua_State *L) {
  text_of(L, 1);
  return 1;
}

static int print_to_stderr(lua_State *L) {
  int count = lua_gettop(L);
  for (int k = 1; k <= count; k++) {
    if (k > 1) fputc('\t', stderr);
    hk_print_plain(stderr, text_of(L, k));
    lua_settop(L, count);
  }
  fputc('\n', stderr);
  return 0;
}

/* What makes texts is called as where they are printed, so that a script does the same each time. */
static int print_nothing(lua_State *L) {
  int count = lua_gettop(L);
  for (int k = 1; k <= count; k++) {
    text_of(L, k);
    lua_settop(L, count);
  }
  return 0;
}

/* string.format with its arguments of %s made texts first. */
static int format(lua_State *L) {
  size_t length;
  int top = lua_gettop(L), argument = 1;
  const char *c = luaL_checklstring(L, 1, &length);
  for (const char *end = c + length; c < end; c++) { /* zeros do not end it */
    if (*c != '%' || *++c == '%') continue;
    c += strspn(c, "-+ #0123456789.");
    if (*c == 'p') return hk_lua_fail(L, HK_SCRIPT, "string.format: %%p, an address, is not available to scenes");
    if (++argument > top || !*c) break; /* the original complains */
    if (*c == 's') {
      text_of(L, argument);
      lua_replace(L, argument);
    }
  }
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, top, 1);
  return 1;
}

/* Without arguments, math.randomseed takes the address of the Lua state as seed, and returns it. */
static int seed_random(lua_State *L) {
  if (lua_gettop(L) == 0) lua_pushinteger(L, 0);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, 0);
  return 0;
}

void hk_lua_hide_addresses(lua_State *L, bool silent) {
  lua_pushcfunction(L, to_string);
  lua_setfield(L, -2, "tostring");
  lua_pushcfunction(L, silent ? print_nothing : print_to_stderr);
  lua_setfield(L, -2, "print");
  lua_getfield(L, -1, "string");
  hk_lua_replace(L, "format", format);
  lua_pop(L, 1);
  lua_getfield(L, -1, "math");
  hk_lua_replace(L, "randomseed", seed_random);
  lua_getfield(L, -1, "randomseed");
  lua_call(L, 0, 0);
  lua_pop(L, 1);
}
