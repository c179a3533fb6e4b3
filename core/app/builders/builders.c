/* What several builders do: adding particles and edges to a scene, and reading a group's name, a mass or a number of
 * particles.
 */
#include "core/app/builders/builders.h"

#include <string.h>

uint32_t hk_lua_group(lua_State *L, hk_scene *scene, int table, const char *what) {
  hk_error error = {0};
  uint32_t group = 0;
  if (hk_lua_field(L, table, "group") != LUA_TNIL) {
    if (lua_type(L, -1) != LUA_TSTRING) hk_lua_fail(L, HK_BAD_PARAM, "%s: group: expected a name", what);
    hk_limits_take(L, lua_rawlen(L, -1) + 64);
    if (hk_scene_add_group(scene, lua_tostring(L, -1), &group, &error) != HK_OK) hk_lua_raise(L, &error);
  }
  lua_pop(L, 1);
  return group;
}

void hk_lua_raise_for(lua_State *L, const char *what, const hk_error *error) {
  hk_lua_fail(L, error->status, "%s: %s", what, error->text);
}

uint32_t hk_lua_add(lua_State *L, hk_scene *scene, const char *what, size_t count, const double *x, const double *v,
                    const double *mass, double common, uint32_t group) {
  hk_error error = {0};
  uint32_t first = 0;
  if (scene->frozen) hk_lua_fail(L, HK_BAD_PARAM, "%s: the scene runs and can no longer be edited", what);
  hk_limits_take(L, count * (7 * sizeof(double) + sizeof(uint32_t)));
  for (size_t k = 0; k < scene->particles.channels; k++)
    hk_limits_take(L, count * scene->particles.channel[k].size * sizeof(double));
  if (hk_scene_add_particles(scene, count, x, v, mass, common, group, &first, &error) != HK_OK)
    hk_lua_raise_for(L, what, &error);
  const char *where = hk_lua_where(L);
  hk_limits_take(L, strlen(where));
  if (hk_scene_note_place(scene, first, where, &error) != HK_OK) hk_lua_raise_for(L, what, &error);
  lua_pop(L, 1);
  return first;
}

uint32_t hk_lua_count(lua_State *L, int table, const char *what, const char *key, double least) {
  double value = hk_lua_field_number(L, table, what, key, NAN);
  if (isnan(value)) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s is required", what, key);
  if (value < least || value > 1e6 || floor(value) != value)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: %.7g is not a whole number from %g to a million", what, key, value, least);
  return (uint32_t)value;
}

double hk_lua_mass(lua_State *L, int table, const char *what, double *density) {
  double mass = hk_lua_field_number(L, table, what, "mass", NAN);
  *density = hk_lua_field_number(L, table, what, "density", NAN);
  if (!isnan(mass) && !isnan(*density)) hk_lua_fail(L, HK_BAD_PARAM, "%s: give mass or density, not both", what);
  if (*density <= 0) hk_lua_fail(L, HK_BAD_PARAM, "%s: density: %g kg/m^2 has to be above 0", what, *density);
  return isnan(mass) ? 1 : mass;
}

bool hk_lua_field_flag(lua_State *L, int table, const char *what, const char *key) {
  int type = hk_lua_field(L, table, key);
  bool value = lua_toboolean(L, -1);
  if (type != LUA_TNIL && type != LUA_TBOOLEAN)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: expected true or false", what, key);
  lua_pop(L, 1);
  return value;
}

void hk_lua_add_edges(lua_State *L, hk_scene *scene) {
  hk_error error = {0};
  const hk_lua_edges *edges = hk_lua_to_edges(L, -1);
  hk_limits_take(L, edges->count * sizeof *edges->pair);
  if (hk_scene_add_edges(scene, edges->count, (const uint32_t(*)[2])edges->pair, &error) != HK_OK)
    hk_lua_raise(L, &error);
}
