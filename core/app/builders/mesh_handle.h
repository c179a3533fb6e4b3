#ifndef HK_MESH_HANDLE_H
#define HK_MESH_HANDLE_H

#include "core/app/builders/builders.h"
#include "core/app/mesh_files/mesh_files.h"

/* A third of every triangle's mass to each of its corners, as a block on the stack; `what` begins the error of a vertex
 * without area. density in kg/m^2. */
const double *hk_mesh_push_masses(lua_State *L, const hk_mesh *, const char *what, double density);
/* Adds the triangles of a mesh whose vertices are the particles of h, and their sides as edges of the scene if asked.
 * Pushes the handle; the mesh is cleared. */
void hk_mesh_enter(lua_State *L, hk_scene *, hk_mesh *, hk_lua_handle h, bool edges);

#endif
