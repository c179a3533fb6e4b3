/* amplification: the growth factor on the linear oscillator x'' = -g x' - w^2 x that an integrator's plugin states, for
 * tools that compare it with measured growth. */
#include "core/engine/host/host.h"

#include <dlfcn.h>
#include <lauxlib.h>
#include <lua.h>
#include <string.h>

/* Opens a plugin, which is never unloaded, as in hooke. Raises an error when there is no integrator of this interface
 * at `path`. */
static const hk_plugin *open_integrator(lua_State *L, const char *path) {
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!handle) luaL_error(L, "%s", dlerror());
  const hk_plugin *plugin = dlsym(handle, "hk_plugin_main");
  if (!plugin || plugin->abi >> 16 != HK_ABI_MAJOR || plugin->kind != HK_INTEGRATOR)
    luaL_error(L, "%s is no integrator for plugin interface %d.%d", path, HK_ABI_MAJOR, HK_ABI_MINOR);
  return plugin;
}

/* open(path) -> function(hw, hg), with the method's default parameters, -> growth factor of a step; or nil when the
 * method does not state it. */
static int call(lua_State *L) {
  const hk_integrator *method = lua_touserdata(L, lua_upvalueindex(1));
  const void *parameters = lua_touserdata(L, lua_upvalueindex(2));
  lua_pushnumber(L, method->growth(parameters, method->method, luaL_checknumber(L, 1), luaL_checknumber(L, 2), 0));
  return 1;
}

static int open_growth(lua_State *L) {
  const hk_plugin *plugin = open_integrator(L, luaL_checkstring(L, 1));
  if (!plugin->integrator->growth) return 0;
  hk_error error = {0};
  hk_plugin_spec *spec = hk_spec_create(plugin, plugin->name, "", &error);
  if (!spec) return luaL_error(L, "%s", error.text);
  lua_pushlightuserdata(L, (void *)(uintptr_t)plugin->integrator);
  memcpy(lua_newuserdatauv(L, plugin->instance_size + 1, 0), spec->values, plugin->instance_size);
  hk_spec_destroy(spec);
  lua_pushcclosure(L, call, 2);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_amplification(lua_State *L);

int luaopen_amplification(lua_State *L) {
  static const luaL_Reg functions[] = {{"open", open_growth}, {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
