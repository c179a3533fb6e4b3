/* hooke.scene{} and its methods. A method checks its arguments, calls hk_scene_*, and raises an error of that function
 * prefixed by the script's line. */
#include "core/app/lua/internal.h"
#include "core/engine/base/base.h"
#include "core/app/builders/builders.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* ---- hooke.scene{} ---- */

/* integrator = "name" or {"name", param = value}. */
static void choose(lua_State *L, hk_scene *scene, hk_kind kind, const char *key) {
  if (hk_lua_field(L, 1, key) == LUA_TNIL) {
    lua_pop(L, 1);
    return;
  }
  int value = lua_gettop(L);
  if (lua_type(L, value) == LUA_TSTRING)
    hk_lua_add_plugin(L, scene, kind, lua_tostring(L, value), 0);
  else if (lua_istable(L, value) && lua_rawgeti(L, value, 1) == LUA_TSTRING) {
    hk_lua_check_plain(L, value, key);
    const char *name = lua_tostring(L, -1);
    lua_newtable(L); /* the entries with string keys are the parameters */
    for (lua_pushnil(L); lua_next(L, value); lua_pop(L, 1)) {
      if (lua_type(L, -2) != LUA_TSTRING) continue;
      lua_pushvalue(L, -2);
      lua_pushvalue(L, -2);
      lua_settable(L, -5);
    }
    hk_lua_add_plugin(L, scene, kind, name, lua_gettop(L));
  } else
    hk_lua_fail(L, HK_BAD_PARAM, "scene: %s: expected a name or { \"name\", parameter = value }", key);
  lua_settop(L, value - 1);
}

static double positive(lua_State *L, const char *key, double otherwise) {
  return hk_lua_positive(L, 1, "scene", key, otherwise);
}

/* Frame k is at k/fps: numbers of frames are whole, and the parts of a frame have digits of their own. */
static void check_frames(lua_State *L, const hk_scene *scene) {
  const double most = 1 / DBL_EPSILON, shortest = DBL_MIN / DBL_EPSILON;
  if (scene->fps * scene->duration > most || 1 / scene->fps < shortest)
    hk_lua_fail(L, HK_BAD_PARAM, "scene: fps: %g frames a second are too many to be told apart in %g s", scene->fps,
                scene->duration);
}

static bool accuracy_at_end(lua_State *L) {
  hk_lua_field(L, 1, "accuracy_at");
  const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
  bool given = !lua_isnil(L, -1), end = strcmp(text, "end") == 0;
  if (given && !end && strcmp(text, "frames") != 0)
    hk_lua_fail(L, HK_BAD_PARAM, "scene: accuracy_at: expected \"frames\" (all of them, the default) or \"end\"");
  lua_pop(L, 1);
  return end;
}

static hk_scene *new_scene(lua_State *L) {
  hk_script *s = hk_lua_script(L);
  if (s->finished || s->calling)
    hk_lua_fail(L, HK_SCRIPT, "a scene is made by the script itself, not by a function that the run calls");
  hk_limits_take(L, sizeof(hk_scene) + strlen(s->path) + 1024);
  hk_lua_scene_handle *holder = hk_lua_push_scene(L);
  hk_lua_slot **grown = realloc(s->slot, (s->slots + 1) * sizeof *grown), *slot = calloc(1, sizeof *slot);
  if (grown) s->slot = grown;
  if (slot) slot->scene = grown ? hk_scene_create(s->path, s->options.registry) : NULL;
  if (!slot || !slot->scene) {
    free(slot);
    hk_lua_fail(L, HK_NO_MEMORY, "no memory for a scene");
  }
  slot->scene->trusted = s->options.trust;
  slot->scene->stand_in = s->options.stand_in;
  holder->slot = s->slot[s->slots++] = slot; /* the script owns it */
  return slot->scene;
}

static int scene(lua_State *L) {
  static const char *const keys[] = {"duration",   "fps",    "dt",   "tol",     "accuracy", "accuracy_at",
                                     "integrator", "solver", "seed", "threads", NULL};
  const hk_script *s = hk_lua_script(L);
  if (lua_istable(L, 2)) return hk_lua_fail(L, HK_BAD_PARAM, "a scene is made with a dot: hooke.scene { ... }");
  if (lua_isnoneornil(L, 1)) lua_newtable(L);
  hk_lua_check_table(L, 1, "scene", "hooke.scene { ... }");
  lua_settop(L, 1);
  hk_lua_check_keys(L, 1, "scene", keys);
  hk_scene *made = new_scene(L);
  made->duration = hk_lua_field_number(L, 1, "scene", "duration", made->duration);
  if (made->duration < 0)
    return hk_lua_fail(L, HK_BAD_PARAM, "scene: duration: %g s is below the minimum 0", made->duration);
  made->fps = positive(L, "fps", made->fps);
  check_frames(L, made);
  made->dt = positive(L, "dt", NAN);
  made->tol = positive(L, "tol", made->tol);
  made->accuracy = positive(L, "accuracy", NAN);
  made->accuracy_at_end = accuracy_at_end(L);
  made->seed =
      s->options.seed ? s->options.seed : hk_lua_field_whole(L, 1, "scene", "seed", 0, 9007199254740992.0); /* 2^53 */
  made->threads = s->options.threads ? s->options.threads : (int)hk_lua_field_whole(L, 1, "scene", "threads", 0, 1024);
  choose(L, made, HK_INTEGRATOR, "integrator");
  choose(L, made, HK_SOLVER, "solver");
  lua_settop(L, 2);
  return 1;
}

/* ---- pins ---- */

static void pin_options(lua_State *L, hk_pin_spec *spec) {
  static const char *const keys[] = {"path", "rotation", "center", "fastest", "axes", "normal", "release", NULL};
  hk_lua_check_keys(L, 3, "pin", keys);
  bool line = hk_lua_field_vector(L, 3, "pin", "axes", spec->axis);
  bool plane = hk_lua_field_vector(L, 3, "pin", "normal", line ? (double[3]){0} : spec->axis);
  bool path = hk_lua_field_function(L, 3, "pin", "path", &spec->path);
  bool rotation = hk_lua_field_function(L, 3, "pin", "rotation", &spec->rotation);
  if (line + plane + (path || rotation) > 1)
    hk_lua_fail(L, HK_BAD_PARAM, "pin: give one of path (or rotation), axes and normal");
  if (hk_lua_field_vector(L, 3, "pin", "center", spec->center) && !rotation)
    hk_lua_fail(L, HK_BAD_PARAM, "pin: center: the pin has no rotation about it");
  spec->kind = line ? HK_PIN_LINE : plane ? HK_PIN_PLANE : path || rotation ? HK_PIN_PATH : HK_PIN_FIXED;
  spec->release = hk_lua_field_number(L, 3, "pin", "release", INFINITY);
  bool declared = hk_lua_field(L, 3, "fastest") != LUA_TNIL;
  if (declared && !path && !rotation)
    hk_lua_fail(L, HK_BAD_PARAM, "pin: fastest: the pin has no path that could change");
  if (declared) spec->fastest = hk_lua_fastest(L, "pin: fastest");
}

/* scene:pin { 1, path = f } would pin particle 1 for good. */
static void refuse_options_among_ids(lua_State *L) {
  if (!lua_isnoneornil(L, 3) && !lua_istable(L, 3))
    hk_lua_fail(L, HK_BAD_PARAM, "pin: options are a table, scene:pin(ids, { path = f }), got %s", luaL_typename(L, 3));
  if (!lua_istable(L, 2)) return;
  for (lua_pushnil(L); lua_next(L, 2); lua_pop(L, 1))
    if (lua_type(L, -2) == LUA_TSTRING)
      hk_lua_fail(L, HK_BAD_PARAM, "pin: '%s' is no particle; options are a second table, scene:pin(ids, { %s = ... })",
                  lua_tostring(L, -2), lua_tostring(L, -2));
}

static int pin(lua_State *L) {
  hk_scene *target = hk_lua_editable(L);
  hk_error error = {0};
  hk_pin_spec spec = {.kind = HK_PIN_FIXED, .center = {NAN}, .release = INFINITY};
  lua_settop(L, 3);
  refuse_options_among_ids(L);
  const double *ids = hk_lua_to_ids(L, 2, &spec.count);
  if (!ids) return hk_lua_fail(L, HK_BAD_PARAM, "pin: expected particle ids, scene:pin { 1, 2 }");
  spec.id = lua_newuserdatauv(L, (spec.count + 1) * sizeof *spec.id, 0);
  char known[64];
  for (size_t k = 0; k < spec.count; k++) {
    bool fine = ids[k] >= 1 && ids[k] <= (double)target->particles.n && floor(ids[k]) == ids[k];
    if (!fine)
      return hk_lua_fail(L, HK_BAD_PARAM, "pin: there is no particle %.15g (%s)", ids[k],
                         hk_known_ids(known, target->particles.n));
    spec.id[k] = (uint32_t)ids[k];
  }
  if (lua_istable(L, 3)) pin_options(L, &spec);
  hk_limits_take(L, sizeof spec + spec.count * sizeof *spec.id);
  spec.where = (char *)(uintptr_t)hk_lua_where(L); /* hk_scene_add_pin copies it */
  hk_lua_check(L, hk_scene_add_pin(target, &spec, &error), &error);
  return 0;
}

/* ---- functions of the script ---- */

/* What { unit = "m" } behind the function says; NULL: nothing. */
static const char *unit_of(lua_State *L, const char *name) {
  static const char *const keys[] = {"unit", NULL};
  if (lua_isnoneornil(L, 4)) return NULL;
  if (!lua_istable(L, 4))
    hk_lua_fail(L, HK_BAD_PARAM, "measure: options are a table, scene:measure(\"%s\", f, { unit = \"m\" }), got %s",
                name, hk_lua_kind(L, 4));
  hk_lua_check_keys(L, 4, "measure", keys);
  if (hk_lua_field(L, 4, "unit") == LUA_TNIL) return NULL;
  if (lua_type(L, -1) != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "measure: unit of '%s': expected a text, as \"m\" or \"kg m/s\", got %s", name,
                hk_lua_kind(L, -1));
  return lua_tostring(L, -1);
}

static int measure(lua_State *L) {
  hk_scene *target = hk_lua_editable(L);
  hk_error error = {0};
  if (lua_type(L, 2) != LUA_TSTRING || lua_type(L, 3) != LUA_TFUNCTION)
    return hk_lua_fail(L, HK_BAD_PARAM,
                       "measure: expected a name and a function, scene:measure(\"height\", function(state) "
                       "return ... end)");
  const char *name = lua_tostring(L, 2), *unit = unit_of(L, name);
  hk_limits_take(L, sizeof(hk_measure) + strlen(name) + 96);
  hk_function function = hk_lua_frame_function(L, 3);
  hk_lua_check(L, hk_scene_add_measure(target, name, unit, hk_lua_where(L), &function, &error), &error);
  return 0;
}

static int on_frame(lua_State *L) {
  hk_scene *target = hk_lua_editable(L);
  if (lua_type(L, 2) != LUA_TFUNCTION)
    return hk_lua_fail(L, HK_BAD_PARAM, "on_frame: expected a function, scene:on_frame(function(state) ... end)");
  target->on_frame = hk_lua_frame_function(L, 2);
  return 0;
}

static int exact(lua_State *L) {
  hk_scene *target = hk_lua_editable(L);
  if (lua_type(L, 2) != LUA_TFUNCTION)
    return hk_lua_fail(L, HK_BAD_PARAM,
                       "exact: expected a function, scene:exact(function(t) return x, y, z end), got %s",
                       hk_lua_kind(L, 2));
  target->exact = hk_lua_function(L, 2);
  hk_lua_note_line(L, &target->exact_where);
  return 0;
}

static int start(lua_State *L) {
  static const char *const keys[] = {"file", NULL};
  hk_scene *target = hk_lua_editable(L);
  hk_lua_check_table(L, 2, "start", "scene:start { file = ... }");
  hk_lua_check_keys(L, 2, "start", keys);
  if (hk_lua_field(L, 2, "file") != LUA_TSTRING) return hk_lua_fail(L, HK_BAD_PARAM, "start: file is required");
  free(target->start_file);
  target->start_file = hk_string_copy(lua_tostring(L, -1));
  hk_lua_note_line(L, &target->start_where);
  hk_lua_note_file(L, "the start file", lua_tostring(L, -1), lua_tostring(L, -1));
  return 0;
}

static const luaL_Reg methods[] = {{"pin", pin},
                                   {"channel", hk_lua_scene_channel},
                                   {"measure", measure},
                                   {"control", hk_lua_scene_control},
                                   {"goal", hk_lua_scene_goal},
                                   {"cost", hk_lua_scene_cost},
                                   {"on_frame", on_frame},
                                   {"exact", exact},
                                   {"start", start},
                                   {"run", hk_lua_scene_run},
                                   {"periodic", hk_lua_scene_periodic},
                                   {"within", hk_lua_scene_within},
                                   {NULL, NULL}};

static int no_assignment(lua_State *L) {
  return hk_lua_fail(L, HK_BAD_PARAM, "a scene is changed by its functions only; more is given in hooke.scene { ... }");
}

void hk_lua_open_scene(lua_State *L) {
  luaL_newmetatable(L, hk_lua_scene_type);
  lua_newtable(L);
  luaL_setfuncs(L, methods, 0);
  for (int kind = 0; kind < HK_KINDS; kind++) {
    lua_pushinteger(L, kind);
    lua_pushcclosure(L, hk_lua_scene_add_kind, 1);
    lua_setfield(L, -2, hk_kind_name((hk_kind)kind));
  }
  luaL_setfuncs(L, hk_builders, 0);
  hk_lua_name_scene_methods(L);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, no_assignment);
  lua_setfield(L, -2, "__newindex");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
  lua_createtable(L, 0, 3);
  lua_pushcfunction(L, scene);
  lua_setfield(L, -2, "scene");
  lua_pushcfunction(L, hk_lua_gust);
  lua_setfield(L, -2, "gust");
  lua_pushfstring(L, "%d.%d", HK_ABI_MAJOR, HK_ABI_MINOR);
  lua_setfield(L, -2, "version");
  lua_setglobal(L, "hooke");
}
