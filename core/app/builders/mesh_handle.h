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
/* Pushes { vertices = { x1, y1, z1, x2, ... }, faces = { three vertices a triangle, from 1 } }. */
void hk_mesh_push_numbers(lua_State *L, const hk_mesh *);
/* hk_mesh_enter for a body whose table is at 2: in its place, pinned and moved, or free, as the keys position,
 * orientation, path, rotation, fastest, mass, density and group say. */
void hk_body_enter(lua_State *L, hk_scene *, hk_mesh *, const char *what);
/* For a solid with the keys mass, density, E and group of the table at 2: adds particles, skin, edges and handle, which
 * it pushes; the mesh, of vertices and tetrahedra, is cleared. */
void hk_solid_enter(lua_State *L, hk_scene *, hk_mesh *, const char *what);

#endif
