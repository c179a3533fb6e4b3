/* scene:within(low, high): the particles in a box, for scripts that pin or choose a part of what a builder made. */
#include "core/app/lua/internal.h"

int hk_lua_scene_within(lua_State *L) {
  const hk_scene *scene = hk_lua_editable(L);
  double low[3], high[3];
  lua_settop(L, 3);
  hk_lua_vector(L, 2, "within: the lower corner", low);
  hk_lua_vector(L, 3, "within: the upper corner", high);
  for (int c = 0; c < 3; c++)
    if (!(low[c] <= high[c]))
      return hk_lua_fail(L, HK_BAD_PARAM,
                         "within: from %g m to %g m along %c: the first corner has to be the lower one", low[c],
                         high[c], 'x' + c);
  hk_limits_count(L, scene->particles.n);
  lua_newtable(L);
  lua_Integer found = 0;
  for (size_t i = 0; i < scene->particles.n; i++) {
    const double *x = scene->particles.position + 3 * i;
    bool inside = true;
    for (int c = 0; c < 3; c++) inside = inside && x[c] >= low[c] && x[c] <= high[c];
    if (!inside) continue;
    lua_pushinteger(L, (lua_Integer)i + 1);
    lua_rawseti(L, -2, ++found);
  }
  return 1;
}
