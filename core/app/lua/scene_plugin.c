/* scene:force(), scene:integrator() and the like, by kind: adds a plugin with the parameters of a table. And what every
 * method of scenes begins with. */
#include "core/app/lua/internal.h"
#include "core/engine/base/base.h"

#include <string.h>

hk_scene *hk_lua_editable(lua_State *L) {
  hk_scene *scene = hk_lua_scene(L, 1);
  if (scene->frozen) hk_lua_fail(L, HK_BAD_PARAM, "the scene runs and can no longer be edited");
  return scene;
}

void hk_lua_check(lua_State *L, hk_status status, const hk_error *error) {
  if (status != HK_OK) hk_lua_raise(L, error);
}

void hk_lua_note_line(lua_State *L, char **line) {
  hk_error error = {0};
  const char *where = hk_lua_where(L);
  hk_limits_take(L, strlen(where));
  hk_lua_check(L, hk_scene_set_where(line, where, &error), &error);
  lua_pop(L, 1);
}

double hk_lua_positive(lua_State *L, int table, const char *what, const char *key, double otherwise) {
  double value = hk_lua_field_number(L, table, what, key, otherwise);
  if (value <= 0) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: %g must be positive", what, key, value);
  return value;
}

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
  hk_lua_note_line(L, &scene->auto_where);
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

hk_plugin_spec *hk_lua_add_plugin(lua_State *L, hk_scene *scene, hk_kind kind, const char *name, int params) {
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
  hk_lua_check(L, hk_scene_add_plugin(scene, kind, name, label, hk_lua_where(L), &spec, &error), &error);
  fill(L, scene, spec, params);
  return spec;
}

int hk_lua_scene_add_kind(lua_State *L) {
  hk_kind kind = (hk_kind)lua_tointeger(L, lua_upvalueindex(1));
  hk_scene *scene = hk_lua_editable(L);
  if (lua_type(L, 2) != LUA_TSTRING)
    return hk_lua_fail(L, HK_BAD_PARAM, "%s: expected a name and then parameters, scene:%s(\"name\", { ... })",
                       hk_kind_name(kind), hk_kind_name(kind));
  const char *name = lua_tostring(L, 2);
  if (kind == HK_OUTPUT && hk_lua_script(L)->run_options.no_output) return 0; /* the output is not even loaded */
  lua_settop(L, 3);
  hk_lua_add_plugin(L, scene, kind, name, 3);
  return 0;
}
