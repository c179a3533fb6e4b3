/* Replacements for functions of Lua's library with which a scene could evade its limits: pcall, xpcall and
 * coroutine.resume pass on the error of a script that exceeded a limit, and long loops inside C functions, which no
 * hook can end, are refused. Patterns of string.find and similar functions are not covered: the time of some grows
 * exponentially with the length of the text. */
#include "core/lua/internal.h"

/* ---- calls that catch errors ---- */

static int caught(lua_State *L, int status, lua_KContext extra) {
  if (status == LUA_OK || status == LUA_YIELD) return lua_gettop(L) - (int)extra;
  if (hk_lua_script(L)->spent) return lua_error(L);
  lua_pushboolean(L, 0);
  lua_insert(L, -2);
  return 2;
}

static int guarded_pcall(lua_State *L) {
  luaL_checkany(L, 1);
  lua_pushboolean(L, 1);
  lua_insert(L, 1);
  return caught(L, lua_pcallk(L, lua_gettop(L) - 2, LUA_MULTRET, 0, 0, caught), 0);
}

static int guarded_xpcall(lua_State *L) {
  int count = lua_gettop(L);
  luaL_checktype(L, 2, LUA_TFUNCTION);
  lua_pushboolean(L, 1);
  lua_pushvalue(L, 1);
  lua_rotate(L, 3, 2);
  return caught(L, lua_pcallk(L, count - 2, LUA_MULTRET, 2, 2, caught), 2);
}

static int guarded_resume(lua_State *L) {
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  if (!lua_toboolean(L, 1) && hk_lua_script(L)->spent) return lua_error(L);
  return lua_gettop(L);
}

/* ---- loops inside C functions ---- */

/* Refuses more iterations than a list within the memory limit can have members. */
static void check_turns(lua_State *L, const char *name, double turns) {
  if (turns > (double)hk_lua_script(L)->memory_limit / 16)
    hk_lua_fail(L, HK_SCRIPT, "%s: %g is beyond what the script's memory holds", name, turns);
}

static int original(lua_State *L) {
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  return lua_gettop(L);
}

static int guarded_rep(lua_State *L) {
  size_t length;
  luaL_checklstring(L, 1, &length);
  if (length == 0) check_turns(L, "string.rep", luaL_checknumber(L, 2));
  return original(L);
}

static int guarded_move(lua_State *L) {
  check_turns(L, "table.move", luaL_checknumber(L, 3) - luaL_checknumber(L, 2));
  return original(L);
}

static int guarded_length(lua_State *L) {
  if (luaL_getmetafield(L, 1, "__len") != LUA_TNIL) {
    lua_pop(L, 1);
    check_turns(L, "a table's __len", (double)luaL_len(L, 1));
  }
  return original(L);
}

/* ---- installing the guards: the environment is on top of the stack ---- */

/* Replaces member `name` of the table on top by `guard`, whose upvalue is the original. */
static void guard(lua_State *L, const char *name, lua_CFunction by) {
  lua_getfield(L, -1, name);
  lua_pushcclosure(L, by, 1);
  lua_setfield(L, -2, name);
}

void hk_lua_guard(lua_State *L) {
  guard(L, "pcall", guarded_pcall);
  guard(L, "xpcall", guarded_xpcall);
  lua_getfield(L, -1, "coroutine");
  guard(L, "resume", guarded_resume);
  lua_pop(L, 1);
  lua_getfield(L, -1, "string");
  guard(L, "rep", guarded_rep);
  lua_pop(L, 1);
  lua_getfield(L, -1, "table");
  guard(L, "move", guarded_move);
  guard(L, "insert", guarded_length);
  guard(L, "remove", guarded_length);
  lua_pop(L, 1);
}
