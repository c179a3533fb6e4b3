/* scene:goal{} and scene:cost(): what `hooke optimise` looks for. A goal of a particle makes measures of its place and
 * velocity, so that every run shows how far it is from it. */
#include "core/app/lua/internal.h"

#include <stdio.h>
#include <string.h>

/* state -> one number: upvalues are the function of the state, the id, the component */
static int component(lua_State *L) {
  lua_getfield(L, 1, lua_tostring(L, lua_upvalueindex(1)));
  lua_pushvalue(L, 1);
  lua_pushvalue(L, lua_upvalueindex(2));
  lua_call(L, 2, 1);
  lua_rawgeti(L, -1, lua_tointeger(L, lua_upvalueindex(3)));
  return 1;
}

static bool is_measured(const hk_scene *scene, const char *name) {
  for (size_t k = 0; k < scene->measures; k++)
    if (strcmp(scene->measure[k].name, name) == 0) return true;
  return false;
}

static void add_measure(lua_State *L, hk_scene *target, const char *name, const char *unit, int function) {
  hk_error error = {0};
  hk_limits_take(L, sizeof(hk_measure) + strlen(name) + 64);
  hk_function value = hk_lua_frame_function(L, function);
  hk_lua_check(L, hk_scene_add_measure(target, name, unit, hk_lua_where(L), &value, &error), &error);
}

static void add_goal(lua_State *L, hk_scene *target, const char *measure, double low, double high) {
  hk_error error = {0};
  const hk_goal goal = {.low = low, .high = high, .at = hk_lua_field_number(L, 2, "goal", "at", target->duration)};
  hk_limits_take(L, sizeof(hk_goal) + 64);
  hk_lua_check(L, hk_scene_add_goal(target, measure, &goal, hk_lua_where(L), &error), &error);
}

/* Three goals where the table has this vector: "position", or "velocity". */
static bool add_vector(lua_State *L, hk_scene *target, uint32_t id, const char *key) {
  double wanted[3];
  if (!hk_lua_field_vector(L, 2, "goal", key, wanted)) return false;
  for (int c = 0; c < 3; c++) {
    char name[32];
    snprintf(name, sizeof name, "%s%c[%u]", *key == 'v' ? "v" : "", "xyz"[c], (unsigned)id);
    if (!is_measured(target, name)) {
      lua_pushstring(L, key);
      lua_pushinteger(L, id);
      lua_pushinteger(L, c + 1);
      lua_pushcclosure(L, component, 3);
      add_measure(L, target, name, *key == 'v' ? "m/s" : "m", lua_gettop(L));
    }
    add_goal(L, target, name, wanted[c], wanted[c]);
  }
  return true;
}

static void of_particle(lua_State *L, hk_scene *target) {
  size_t count = 0;
  const double *id = hk_lua_to_ids(L, lua_gettop(L), &count);
  if (!id || count != 1 || !(id[0] >= 1 && id[0] <= (double)target->particles.n))
    hk_lua_fail(L, HK_BAD_PARAM, "goal: particle: expected one particle of the scene");
  bool place = add_vector(L, target, (uint32_t)id[0], "position");
  if (!add_vector(L, target, (uint32_t)id[0], "velocity") && !place)
    hk_lua_fail(L, HK_BAD_PARAM, "goal: a particle needs position = { x, y, z } or velocity, or both");
}

int hk_lua_scene_goal(lua_State *L) {
  static const char *const keys[] = {"measure", "value", "min", "max", "particle", "position", "velocity", "at", NULL};
  static const char form[] = "scene:goal { measure = \"x\", value = 1 }";
  hk_scene *target = hk_lua_editable(L);
  hk_lua_check_table(L, 2, "goal", form);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "goal", keys);
  bool measured = hk_lua_field(L, 2, "measure") == LUA_TSTRING;
  bool particle = hk_lua_field(L, 2, "particle") != LUA_TNIL;
  double value = hk_lua_field_number(L, 2, "goal", "value", NAN);
  double low = hk_lua_field_number(L, 2, "goal", "min", -INFINITY);
  double high = hk_lua_field_number(L, 2, "goal", "max", INFINITY);
  bool ranged = low > -INFINITY || high < INFINITY;
  if (ranged && (particle || !isnan(value)))
    hk_lua_fail(L, HK_BAD_PARAM,
                "goal: min and max are of a measure without a value, scene:goal { measure = \"height\", min = 0.2 }");
  if (measured == particle || measured == (isnan(value) && !ranged))
    hk_lua_fail(L, HK_BAD_PARAM,
                "goal: of a measure, %s, or of a particle, scene:goal { particle = p, position = { 1, 0, 0 } }", form);
  if (particle) of_particle(L, target);
  if (measured) add_goal(L, target, lua_tostring(L, 3), ranged ? low : value, ranged ? high : value);
  return 0;
}

int hk_lua_scene_cost(lua_State *L) {
  hk_scene *target = hk_lua_editable(L);
  if (lua_type(L, 2) != LUA_TFUNCTION)
    hk_lua_fail(L, HK_BAD_PARAM, "cost: expected a function, scene:cost(function(state) return ... end)");
  add_measure(L, target, "cost", NULL, 2);
  target->cost = target->measure[target->measures - 1].name;
  return 0;
}
