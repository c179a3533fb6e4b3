/* resting: static equilibrium of a run, for `hooke rest` and shapes of `hooke fit`; and what single particles are
 * called. */
#include "core/app/lua/lua.h"
#include "tools/native/common/equilibrium.h"

#include <lauxlib.h>

static void set(lua_State *L, const char *name, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, name);
}

static void set_flag(lua_State *L, const char *name, bool value) {
  lua_pushboolean(L, value);
  lua_setfield(L, -2, name);
}

/* find(run, tolerance): the figures of the equilibrium that the run is at then; or nil and why there is none. */
static int find(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  hk_equilibrium e = {.tolerance = luaL_checknumber(L, 2)};
  hk_error error = {0};
  if (hk_equilibrium_find(run, &e, &error) != HK_OK) {
    lua_pushnil(L);
    lua_pushstring(L, error.text);
    return 2;
  }
  lua_createtable(L, 0, 12);
  set(L, "residual", e.residual);
  set(L, "id", e.id);
  set(L, "first", e.first);
  set(L, "allowed", e.allowed);
  set(L, "lowered", e.lowered);
  set(L, "stages", (double)e.stages);
  set(L, "pushed", e.pushed);
  set(L, "away", e.away);
  set_flag(L, "balanced", e.balanced);
  set_flag(L, "asked", e.asked);
  set_flag(L, "returned", e.returned);
  return 1;
}

/* write(run, path): its state as a table, from which scene:start begins; or nil and why not. */
static int write_state(lua_State *L) {
  hk_error error = {0};
  if (hk_run_write_state(hk_lua_run(L), luaL_checkstring(L, 2), &error) == HK_OK) {
    lua_pushboolean(L, 1);
    return 1;
  }
  lua_pushnil(L);
  lua_pushstring(L, error.text);
  return 2;
}

/* groups(run) -> { name = the id of the group's one particle, or false where it has several } */
static int groups(lua_State *L) {
  const hk_state *s = &hk_lua_run(L)->state;
  lua_createtable(L, 0, (int)s->start->groups);
  for (size_t i = 0; i < s->model.n; i++) {
    const char *name = s->start->group_name[s->group[i]];
    if (lua_getfield(L, -1, name) == LUA_TNIL)
      lua_pushinteger(L, s->id[i]);
    else
      lua_pushboolean(L, 0);
    lua_setfield(L, -3, name);
    lua_pop(L, 1);
  }
  return 1;
}

__attribute__((visibility("default"))) int luaopen_resting(lua_State *L);
int luaopen_resting(lua_State *L) {
  static const luaL_Reg functions[] = {{"find", find}, {"write", write_state}, {"groups", groups}, {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
