/* scene:strand{ n, from, to }: a straight chain of particles. */
#include "core/builders/builders.h"

int hk_build_strand(lua_State *L) {
  static const char *const keys[] = {"n", "from", "to", "length", "direction", "mass", "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "strand", keys);
  uint32_t n = hk_lua_count(L, 2, "strand", "n", 2);
  double from[3] = {0, 0, 0}, to[3], direction[3] = {0, 0, -1};
  hk_lua_field_vector(L, 2, "strand", "from", from);
  if (!hk_lua_field_vector(L, 2, "strand", "to", to)) {
    hk_lua_field_vector(L, 2, "strand", "direction", direction);
    double size = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    double length = hk_lua_field_number(L, 2, "strand", "length", 1);
    if (size == 0) return hk_lua_fail(L, HK_BAD_PARAM, "strand: direction: must not be zero");
    for (int c = 0; c < 3; c++) to[c] = from[c] + length * direction[c] / size;
  }
  double mass = hk_lua_field_number(L, 2, "strand", "mass", 1), *x = lua_newuserdatauv(L, 3 * n * sizeof *x, 0);
  for (uint32_t k = 0; k < n; k++)
    for (int c = 0; c < 3; c++) x[3 * k + c] = from[c] + (to[c] - from[c]) * k / (n - 1);
  hk_lua_handle h = {.count = n, .nx = n, .ny = 1, .chain = true};
  h.first = hk_lua_add(L, scene, "strand", n, x, NULL, NULL, mass / n, hk_lua_group(L, scene, 2, "strand"));
  hk_lua_push_structural(L, &h);
  hk_lua_add_edges(L, scene);
  hk_lua_push_handle(L, h);
  return 1;
}
