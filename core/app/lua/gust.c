/* hooke.gust{}: a random function of time whose fastest change is known. */
#include "core/app/lua/internal.h"
#include "core/app/script/script.h"

/* A number or a vector at `key`; a number stands for `all` three, or for the first. Returns whether it is a vector. */
static bool gust_numbers(lua_State *L, const char *key, bool all, double out[HK_COLUMNS]) {
  bool vector = hk_lua_field(L, 1, key) == LUA_TTABLE;
  lua_pop(L, 1);
  if (vector) return hk_lua_field_vector(L, 1, "gust", key, out);
  out[0] = hk_lua_field_number(L, 1, "gust", key, 0);
  for (int c = 1; c < HK_COLUMNS; c++) out[c] = all ? out[0] : 0;
  return false;
}

int hk_lua_gust(lua_State *L) {
  static const char *const keys[] = {"mean", "amplitude", "shortest", "longest", "seed", NULL};
  double mean[HK_COLUMNS], amplitude[HK_COLUMNS];
  hk_lua_check_table(L, 1, "gust", "hooke.gust { ... }");
  lua_settop(L, 1);
  hk_lua_check_keys(L, 1, "gust", keys);
  bool vector = gust_numbers(L, "mean", false, mean), turns = gust_numbers(L, "amplitude", true, amplitude);
  double shortest = hk_lua_field_number(L, 1, "gust", "shortest", NAN);
  double longest = hk_lua_field_number(L, 1, "gust", "longest", 20 * shortest);
  if (turns && !vector && mean[0] != 0)
    return hk_lua_fail(L, HK_BAD_PARAM, "gust: mean: a number, where the amplitude is a vector: mean = { x, y, z }");
  if (!(shortest > 0))
    return hk_lua_fail(L, HK_BAD_PARAM, "gust: shortest: the shortest period, in s, has to be given, and above 0");
  if (!(longest >= shortest))
    return hk_lua_fail(L, HK_BAD_PARAM, "gust: longest: %g s is below the shortest period, %g s", longest, shortest);
  for (int c = 0; c < HK_COLUMNS; c++)
    if (amplitude[c] < 0)
      return hk_lua_fail(L, HK_BAD_PARAM, "gust: amplitude: %g is below the minimum 0", amplitude[c]);
  uint64_t seed = hk_lua_field_whole(L, 1, "gust", "seed", 1, 9007199254740992.0); /* 2^53 */
  hk_gust_make(hk_lua_push_gust(L), vector || turns ? HK_COLUMNS : 1, mean, amplitude, shortest, longest, seed);
  return 1;
}
