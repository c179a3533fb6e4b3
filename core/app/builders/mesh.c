/* scene:mesh{ file = "name.obj" }, or scene:mesh{ vertices =, faces = } by hand: vertices become particles, faces
 * become triangles, and their sides become edges. With `density`, kg/m^2, a vertex has a third of the mass of every
 * triangle around it, so that refinement does not move mass to the border; with `mass` all have the same.
 * scene:surface{ file = "name.obj" }: the numbers alone, for plugins that take them. */
#include "core/app/builders/mesh_handle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- meshes by hand ---- */

static void take_vertices(lua_State *L, hk_mesh *m) {
  char what[64];
  int list = lua_gettop(L);
  for (lua_Integer k = 1; lua_rawgeti(L, list, k) != LUA_TNIL; k++, lua_pop(L, 1)) {
    double x[3];
    snprintf(what, sizeof what, "mesh: vertices[%lld]", (long long)k);
    hk_lua_vector(L, -1, what, x);
    const char *wrong = hk_mesh_add_vertex(m, x);
    if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s", what, wrong);
  }
}

/* The corners of the face on top of the stack. */
static size_t take_corners(lua_State *L, const hk_mesh *m, const char *what, uint32_t *corner) {
  size_t count = 0;
  if (!lua_istable(L, -1)) hk_lua_fail(L, HK_BAD_PARAM, "%s: expected a list of vertices, {1, 2, 3}", what);
  for (; lua_rawgeti(L, -1, (lua_Integer)count + 1) != LUA_TNIL && count <= HK_FACE_CORNERS; count++, lua_pop(L, 1)) {
    double index = lua_type(L, -1) == LUA_TNUMBER ? lua_tonumber(L, -1) : NAN;
    if (!(index >= 1 && index <= (double)m->vertices && floor(index) == index))
      hk_lua_fail(L, HK_BAD_PARAM, "%s: corner %d is none of the vertices 1 to %d", what, (int)count + 1,
                  (int)m->vertices);
    corner[count] = (uint32_t)index - 1;
  }
  lua_pop(L, 1);
  return count;
}

static void take_faces(lua_State *L, hk_mesh *m) {
  char what[64];
  uint32_t corner[HK_FACE_CORNERS + 1];
  int list = lua_gettop(L);
  for (lua_Integer k = 1; lua_rawgeti(L, list, k) != LUA_TNIL; k++, lua_pop(L, 1)) {
    snprintf(what, sizeof what, "mesh: faces[%lld]", (long long)k);
    const char *wrong = hk_mesh_add_face(m, corner, take_corners(L, m, what, corner));
    if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s", what, wrong);
  }
}

static void read_mesh(lua_State *L, hk_mesh *m) {
  if (hk_lua_field(L, 2, "file") == LUA_TSTRING)
    hk_mesh_load(L, m, "mesh", lua_tostring(L, -1));
  else if (hk_lua_field(L, 2, "vertices") == LUA_TTABLE) {
    take_vertices(L, m);
    if (hk_lua_field(L, 2, "faces") == LUA_TTABLE) take_faces(L, m);
    if (m->vertices == 0) hk_lua_fail(L, HK_BAD_PARAM, "mesh: vertices: there are none");
  } else
    hk_lua_fail(L, HK_BAD_PARAM, "mesh: file is required, an OBJ file, or vertices and faces");
}

/* ---- into the scene ---- */

static hk_lua_handle add_vertices(lua_State *L, hk_scene *scene, hk_mesh *m) {
  double scale = hk_lua_field_number(L, 2, "mesh", "scale", 1), origin[3] = {0};
  double density, mass = hk_lua_mass(L, 2, "mesh", &density);
  hk_lua_field_vector(L, 2, "mesh", "origin", origin);
  for (size_t k = 0; k < 3 * m->vertices; k++) m->vertex[k] = origin[k % 3] + scale * m->vertex[k];
  const double *each = density > 0 ? hk_mesh_push_masses(L, m, "mesh", density) : NULL;
  hk_lua_handle h = {.count = (uint32_t)m->vertices, .nx = (uint32_t)m->vertices, .ny = 1};
  h.first = hk_lua_add(L, scene, "mesh", m->vertices, m->vertex, NULL, each, mass / (double)m->vertices,
                       hk_lua_group(L, scene, 2, "mesh"));
  return h;
}

int hk_build_mesh(lua_State *L) {
  static const char *const keys[] = {"file",  "vertices", "faces", "mass",     "density",
                                     "scale", "origin",   "group", "material", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "mesh", "scene:mesh { ... }");
  lua_settop(L, 2);
  hk_lua_take_material(L, scene, 2, "mesh");
  hk_lua_check_keys(L, 2, "mesh", keys);
  hk_mesh *m = hk_mesh_new(L);
  read_mesh(L, m);
  lua_settop(L, 3);
  hk_lua_handle h = add_vertices(L, scene, m);
  hk_mesh_enter(L, scene, m, h, true);
  return 1;
}

static void push_corners(lua_State *L, const hk_mesh *m) {
  lua_createtable(L, (int)(3 * m->triangles), 0);
  for (size_t k = 0; k < 3 * m->triangles; k++) {
    lua_pushinteger(L, (lua_Integer)m->triangle[k / 3][k % 3] + 1);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

void hk_mesh_push_numbers(lua_State *L, const hk_mesh *m) {
  lua_createtable(L, 0, 3);
  lua_createtable(L, (int)(3 * m->vertices), 0);
  for (size_t k = 0; k < 3 * m->vertices; k++) {
    lua_pushnumber(L, m->vertex[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "vertices");
  push_corners(L, m);
  lua_setfield(L, -2, "faces");
}

/* { vertices = { x1, y1, z1, x2, ... }, faces = { three vertices a triangle, from 1 }, file = } */
int hk_build_surface(lua_State *L) {
  static const char *const keys[] = {"file", "scale", "origin", NULL};
  hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "surface", "scene:surface { ... }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "surface", keys);
  if (hk_lua_field(L, 2, "file") != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "surface: file is required, an OBJ file");
  hk_mesh *m = hk_mesh_new(L);
  hk_mesh_load(L, m, "surface", lua_tostring(L, 3));
  double scale = hk_lua_field_number(L, 2, "surface", "scale", 1), origin[3] = {0};
  hk_lua_field_vector(L, 2, "surface", "origin", origin);
  for (size_t k = 0; k < 3 * m->vertices; k++) m->vertex[k] = origin[k % 3] + scale * m->vertex[k];
  hk_mesh_push_numbers(L, m);
  lua_pushvalue(L, 3);
  lua_setfield(L, -2, "file");
  hk_mesh_clear(m);
  return 1;
}
