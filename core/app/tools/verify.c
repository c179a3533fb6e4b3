/* run:verify() of tools: loads the scene again for a second run, and returns the summary with the result of the check
 * and the error of the second run, or of writing that to the run's summary.json. */
#include "core/app/tools/tools.h"

#include <lauxlib.h>

static int verify(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  lua_getiuservalue(L, 1, 1);
  hk_script *owner = hk_lua_owner(L, -1);
  hk_summary s;
  hk_error error = {0};
  if (owner == hk_lua_script(L)) return hk_lua_fail(L, HK_SCRIPT, "run:verify is for scenes that hooke.load loaded");
  hk_run_summary(run, &s);
  hk_status status = hk_script_verify(hk_script_path(owner), hk_script_asked(owner), hk_script_run_options(owner), true,
                                      run, &s, &error);
  hk_error unwritten = {0};
  hk_run_write_summary(run, &s, &unwritten); /* summary.json has the run's own verdict until now */
  hk_lua_push_summary(L, &s);
  if (status == HK_OK && unwritten.status != HK_OK) status = unwritten.status, error = unwritten;
  if (status == HK_OK) return 1;
  lua_pushstring(L, error.text);
  return 2;
}

void hk_tool_open_verify(lua_State *L) {
  luaL_getmetatable(L, hk_lua_run_type);
  lua_getfield(L, -1, "__index");
  lua_pushcfunction(L, verify);
  lua_setfield(L, -2, "verify");
  lua_pop(L, 2);
}
