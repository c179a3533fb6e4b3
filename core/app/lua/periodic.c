/* scene:periodic{}: a box that repeats along some axes. */
#include "core/app/lua/internal.h"

int hk_lua_scene_periodic(lua_State *L) {
  static const char *const keys[] = {"low", "high", "axes", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_error error = {0};
  double low[3] = {0}, high[3] = {0};
  if (scene->frozen) return hk_lua_fail(L, HK_BAD_PARAM, "the scene runs and can no longer be edited");
  hk_lua_check_table(L, 2, "periodic", "scene:periodic { high = { 10, 10, 10 } }");
  hk_lua_check_keys(L, 2, "periodic", keys);
  hk_lua_field_vector(L, 2, "periodic", "low", low);
  if (!hk_lua_field_vector(L, 2, "periodic", "high", high))
    return hk_lua_fail(L, HK_BAD_PARAM, "periodic: high is required, the box's upper corner, { x, y, z } m");
  int type = hk_lua_field(L, 2, "axes");
  if (type != LUA_TNIL && type != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "periodic: axes: expected a text such as \"xy\", got %s", luaL_typename(L, -1));
  const char *axes = type == LUA_TSTRING ? lua_tostring(L, -1) : "xyz";
  if (hk_scene_set_box(scene, low, high, axes, &error) != HK_OK) hk_lua_raise(L, &error);
  return 0;
}
