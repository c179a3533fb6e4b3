/* scene:channel(): numbers of every particle, which a rate, a function of the script or a plugin changes. */
#include "core/app/lua/internal.h"
#include "core/engine/base/base.h"

#include <string.h>

static size_t initial_values(lua_State *L, double *into, size_t room) {
  if (lua_isnumber(L, -1)) {
    into[0] = lua_tonumber(L, -1);
    return 1;
  }
  size_t count = lua_istable(L, -1) ? lua_rawlen(L, -1) : 0;
  if (count < 1 || count > room)
    hk_lua_fail(L, HK_BAD_PARAM, "channel: initial: expected a number or up to %d numbers", (int)room);
  for (size_t k = 0; k < count; k++) {
    lua_rawgeti(L, -1, (lua_Integer)k + 1);
    into[k] = hk_lua_number(L, -1, "channel: initial");
    lua_pop(L, 1);
  }
  return count;
}

/* Keys of scene:particle{} cannot be told from those of particles; columns of tables can, by their order alone. */
static void check_channel_name(lua_State *L, hk_scene *scene, const char *name) {
  static const char *const keys[] = {"mass", "position", "velocity", "group", "id"};
  static const char *const columns[] = {"x", "y", "z", "vx", "vy", "vz"};
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
    if (strcmp(name, keys[k]) == 0)
      hk_lua_fail(L, HK_BAD_PARAM, "channel '%s': a particle's %s is its own already: choose another name", name, name);
  for (size_t k = 0; k < sizeof columns / sizeof *columns; k++)
    if (strcmp(name, columns[k]) == 0)
      hk_lua_warn(L, scene,
                  "channel '%s': tables of states have a column of this name already, and two then: choose another "
                  "name",
                  name);
}

int hk_lua_scene_channel(lua_State *L) {
  static const char *const keys[] = {"size", "initial", "rate", "accuracy", NULL};
  hk_scene *target = hk_lua_editable(L);
  hk_error error = {0};
  const char *name = hk_lua_text(L, 2, "scene:channel(\"heat\", { initial = 0 })");
  double initial[16] = {0}, decay = NAN;
  hk_function rate = {0};
  check_channel_name(L, target, name);
  lua_settop(L, 3);
  if (lua_isnil(L, 3)) {
    lua_newtable(L);
    lua_replace(L, 3);
  }
  hk_lua_check_table(L, 3, "channel", "scene:channel(name, { initial = 0 })");
  hk_lua_check_keys(L, 3, "channel", keys);
  size_t given = hk_lua_field(L, 3, "initial") != LUA_TNIL ? initial_values(L, initial, 16) : 0;
  double size = hk_lua_field_number(L, 3, "channel", "size", given ? (double)given : 1);
  if (size < 1 || size > 16 || floor(size) != size)
    return hk_lua_fail(L, HK_BAD_PARAM, "channel: size: %g is not 1 to 16", size);
  if (given && given != (size_t)size)
    return hk_lua_fail(L, HK_BAD_PARAM, "channel: initial has %d numbers for size %d", (int)given, (int)size);
  int type = hk_lua_field(L, 3, "rate");
  if (type == LUA_TNUMBER)
    decay = hk_lua_number(L, -1, "channel: rate");
  else if (type == LUA_TFUNCTION)
    rate = hk_lua_rate_function(L, lua_gettop(L));
  else if (type != LUA_TNIL && type != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "channel: rate: expected a number, a function or the name of a plugin");
  hk_limits_take(L, 1024 + strlen(name) + (size_t)size * (target->capacity + 1) * sizeof(double));
  hk_lua_check(L, hk_scene_add_channel(target, name, (size_t)size, initial, decay, rate.call ? &rate : NULL, &error),
               &error);
  target->particles.channel[target->particles.channels - 1].accuracy =
      hk_lua_positive(L, 3, "channel", "accuracy", NAN);
  if (type == LUA_TSTRING) {
    const hk_plugin_spec *force = hk_lua_add_plugin(L, target, HK_FORCE, lua_tostring(L, -1), 0);
    if (!force->plugin->force->rates)
      return hk_lua_fail(L, HK_BAD_PARAM, "channel: rate: the plugin '%s' gives no rates", force->plugin->name);
  }
  return 0;
}
