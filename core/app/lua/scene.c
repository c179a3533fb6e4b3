/* hooke.scene{} and its methods. A method checks its arguments, calls hk_scene_*, and raises an error of that function
 * prefixed by the script's line. */
#include "core/app/lua/internal.h"
#include "core/engine/base/base.h"
#include "core/app/builders/builders.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static hk_scene *editable(lua_State *L) {
  hk_scene *scene = hk_lua_scene(L, 1);
  if (scene->frozen) hk_lua_fail(L, HK_BAD_PARAM, "the scene runs and can no longer be edited");
  return scene;
}

static void check(lua_State *L, hk_status status, const hk_error *error) {
  if (status != HK_OK) hk_lua_raise(L, error);
}

/* *line: the script's line of the call, for messages of the run. */
static void note_line(lua_State *L, char **line) {
  hk_error error = {0};
  const char *where = hk_lua_where(L);
  hk_limits_take(L, strlen(where));
  check(L, hk_scene_set_where(line, where, &error), &error);
  lua_pop(L, 1);
}

/* ---- plugins ---- */

/* "auto": the scene names no plugin of the kind. The run chooses the solver by its forces and its size; the integrator
 * is chosen by a benchmark before the run. */
static void clear_choice(lua_State *L, hk_scene *scene, hk_kind kind, int params) {
  hk_specs *list = &scene->plugin[kind];
  lua_pushnil(L);
  if (params && lua_istable(L, params) && lua_next(L, params))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: auto has no parameters; name one to set its own", hk_kind_name(kind));
  if (list->count) hk_scene_drop(scene, list->item[0]);
  if (kind != HK_INTEGRATOR) return;
  scene->integrator_auto = true;
  note_line(L, &scene->auto_where);
}

static bool has_param(const hk_plugin *plugin, const char *name) {
  for (const hk_param *p = plugin->params; p && p->name; p++)
    if (strcmp(p->name, name) == 0) return true;
  return false;
}

/* hk_lua_set_params(scene, spec, parameters) as a function of Lua, with the numbers of a material in the place of its
 * name. */
static int set_params(lua_State *L) {
  hk_plugin_spec *spec = lua_touserdata(L, 2);
  if (lua_istable(L, 3) && !has_param(spec->plugin, "material"))
    hk_lua_take_material(L, lua_touserdata(L, 1), 3, spec->plugin->name);
  hk_lua_set_params(L, lua_touserdata(L, 1), spec, 3);
  return 0;
}

/* A plugin whose parameters are refused leaves the scene, also where the script catches the error. */
static void fill(lua_State *L, hk_scene *scene, hk_plugin_spec *spec, int params) {
  lua_pushcfunction(L, set_params);
  lua_pushlightuserdata(L, scene);
  lua_pushlightuserdata(L, spec);
  if (params)
    lua_pushvalue(L, params);
  else
    lua_pushnil(L);
  if (lua_pcall(L, 3, 0, 0) == LUA_OK) return;
  hk_scene_drop(scene, spec);
  lua_error(L);
}

static hk_plugin_spec *add(lua_State *L, hk_scene *scene, hk_kind kind, const char *name, int params) {
  if ((kind == HK_SOLVER || kind == HK_INTEGRATOR) && strcmp(name, "auto") == 0) {
    clear_choice(L, scene, kind, params);
    return NULL;
  }
  if (kind == HK_INTEGRATOR) scene->integrator_auto = false;
  hk_error error = {0};
  hk_plugin_spec *spec;
  const char *label = NULL;
  if (params && lua_istable(L, params) && hk_lua_field(L, params, "label") != LUA_TNIL) {
    label = lua_tostring(L, -1);
    if (!label || !*label) hk_lua_fail(L, HK_BAD_PARAM, "%s: label: expected a text that is not empty", name);
  }
  hk_limits_take(L, 1024 + (label ? strlen(label) : 0));
  check(L, hk_scene_add_plugin(scene, kind, name, label, hk_lua_where(L), &spec, &error), &error);
  fill(L, scene, spec, params);
  return spec;
}

static int add_kind(lua_State *L) {
  hk_kind kind = (hk_kind)lua_tointeger(L, lua_upvalueindex(1));
  hk_scene *scene = editable(L);
  if (lua_type(L, 2) != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "%s: expected a name and then parameters, scene:%s(\"name\", { ... })",
                       hk_kind_name(kind), hk_kind_name(kind));
  const char *name = lua_tostring(L, 2);
  if (kind == HK_OUTPUT && hk_lua_script(L)->run_options.no_output) return 0; /* the output is not even loaded */
  lua_settop(L, 3);
  add(L, scene, kind, name, 3);
  return 0;
}

/* ---- hooke.scene{} ---- */

/* integrator = "name" or {"name", param = value}. */
static void choose(lua_State *L, hk_scene *scene, hk_kind kind, const char *key) {
  if (hk_lua_field(L, 1, key) == LUA_TNIL) {
    lua_pop(L, 1);
    return;
  }
  int value = lua_gettop(L);
  if (lua_type(L, value) == LUA_TSTRING)
    add(L, scene, kind, lua_tostring(L, value), 0);
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
    add(L, scene, kind, name, lua_gettop(L));
  } else
    hk_lua_fail(L, HK_BAD_PARAM, "scene: %s: expected a name or { \"name\", parameter = value }", key);
  lua_settop(L, value - 1);
}

static double positive_of(lua_State *L, int table, const char *what, const char *key, double otherwise) {
  double value = hk_lua_field_number(L, table, what, key, otherwise);
  if (value <= 0) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: %g must be positive", what, key, value);
  return value;
}

static double positive(lua_State *L, const char *key, double otherwise) {
  return positive_of(L, 1, "scene", key, otherwise);
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
  hk_scene *target = editable(L);
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
  check(L, hk_scene_add_pin(target, &spec, &error), &error);
  return 0;
}

/* ---- channels ---- */

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

static int channel(lua_State *L) {
  static const char *const keys[] = {"size", "initial", "rate", "accuracy", NULL};
  hk_scene *target = editable(L);
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
  check(L, hk_scene_add_channel(target, name, (size_t)size, initial, decay, rate.call ? &rate : NULL, &error), &error);
  target->particles.channel[target->particles.channels - 1].accuracy = positive_of(L, 3, "channel", "accuracy", NAN);
  if (type == LUA_TSTRING) {
    const hk_plugin_spec *force = add(L, target, HK_FORCE, lua_tostring(L, -1), 0);
    if (!force->plugin->force->rates)
      return hk_lua_fail(L, HK_BAD_PARAM, "channel: rate: the plugin '%s' gives no rates", force->plugin->name);
  }
  return 0;
}

/* ---- functions of the script ---- */

static int measure(lua_State *L) {
  hk_scene *target = editable(L);
  hk_error error = {0};
  if (lua_type(L, 2) != LUA_TSTRING || lua_type(L, 3) != LUA_TFUNCTION)
    return hk_lua_fail(L, HK_BAD_PARAM,
                       "measure: expected a name and a function, scene:measure(\"height\", function(state) "
                       "return ... end)");
  const char *name = lua_tostring(L, 2);
  hk_limits_take(L, sizeof(hk_measure) + strlen(name) + 64);
  hk_function function = hk_lua_frame_function(L, 3);
  check(L, hk_scene_add_measure(target, name, hk_lua_where(L), &function, &error), &error);
  return 0;
}

static int on_frame(lua_State *L) {
  hk_scene *target = editable(L);
  if (lua_type(L, 2) != LUA_TFUNCTION)
    return hk_lua_fail(L, HK_BAD_PARAM, "on_frame: expected a function, scene:on_frame(function(state) ... end)");
  target->on_frame = hk_lua_frame_function(L, 2);
  return 0;
}

static int exact(lua_State *L) {
  hk_scene *target = editable(L);
  if (lua_type(L, 2) != LUA_TFUNCTION)
    return hk_lua_fail(L, HK_BAD_PARAM,
                       "exact: expected a function, scene:exact(function(t) return x, y, z end), got %s",
                       hk_lua_kind(L, 2));
  target->exact = hk_lua_function(L, 2);
  note_line(L, &target->exact_where);
  return 0;
}

static int start(lua_State *L) {
  static const char *const keys[] = {"file", NULL};
  hk_scene *target = editable(L);
  hk_lua_check_table(L, 2, "start", "scene:start { file = ... }");
  hk_lua_check_keys(L, 2, "start", keys);
  if (hk_lua_field(L, 2, "file") != LUA_TSTRING) return hk_lua_fail(L, HK_BAD_PARAM, "start: file is required");
  free(target->start_file);
  target->start_file = hk_string_copy(lua_tostring(L, -1));
  note_line(L, &target->start_where);
  hk_lua_note_file(L, "the start file", lua_tostring(L, -1), lua_tostring(L, -1));
  return 0;
}

static const luaL_Reg methods[] = {
    {"pin", pin},     {"channel", channel}, {"measure", measure},      {"on_frame", on_frame},
    {"exact", exact}, {"start", start},     {"run", hk_lua_scene_run}, {"periodic", hk_lua_scene_periodic},
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
    lua_pushcclosure(L, add_kind, 1);
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
