/* hooke.load() of tools: a scene script, run in a Lua state and sandbox of its own, whose scene the tool then drives.
 * The script lives as long as the scene's userdata. */
#include "core/app/tools/tools.h"

#include <lauxlib.h>
#include <math.h>
#include <stdio.h>

static const char loaded_type[] = "hooke.loaded";

static int close_loaded(lua_State *L) {
  hk_script **loaded = lua_touserdata(L, 1);
  hk_script_close(*loaded);
  *loaded = NULL;
  return 0;
}

/* Pushes the userdata that owns the script. Its first user value keeps the options' texts alive, its second the
 * parameters. */
static hk_script **push_owner(lua_State *L) {
  hk_script **loaded = lua_newuserdatauv(L, sizeof *loaded, 2);
  *loaded = NULL;
  if (luaL_newmetatable(L, loaded_type)) {
    lua_pushcfunction(L, close_loaded);
    lua_setfield(L, -2, "__gc");
  }
  lua_setmetatable(L, -2);
  return loaded;
}

static const char *push_text(lua_State *L, int index) {
  char digits[40];
  if (lua_type(L, index) != LUA_TNUMBER || lua_isinteger(L, index)) return luaL_tolstring(L, index, NULL);
  snprintf(digits, sizeof digits, "%.17g", lua_tonumber(L, index)); /* Lua's conversion has 14 digits only */
  return lua_pushstring(L, digits);
}

hk_param_given *hk_tool_push_given(lua_State *L, int table, size_t *count) {
  size_t k = 0;
  *count = 0;
  if (!lua_isnoneornil(L, table)) luaL_checktype(L, table, LUA_TTABLE);
  for (lua_pushnil(L); lua_istable(L, table) && lua_next(L, table); lua_pop(L, 1)) ++*count;
  if (!lua_istable(L, table)) lua_pop(L, 1);
  hk_param_given *given = lua_newuserdatauv(L, (*count + 1) * sizeof *given, 1);
  lua_createtable(L, (int)*count, 0); /* keeps the texts alive */
  int texts = lua_gettop(L);
  for (lua_pushnil(L); *count && lua_next(L, table); lua_settop(L, texts + 1)) {
    if (lua_type(L, -2) != LUA_TSTRING) luaL_error(L, "parameters are named, { N = 32 }");
    given[k] = (hk_param_given){lua_tostring(L, -2), push_text(L, -1), false};
    lua_rawseti(L, texts, (lua_Integer)++k);
  }
  lua_settop(L, texts);
  lua_setiuservalue(L, texts - 1, 1);
  return given;
}

static const char *text_field(lua_State *L, int table, const char *key) {
  lua_getfield(L, table, key);
  const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : NULL; /* the table keeps the text alive */
  lua_pop(L, 1);
  return text;
}

static bool flag_field(lua_State *L, int table, const char *key) {
  lua_getfield(L, table, key);
  bool set = lua_toboolean(L, -1);
  lua_pop(L, 1);
  return set;
}

void hk_tool_read_without(lua_State *L, int table, const char *what, hk_run_options *run) {
  if (lua_getfield(L, table, "without") == LUA_TTABLE) {
    size_t count = lua_rawlen(L, -1);
    const char **label = lua_newuserdatauv(L, (count + 1) * sizeof *label, 0);
    for (size_t k = 0; k < count; k++, lua_pop(L, 1)) {
      if (lua_rawgeti(L, -2, (lua_Integer)k + 1) != LUA_TSTRING)
        hk_lua_fail(L, HK_BAD_PARAM, "%s: without: expected a list of labels", what);
      label[k] = lua_tostring(L, -1);
    }
    run->without = label;
    run->without_count = count;
    lua_setfield(L, table, "without labels"); /* keeps the labels alive as long as the table */
  }
  lua_pop(L, 1);
}

static void read_options(lua_State *L, int table, hk_script_options *options, hk_run_options *run) {
  static const char *const keys[] = {
      "integrator",   "solver",       "dt",          "tol",   "until",   "accuracy",   "out",
      "output",       "seed",         "threads",     "trust", "without", "step_limit", "perturb",
      "ignore_exact", "perturb_seed", "accuracy_at", "draft", "fps",     "duration",   NULL};
  static const char what[] = "load";
  static const double most = 9007199254740992.0; /* 2^53 */
  hk_lua_check_keys(L, table, what, keys);
  run->dt = hk_lua_field_number(L, table, what, "dt", NAN);
  run->tol = hk_lua_field_number(L, table, what, "tol", NAN);
  run->until = hk_lua_field_number(L, table, what, "until", NAN);
  run->accuracy = hk_lua_field_number(L, table, what, "accuracy", NAN);
  run->accuracy_at = text_field(L, table, "accuracy_at");
  run->step_limit = hk_lua_field_whole(L, table, what, "step_limit", 0, most);
  run->perturb = hk_lua_field_number(L, table, what, "perturb", 0);
  run->perturb_seed = hk_lua_field_whole(L, table, what, "perturb_seed", 1, most);
  run->integrator = text_field(L, table, "integrator");
  run->solver = text_field(L, table, "solver");
  run->out = text_field(L, table, "out");
  run->no_output = !flag_field(L, table, "output");
  run->draft = flag_field(L, table, "draft");
  run->ignore_exact = flag_field(L, table, "ignore_exact");
  options->seed = hk_lua_field_whole(L, table, what, "seed", 0, most);
  options->threads = (int)hk_lua_field_whole(L, table, what, "threads", 0, 1024);
  options->trust = flag_field(L, table, "trust");
  hk_tool_read_without(L, table, what, run);
}

int hk_tool_load(lua_State *L) {
  hk_script *tool = hk_lua_script(L);
  const char *path = luaL_checkstring(L, 1);
  hk_script_options options = *hk_script_asked(tool);
  hk_run_options run = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .no_output = true, .progress = -1};
  hk_error error = {0};
  lua_settop(L, 3);
  lua_newtable(L); /* a copy that keeps the memory of the options alive */
  for (lua_pushnil(L); lua_istable(L, 3) && lua_next(L, 3); lua_pop(L, 1)) {
    lua_pushvalue(L, -2);
    lua_pushvalue(L, -2);
    lua_settable(L, 4);
  }
  lua_settop(L, 4);
  lua_replace(L, 3);
  read_options(L, 3, &options, &run);
  run.interrupted = hk_script_run_options(tool)->interrupted;
  run.acting = hk_script_run_options(tool)->acting;
  options.run = &run;
  hk_script **loaded = push_owner(L);
  lua_pushvalue(L, 3);
  lua_setiuservalue(L, 4, 1);
  double fps = hk_lua_field_number(L, 3, "load", "fps", NAN);
  double duration = hk_lua_field_number(L, 3, "load", "duration", NAN);
  options.given = hk_tool_push_given(L, 2, &options.given_count);
  lua_setiuservalue(L, 4, 2);
  hk_lua_scene_handle *handle = hk_lua_push_scene(L);
  hk_status status = hk_script_open(path, &options, loaded, &error);
  *handle = (hk_lua_scene_handle){*loaded ? hk_script_slot(*loaded) : NULL, *loaded};
  if (status == HK_OK && !handle->slot) hk_error_set(&error, HK_SCRIPT, "%s drives its own runs", path);
  if (error.status != HK_OK) {
    lua_pushnil(L);
    lua_pushstring(L, error.text);
    return 2;
  }
  if (fps > 0) handle->slot->scene->fps = fps;
  if (duration > 0) handle->slot->scene->duration = duration;
  lua_pushvalue(L, 4);
  lua_setiuservalue(L, -2, 1);
  hk_tool_push_parameters(L, *loaded);
  return 2;
}
