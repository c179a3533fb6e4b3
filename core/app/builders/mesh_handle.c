/* A mesh on its way into a scene: the masses of its vertices, its triangles, their sides, and the handle that has them.
 */
#include "core/app/builders/mesh_handle.h"

#include <stdlib.h>
#include <string.h>

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

const double *hk_mesh_push_masses(lua_State *L, const hk_mesh *m, const char *what, double density) {
  double *mass = lua_newuserdatauv(L, m->vertices * sizeof *mass, 0);
  for (size_t i = 0; i < m->vertices; i++) mass[i] = 0;
  for (size_t t = 0; t < m->triangles; t++)
    for (int k = 0; k < 3; k++) mass[m->triangle[t][k]] += density * area_of(m, m->triangle[t]) / 3;
  for (size_t i = 0; i < m->vertices; i++)
    if (!(mass[i] > 0))
      hk_lua_fail(L, HK_BAD_PARAM, "%s: density: vertex %d has no area around it, and so no mass", what, (int)i + 1);
  return mass;
}

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

void hk_mesh_enter(lua_State *L, hk_scene *scene, hk_mesh *m, hk_lua_handle h, bool edges) {
  hk_error error = {0};
  hk_lua_push_handle(L, h);
  int handle = lua_gettop(L);
  const side *list = push_sides(L, m, h.first);
  const hk_lua_edges *sides = push_pairs(L, list, 3 * m->triangles, false);
  hk_limits_take(L, (edges ? sides->count * sizeof *sides->pair : 0) + m->triangles * sizeof *m->triangle);
  hk_status status = HK_OK;
  if (edges) status = hk_scene_add_edges(scene, sides->count, (const uint32_t(*)[2])sides->pair, &error);
  lua_setiuservalue(L, handle, 1);
  push_pairs(L, list, 3 * m->triangles, true);
  lua_setiuservalue(L, handle, 3);
  lua_settop(L, handle);
  for (size_t k = 0; k < 3 * m->triangles; k++) m->triangle[k / 3][k % 3] += h.first;
  if (status == HK_OK) status = hk_scene_add_triangles(scene, m->triangles, (const uint32_t(*)[3])m->triangle, &error);
  if (status != HK_OK) hk_lua_raise(L, &error);
  push_triangles(L, m);
  lua_setiuservalue(L, handle, 2);
  hk_mesh_clear(m);
}
