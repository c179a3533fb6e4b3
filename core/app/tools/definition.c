/* hooke.definition(path [, name [, answers]]): the table that a script returns, with a name through hooke.NAME{}. The
 * script only describes something, a sweep for example, so it runs as untrusted scenes do, in a Lua state of its own
 * with their sandbox and limits, where hooke has nothing but that function. What comes out is copied: texts, numbers,
 * booleans and tables; in the place of the function `answers` of the table, if it has that, stands true: hooke.ask
 * calls it. */
#include "core/app/tools/tools.h"

#include <lauxlib.h>

static const char marked; /* its address is the key of the table in the registry */

typedef struct definition {
  lua_State *to;           /* the tool's, in which the table is put on the stack */
  const char *path, *name; /* name NULL: the table as it is */
  const char *answers;     /* NULL: no function may be in it */
} definition;

static int mark(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lua_pushvalue(L, 1);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &marked);
  return 1;
}

/* In the place of hooke: no scene is made here. */
static void open_hooke(lua_State *L, const char *name) {
  lua_createtable(L, 0, 2);
  lua_getglobal(L, "hooke");
  lua_getfield(L, -1, "version");
  lua_setfield(L, -3, "version");
  lua_pop(L, 1);
  if (name) lua_pushcfunction(L, mark);
  if (name) lua_setfield(L, -2, name);
  lua_setglobal(L, "hooke");
}

/* In the table on top of the stack, past its metatable. */
static void take_function_for_true(lua_State *L, const char *name) {
  lua_pushstring(L, name);
  bool is_function = lua_rawget(L, -2) == LUA_TFUNCTION;
  lua_pop(L, 1);
  if (!is_function) return;
  lua_pushstring(L, name);
  lua_pushboolean(L, true);
  lua_rawset(L, -3);
}

static int run(lua_State *L) {
  definition *d = lua_touserdata(L, 1);
  open_hooke(L, d->name);
  const char *what = lua_pushfstring(L, d->name ? "%s: the table of hooke.%s{}" : "%s: its table", d->path, d->name);
  hk_lua_run_file(L);
  if (!d->name) {
    if (!lua_istable(L, -1)) hk_lua_fail(L, HK_SCRIPT, "%s: it has to return a table", d->path);
    hk_tool_copy(d->to, L, what);
    return 0;
  }
  lua_rawgetp(L, LUA_REGISTRYINDEX, &marked);
  if (!lua_istable(L, -1) || !lua_rawequal(L, -1, -2))
    hk_lua_fail(L, HK_SCRIPT, "%s: a %s script ends with return hooke.%s { ... }", d->path, d->name, d->name);
  if (d->answers) take_function_for_true(L, d->answers);
  hk_tool_copy(d->to, L, what);
  return 0;
}

int hk_tool_definition(lua_State *L) {
  definition d = {.to = L, .path = luaL_checkstring(L, 1), .name = luaL_optstring(L, 2, NULL)};
  d.answers = luaL_optstring(L, 3, NULL);
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
