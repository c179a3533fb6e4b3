/* scene:mesh{ file = "name.obj" }, or scene:mesh{ vertices =, faces = } by hand: vertices become particles, faces
 * become triangles, and their sides become edges. With `density`, kg/m^2, a vertex has a third of the mass of every
 * triangle around it, so that refinement does not move mass to the border; with `mass` all have the same.
 * scene:surface{ file = "name.obj" }: the numbers alone, for plugins that take them. */
#include "core/builders/obj_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A side of a triangle, with the lower id first, and the opposite corner. */
typedef struct side {
  uint32_t a, b, opposite;
} side;

static int by_ends(const void *left, const void *right) {
  const side *s = left, *t = right;
  if (s->a != t->a) return s->a < t->a ? -1 : 1;
  if (s->b != t->b) return s->b < t->b ? -1 : 1;
  return (s->opposite > t->opposite) - (s->opposite < t->opposite);
}

/* The sides of all triangles, sorted, as a block on the stack. */
static side *push_sides(lua_State *L, const hk_mesh *m, uint32_t first) {
  side *list = lua_newuserdatauv(L, (3 * m->triangles + 1) * sizeof *list, 0);
  for (size_t k = 0; k < 3 * m->triangles; k++) {
    const uint32_t *corner = m->triangle[k / 3];
    uint32_t a = corner[k % 3], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];
    list[k] = (side){first + (a < b ? a : b), first + (a < b ? b : a), first + c};
  }
  qsort(list, 3 * m->triangles, sizeof *list, by_ends);
  return list;
}

/* Pushes each side once, or, for flexion, the pairs of corners opposite to a common side. */
static hk_lua_edges *push_pairs(lua_State *L, const side *list, size_t sides, bool facing) {
  hk_lua_edges *edges = hk_lua_new_edges(L, sides); /* upper bound of the number */
  edges->count = 0;
  for (size_t k = 0; k < sides; k++) {
    bool again = k > 0 && list[k].a == list[k - 1].a && list[k].b == list[k - 1].b;
    if (again != facing || (again && list[k].opposite == list[k - 1].opposite)) continue;
    uint32_t *pair = edges->pair[edges->count++];
    pair[0] = facing ? list[k - 1].opposite : list[k].a;
    pair[1] = facing ? list[k].opposite : list[k].b;
  }
  return edges;
}

static void push_triangles(lua_State *L, const hk_mesh *m) {
  lua_createtable(L, (int)m->triangles, 0);
  for (size_t t = 0; t < m->triangles; t++) {
    lua_createtable(L, 3, 0);
    for (int c = 0; c < 3; c++) {
      lua_pushinteger(L, m->triangle[t][c]);
      lua_rawseti(L, -2, c + 1);
    }
    lua_rawseti(L, -2, (lua_Integer)t + 1);
  }
}

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

static double area_of(const hk_mesh *m, const uint32_t corner[3]) {
  const double *a = m->vertex + 3 * (size_t)corner[0], *b = m->vertex + 3 * (size_t)corner[1],
               *c = m->vertex + 3 * (size_t)corner[2];
  double square = 0;
  for (int k = 0, p = 1, q = 2; k < 3; k++, p = (p + 1) % 3, q = (q + 1) % 3) {
    double n = (b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]);
    square += n * n;
  }
  return sqrt(square) / 2;
}

/* The masses of the vertices, as a block on the stack. */
static const double *push_masses(lua_State *L, const hk_mesh *m, double density) {
  double *mass = lua_newuserdatauv(L, m->vertices * sizeof *mass, 0);
  for (size_t i = 0; i < m->vertices; i++) mass[i] = 0;
  for (size_t t = 0; t < m->triangles; t++)
    for (int k = 0; k < 3; k++) mass[m->triangle[t][k]] += density * area_of(m, m->triangle[t]) / 3;
  for (size_t i = 0; i < m->vertices; i++)
    if (!(mass[i] > 0))
      hk_lua_fail(L, HK_BAD_PARAM, "mesh: density: vertex %d has no area around it, and so no mass", (int)i + 1);
  return mass;
}

static hk_lua_handle add_vertices(lua_State *L, hk_scene *scene, hk_mesh *m) {
  double scale = hk_lua_field_number(L, 2, "mesh", "scale", 1), origin[3] = {0};
  double density, mass = hk_lua_mass(L, 2, "mesh", &density);
  hk_lua_field_vector(L, 2, "mesh", "origin", origin);
  for (size_t k = 0; k < 3 * m->vertices; k++) m->vertex[k] = origin[k % 3] + scale * m->vertex[k];
  const double *each = density > 0 ? push_masses(L, m, density) : NULL;
  hk_lua_handle h = {.count = (uint32_t)m->vertices, .nx = (uint32_t)m->vertices, .ny = 1};
  h.first = hk_lua_add(L, scene, "mesh", m->vertices, m->vertex, NULL, each, mass / (double)m->vertices,
                       hk_lua_group(L, scene, 2, "mesh"));
  return h;
}

int hk_build_mesh(lua_State *L) {
  static const char *const keys[] = {"file",  "vertices", "faces", "mass",     "density",
                                     "scale", "origin",   "group", "material", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_error error = {0};
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_take_material(L, 2, "mesh");
  hk_lua_check_keys(L, 2, "mesh", keys);
  hk_mesh *m = hk_mesh_new(L);
  read_mesh(L, m);
  lua_settop(L, 3);
  hk_lua_handle h = add_vertices(L, scene, m);
  hk_lua_push_handle(L, h);
  int handle = lua_gettop(L);
  const side *list = push_sides(L, m, h.first);
  const hk_lua_edges *edges = push_pairs(L, list, 3 * m->triangles, false);
  hk_limits_take(L, edges->count * sizeof *edges->pair + m->triangles * sizeof *m->triangle);
  hk_status status = hk_scene_add_edges(scene, edges->count, (const uint32_t(*)[2])edges->pair, &error);
  lua_setiuservalue(L, handle, 1);
  push_pairs(L, list, 3 * m->triangles, true);
  lua_setiuservalue(L, handle, 3);
  lua_settop(L, handle);
  for (size_t k = 0; k < 3 * m->triangles; k++) m->triangle[k / 3][k % 3] += h.first;
  if (status == HK_OK) status = hk_scene_add_triangles(scene, m->triangles, (const uint32_t(*)[3])m->triangle, &error);
  if (status != HK_OK) return hk_lua_raise(L, &error);
  push_triangles(L, m);
  lua_setiuservalue(L, -2, 2);
  hk_mesh_clear(m);
  return 1;
}

static void push_corners(lua_State *L, const hk_mesh *m) {
  lua_createtable(L, (int)(3 * m->triangles), 0);
  for (size_t k = 0; k < 3 * m->triangles; k++) {
    lua_pushinteger(L, (lua_Integer)m->triangle[k / 3][k % 3] + 1);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

/* { vertices = { x1, y1, z1, x2, ... }, faces = { three vertices a triangle, from 1 }, file = } */
int hk_build_surface(lua_State *L) {
  static const char *const keys[] = {"file", "scale", "origin", NULL};
  hk_lua_scene(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "surface", keys);
  if (hk_lua_field(L, 2, "file") != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "surface: file is required, an OBJ file");
  hk_mesh *m = hk_mesh_new(L);
  hk_mesh_load(L, m, "surface", lua_tostring(L, 3));
  double scale = hk_lua_field_number(L, 2, "surface", "scale", 1), origin[3] = {0};
  hk_lua_field_vector(L, 2, "surface", "origin", origin);
  lua_createtable(L, 0, 3);
  lua_pushvalue(L, 3);
  lua_setfield(L, -2, "file");
  lua_createtable(L, (int)(3 * m->vertices), 0);
  for (size_t k = 0; k < 3 * m->vertices; k++) {
    lua_pushnumber(L, origin[k % 3] + scale * m->vertex[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "vertices");
  push_corners(L, m);
  lua_setfield(L, -2, "faces");
  hk_mesh_clear(m);
  return 1;
}
