/* The userdata of a scene: the scene and the script that owns it, which is the script of the Lua state or, in a tool,
 * the script that the tool loaded. The first user value of the userdata keeps a loaded script alive. */
#include "core/app/script/script.h"

const char hk_lua_scene_type[] = "hooke.scene", hk_lua_state_type[] = "hooke.state";

hk_lua_scene_handle *hk_lua_push_scene(lua_State *L) {
  hk_lua_scene_handle *handle = lua_newuserdatauv(L, sizeof *handle, 1);
  *handle = (hk_lua_scene_handle){NULL, hk_lua_script(L)};
  luaL_setmetatable(L, hk_lua_scene_type);
  return handle;
}

static hk_lua_scene_handle *handle_at(lua_State *L, int index) {
  hk_lua_scene_handle *handle = luaL_testudata(L, index, hk_lua_scene_type);
  if (!handle) hk_lua_fail(L, HK_SCRIPT, "a scene's functions are called with a colon: scene:force(...)");
  return handle;
}

hk_lua_slot *hk_lua_slot_at(lua_State *L, int index) { return handle_at(L, index)->slot; }
hk_scene *hk_lua_scene(lua_State *L, int index) { return handle_at(L, index)->slot->scene; }
hk_script *hk_lua_owner(lua_State *L, int index) { return handle_at(L, index)->owner; }

/* In a function that a run calls a state is that run's, otherwise that of the run that the script drives. */
hk_run *hk_lua_state_run(lua_State *L, int index) {
  hk_lua_slot **holder = luaL_testudata(L, index, hk_lua_state_type);
  const hk_run *calling = hk_lua_script(L)->calling;
  if (!holder) return NULL;
  return calling && calling->scene == (*holder)->scene ? (hk_run *)(uintptr_t)calling : (*holder)->run;
}
