/* Replacements for functions of Lua's library with which a scene could evade its limits: pcall, xpcall and
 * coroutine.resume pass on the error of a script that exceeded a limit, long loops inside C functions, which no hook
 * can end, are refused, and so are more results than the stack has slots. What remains, such as patterns whose time
 * grows exponentially with the length of the text, is ended by the watchdog (hk_pulse). */
#include "core/app/lua/internal.h"

static int original(lua_State *L) {
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  return lua_gettop(L);
}

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

/* Errors of a hook call the handler with hooks switched off: the script's own could run without end. */
static int handle(lua_State *L) {
  if (hk_lua_script(L)->spent) return 1;
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, 1);
  return 1;
}

static int guarded_xpcall(lua_State *L) {
  int count = lua_gettop(L);
  luaL_checktype(L, 2, LUA_TFUNCTION);
  lua_pushvalue(L, 2);
  lua_pushcclosure(L, handle, 1);
  lua_replace(L, 2);
  lua_pushboolean(L, 1);
  lua_pushvalue(L, 1);
  lua_rotate(L, 3, 2);
  return caught(L, lua_pcallk(L, count - 2, LUA_MULTRET, 2, 2, caught), 2);
}

/* A coroutine whose stack grew for its arguments would have one that moves. */
static void check_arguments(lua_State *L, int count) {
  int slots = hk_stack_coroutine_slots();
  if (count >= slots)
    hk_lua_fail(L, HK_SCRIPT, "%d arguments are more than a coroutine may be given, %d", count, slots);
}

/* resume, close */
static int guarded_resume(lua_State *L) {
  check_arguments(L, lua_gettop(L) - 1);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  if (!lua_toboolean(L, 1) && hk_lua_script(L)->spent) return lua_error(L);
  return lua_gettop(L);
}

static int guarded_create(lua_State *L) {
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, 1);
  hk_limits_coroutine(L, lua_tothread(L, -1));
  return 1;
}

static int guarded_wrapped(lua_State *L) {
  check_arguments(L, lua_gettop(L));
  return original(L);
}

/* The first upvalue of the function that coroutine.wrap makes is its coroutine. */
static int guarded_wrap(lua_State *L) {
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, 1);
  if (lua_getupvalue(L, -1, 1)) {
    if (lua_isthread(L, -1)) hk_limits_coroutine(L, lua_tothread(L, -1));
    lua_pop(L, 1);
  }
  lua_pushcclosure(L, guarded_wrapped, 1);
  return 1;
}

/* ---- loops inside C functions ---- */

/* Refuses more iterations than a list within the memory limit can have members. */
static void check_turns(lua_State *L, const char *name, double turns) {
  if (turns > (double)hk_lua_script(L)->memory_limit / 16)
    hk_lua_fail(L, HK_SCRIPT, "%s: %g is beyond what the script's memory holds", name, turns);
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

/* ---- more values than the stack has slots (script/stack.c) ---- */

static void check_results(lua_State *L, const char *name, double count) {
  int slots = hk_stack_slots(hk_lua_script(L), L);
  if (count > slots)
    hk_lua_fail(L, HK_SCRIPT, "%s: %.9g results are more than a call may give here, %d", name, count, slots);
}

static int guarded_unpack(lua_State *L) {
  lua_settop(L, 3);
  if (lua_isnil(L, 3)) {
    lua_pushinteger(L, luaL_len(L, 1));
    lua_replace(L, 3);
  }
  check_results(L, "table.unpack", (double)luaL_checkinteger(L, 3) - (double)luaL_optinteger(L, 2, 1) + 1);
  return original(L);
}

/* string.byte and utf8.codepoint: of a text, from one place to another, which count from the end where negative. */
static int guarded_bytes(lua_State *L) {
  size_t length;
  luaL_checklstring(L, 1, &length);
  lua_Integer given = luaL_optinteger(L, 2, 1);
  double first = (double)given, last = (double)luaL_optinteger(L, 3, given);
  double from = first < 0 ? fmax(first + (double)length + 1, 1) : first;
  double to = last < 0 ? last + (double)length + 1 : fmin(last, (double)length);
  check_results(L, "a text's part", to - from + 1);
  return original(L);
}

/* ---- lists ---- */

/* Where what is no list is gone through as one: the result of a function that gives one value, or a wrong name. */
static int guarded_pairs(lua_State *L) {
  int type = lua_type(L, 1);
  const char *name = lua_tostring(L, lua_upvalueindex(2));
  bool list = type == LUA_TTABLE || type == LUA_TUSERDATA;
  if (!list && luaL_getmetafield(L, 1, "__pairs") == LUA_TNIL)
    return hk_lua_fail(L, HK_SCRIPT, "%s goes through a table, and this is %s%s", name, hk_lua_kind(L, 1),
                       type == LUA_TNUMBER ? ": use it as it is" : "");
  return original(L);
}

static void guard_pairs(lua_State *L, const char *name) {
  lua_getfield(L, -1, name);
  lua_pushstring(L, name);
  lua_pushcclosure(L, guarded_pairs, 2);
  lua_setfield(L, -2, name);
}

/* ---- installing the guards: the environment is on top of the stack ---- */

void hk_lua_replace(lua_State *L, const char *name, lua_CFunction by) {
  lua_getfield(L, -1, name);
  lua_pushcclosure(L, by, 1);
  lua_setfield(L, -2, name);
}

void hk_lua_guard(lua_State *L) {
  hk_lua_replace(L, "pcall", guarded_pcall);
  hk_lua_replace(L, "xpcall", guarded_xpcall);
  guard_pairs(L, "pairs");
  guard_pairs(L, "ipairs");
  lua_getfield(L, -1, "coroutine");
  hk_lua_replace(L, "resume", guarded_resume);
  hk_lua_replace(L, "close", guarded_resume);
  hk_lua_replace(L, "create", guarded_create);
  hk_lua_replace(L, "wrap", guarded_wrap);
  lua_pop(L, 1);
  lua_getfield(L, -1, "string");
  hk_lua_replace(L, "rep", guarded_rep);
  hk_lua_replace(L, "byte", guarded_bytes);
  lua_pop(L, 1);
  lua_getfield(L, -1, "table");
  hk_lua_replace(L, "move", guarded_move);
  hk_lua_replace(L, "insert", guarded_length);
  hk_lua_replace(L, "remove", guarded_length);
  hk_lua_replace(L, "unpack", guarded_unpack);
  lua_pop(L, 1);
  lua_getfield(L, -1, "utf8");
  hk_lua_replace(L, "codepoint", guarded_bytes);
  lua_pop(L, 1);
}
