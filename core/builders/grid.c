/* scene:grid{ nx, ny, width, height }: rows of particles in a plane, with the edges between neighbours and two
 * triangles in every cell. */
#include "core/builders/builders.h"

#include <string.h>

static void add_surface(lua_State *L, hk_scene *scene, const hk_lua_handle *h) {
  hk_error error = {0};
  size_t cells = (size_t)(h->nx - 1) * (h->ny - 1), at = 0;
  uint32_t(*triangle)[3] = lua_newuserdatauv(L, (2 * cells + 1) * sizeof *triangle, 0);
  hk_limits_take(L, 2 * cells * sizeof *triangle);
  for (uint32_t j = 0; j + 1 < h->ny; j++)
    for (uint32_t i = 0; i + 1 < h->nx; i++) {
      uint32_t a = h->first + j * h->nx + i, b = a + 1, c = a + h->nx, d = c + 1;
      memcpy(triangle[at++], (uint32_t[]){a, b, d}, sizeof *triangle);
      memcpy(triangle[at++], (uint32_t[]){a, d, c}, sizeof *triangle);
    }
  if (hk_scene_add_triangles(scene, 2 * cells, (const uint32_t(*)[3])triangle, &error) != HK_OK)
    hk_lua_raise(L, &error);
}

int hk_build_grid(lua_State *L) {
  static const char *const keys[] = {"nx", "ny", "width", "height", "mass", "origin", "u", "v", "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "grid", keys);
  hk_lua_handle h = {
      .nx = hk_lua_count(L, 2, "grid", "nx", 1), .ny = hk_lua_count(L, 2, "grid", "ny", 1), .grid = true};
  double origin[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
  double width = hk_lua_field_number(L, 2, "grid", "width", 1), height = hk_lua_field_number(L, 2, "grid", "height", 1);
  double mass = hk_lua_field_number(L, 2, "grid", "mass", 1);
  hk_lua_field_vector(L, 2, "grid", "origin", origin);
  hk_lua_field_vector(L, 2, "grid", "u", u);
  hk_lua_field_vector(L, 2, "grid", "v", v);
  size_t n = (size_t)h.nx * h.ny;
  double *x = lua_newuserdatauv(L, 3 * n * sizeof *x, 0);
  for (size_t k = 0; k < n; k++) {
    size_t row = k / h.nx;
    double s = h.nx > 1 ? width * (double)(k % h.nx) / (h.nx - 1) : 0,
           t = h.ny > 1 ? height * (double)row / (h.ny - 1) : 0;
    for (int c = 0; c < 3; c++) x[3 * k + c] = origin[c] + s * u[c] + t * v[c];
  }
  h.count = (uint32_t)n;
  h.first = hk_lua_add(L, scene, "grid", n, x, NULL, NULL, mass / (double)n, hk_lua_group(L, scene, 2, "grid"));
  lua_settop(L, 2);
  hk_lua_push_structural(L, &h);
  hk_lua_add_edges(L, scene);
  if (h.nx > 1 && h.ny > 1) add_surface(L, scene, &h);
  lua_settop(L, 2);
  hk_lua_push_handle(L, h);
  return 1;
}
