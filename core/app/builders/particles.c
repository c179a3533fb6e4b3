/* scene:particle{ position = } and scene:particles{ positions = }: particles one by one. */
#include "core/app/builders/builders.h"

#include <stdio.h>

static void set_channels(lua_State *L, hk_scene *scene, int table, uint32_t id) {
  for (size_t k = 0; k < scene->particles.channels; k++) {
    const hk_channel_spec *channel = &scene->particles.channel[k];
    hk_error error = {0};
    if (hk_lua_field(L, table, channel->name) != LUA_TNIL) {
      size_t count = 1;
      double number, *list = &number;
      if (lua_isnumber(L, -1))
        number = lua_tonumber(L, -1);
      else
        list = hk_lua_to_ids(L, -1, &count); /* a list of numbers in any accepted form */
      if (!list) hk_lua_fail(L, HK_BAD_PARAM, "particle: %s: expected numbers", channel->name);
      if (hk_scene_set_channel(scene, channel->name, id, list, count, &error) != HK_OK)
        hk_lua_raise_for(L, "particle", &error);
    }
    lua_settop(L, table);
  }
}

int hk_build_particle(lua_State *L) {
  const char *keys[64] = {"position", "velocity", "mass", "group"};
  hk_scene *scene = hk_lua_scene(L, 1);
  double x[3] = {0}, v[3] = {0};
  hk_lua_check_table(L, 2, "particle", "scene:particle { ... }");
  lua_settop(L, 2);
  for (size_t k = 0; k < scene->particles.channels && k < 58; k++) keys[4 + k] = scene->particles.channel[k].name;
  hk_lua_check_keys(L, 2, "particle", keys);
  hk_lua_field_vector(L, 2, "particle", "position", x);
  hk_lua_field_vector(L, 2, "particle", "velocity", v);
  double mass = hk_lua_field_number(L, 2, "particle", "mass", 1);
  uint32_t id = hk_lua_add(L, scene, "particle", 1, x, v, NULL, mass, hk_lua_group(L, scene, 2, "particle"));
  set_channels(L, scene, 2, id);
  lua_pushinteger(L, id);
  return 1;
}

/* Converts a list of triples to a block on the Lua stack; NULL: the key is absent. */
static double *triples(lua_State *L, int table, const char *key, size_t *count) {
  char what[64];
  if (hk_lua_field(L, table, key) == LUA_TNIL) return NULL;
  int list = lua_gettop(L);
  if (!lua_istable(L, list)) hk_lua_fail(L, HK_BAD_PARAM, "particles: %s: expected a list of {x, y, z}", key);
  *count = lua_rawlen(L, list);
  double *block = lua_newuserdatauv(L, (3 * *count + 1) * sizeof *block, 0);
  for (size_t k = 0; k < *count; k++) {
    snprintf(what, sizeof what, "particles: %s[%zu]", key, k + 1);
    lua_rawgeti(L, list, (lua_Integer)k + 1);
    hk_lua_vector(L, -1, what, block + 3 * k);
    lua_pop(L, 1);
  }
  return block;
}

int hk_build_particles(lua_State *L) {
  static const char *const keys[] = {"positions", "velocities", "masses", "mass", "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "particles", "scene:particles { ... }");
  hk_lua_check_keys(L, 2, "particles", keys);
  size_t count = 0, velocities = 0, masses = 0;
  const double *x = triples(L, 2, "positions", &count), *v = triples(L, 2, "velocities", &velocities), *m = NULL;
  if (!x) return hk_lua_fail(L, HK_BAD_PARAM, "particles: positions is required");
  if (v && velocities != count)
    return hk_lua_fail(L, HK_BAD_PARAM, "particles: %d velocities for %d positions", (int)velocities, (int)count);
  if (hk_lua_field(L, 2, "masses") != LUA_TNIL) {
    m = hk_lua_to_ids(L, -1, &masses);
    if (!m || masses != count)
      return hk_lua_fail(L, HK_BAD_PARAM, "particles: masses: expected %d numbers", (int)count);
  }
  double mass = hk_lua_field_number(L, 2, "particles", "mass", 1);
  uint32_t first = hk_lua_add(L, scene, "particles", count, x, v, m, mass, hk_lua_group(L, scene, 2, "particles"));
  hk_lua_push_handle(L, (hk_lua_handle){.first = first, .count = (uint32_t)count, .nx = (uint32_t)count, .ny = 1});
  return 1;
}
