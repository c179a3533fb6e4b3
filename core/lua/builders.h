/* What builders share. */
#ifndef HK_LUA_BUILDERS_H
#define HK_LUA_BUILDERS_H

#include "core/lua/internal.h"

hk_lua_handle *hk_lua_push_handle(lua_State *L, hk_lua_handle shape);
uint32_t hk_lua_group(lua_State *L, hk_scene *scene, int table, const char *what); /* of the key "group" */
/* Adds particles; returns the first id. Errors begin with `what`. */
uint32_t hk_lua_add(lua_State *L, hk_scene *scene, const char *what, size_t count, const double *x, const double *v,
                    const double *mass, double common, uint32_t group);
int hk_lua_mesh(lua_State *L); /* lua_mesh.c: scene:mesh{} */

#endif
