/* A mesh as a userdata, which Lua's collector frees. */
#include "core/app/mesh_files/mesh_files.h"

static int mesh_gc(lua_State *L) {
  hk_mesh_clear(lua_touserdata(L, 1));
  return 0;
}

hk_mesh *hk_mesh_new(lua_State *L) {
  hk_mesh *m = lua_newuserdatauv(L, sizeof *m, 0);
  *m = (hk_mesh){0};
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, mesh_gc);
  lua_setfield(L, -2, "__gc");
  lua_setmetatable(L, -2);
  return m;
}
