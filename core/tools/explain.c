/* hooke.explain(path, {name = value}, {trust = true}): what a scene loads, its sizes, its spectrum, and the stable step
 * of every integrator. The scene is opened as a run that makes no step. */
#include "core/tools/tools.h"
#include "core/run/engine.h"

#include <lauxlib.h>

static void push_force(lua_State *L, const hk_instance *instance) {
  const hk_edges *edges = hk_instance_edges(instance);
  lua_newtable(L);
  hk_tool_set_text(L, "kind", hk_kind_name(instance->plugin->kind));
  hk_tool_set_text(L, "name", instance->plugin->name);
  hk_tool_set_text(L, "label", instance->label);
  hk_tool_set_text(L, "where", instance->where);
  if (edges) hk_tool_set_number(L, "edges", (double)edges->count);
}

static void push_list(lua_State *L, const hk_instances *list) {
  for (size_t k = 0; k < list->count; k++) {
    push_force(L, list->item[k]);
    lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
  }
}

static void push_plugins(lua_State *L, const hk_scene *scene) {
  lua_newtable(L);
  push_list(L, &scene->force);
  push_list(L, &scene->constraint);
  push_list(L, &scene->corrector);
  push_list(L, &scene->source);
  push_list(L, &scene->output);
  lua_setfield(L, -2, "plugins");
}

static void push_steps(lua_State *L, const hk_run *run) {
  const hk_registry *registry = run->scene->registry;
  lua_newtable(L);
  for (size_t k = 0; k < registry->count; k++) {
    const hk_plugin *plugin = registry->item[k].plugin;
    if (!plugin || plugin->kind != HK_INTEGRATOR) continue;
    hk_stable stable = hk_stable_step(plugin->integrator, &run->spectrum);
    lua_newtable(L);
    hk_tool_set_text(L, "name", plugin->name);
    hk_tool_set_number(L, "limit", stable.limit);
    hk_tool_set_number(L, "suggestion", stable.suggestion);
    hk_tool_set_number(L, "growth_rate", stable.growth_rate);
    lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
  }
  lua_setfield(L, -2, "steps");
}

static void push_spectrum(lua_State *L, const hk_spectrum *s) {
  lua_newtable(L);
  hk_tool_set_number(L, "w_max", s->w_max);
  hk_tool_set_number(L, "g_max", s->g_max);
  hk_tool_set_number(L, "alpha", s->alpha);
  hk_tool_set_number(L, "beta", s->beta);
  hk_tool_set_number(L, "channel_rate", s->channel_rate);
  lua_setfield(L, -2, "spectrum");
}

static double total_mass(const hk_run *run) {
  double sum = 0;
  for (size_t i = 0; i < run->model.n; i++) sum += run->mass[i];
  return sum;
}

static void describe(lua_State *L, hk_run *run) {
  const hk_scene *scene = run->scene;
  size_t pinned = 0;
  for (size_t k = 0; k < run->pins; k++) pinned += run->pin_state[k].count;
  lua_newtable(L);
  hk_tool_set_text(L, "scene", scene->name);
  hk_tool_set_text(L, "integrator", scene->integrator_auto ? "auto" : scene->integrator->plugin->name);
  hk_tool_set_number(L, "particles", (double)run->model.n);
  hk_tool_set_number(L, "pinned", (double)pinned);
  hk_tool_set_number(L, "triangles", (double)run->model.triangles);
  hk_tool_set_number(L, "mass", total_mass(run));
  hk_tool_set_number(L, "state_bytes", 8.0 * (double)run->system.size);
  hk_tool_set_number(L, "duration", run->end);
  hk_tool_set_number(L, "fps", scene->fps);
  hk_tool_set_number(L, "dt", run->dt);
  hk_tool_set_flag(L, "dt_chosen", run->dt_chosen);
  push_plugins(L, scene);
  push_spectrum(L, &run->spectrum);
  push_steps(L, run);
}

/* For a scene that leaves its integrator to be chosen, since a run needs one: the explicit symplectic and reversible
 * method with the fewest stages. NULL: there is none. */
static const char *simplest_method(const hk_registry *registry) {
  const hk_plugin *found = NULL;
  for (size_t k = 0; k < registry->count; k++) {
    const hk_plugin *plugin = registry->item[k].plugin;
    if (!plugin || plugin->kind != HK_INTEGRATOR) continue;
    unsigned wanted = HK_SYMPLECTIC | HK_REVERSIBLE, flags = plugin->integrator->flags;
    if ((flags & (wanted | HK_IMPLICIT | HK_ADAPTIVE)) != wanted) continue;
    if (!found || plugin->integrator->stages < found->integrator->stages) found = plugin;
  }
  return found ? found->name : NULL;
}

int hk_tool_explain(lua_State *L) {
  hk_script_options options = *hk_script_asked(hk_lua_script(L));
  hk_run_options run_options = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .progress = -1};
  hk_error error = {0};
  hk_script *script = NULL;
  hk_run *run = NULL;
  options.trust = false;
  if (lua_istable(L, 3)) {
    lua_getfield(L, 3, "trust");
    options.trust = lua_toboolean(L, -1);
    lua_pop(L, 1);
  }
  options.run = &run_options;
  options.given = hk_tool_push_given(L, 2, &options.given_count);
  hk_status status = hk_registry_load_all(options.registry, &error);
  if (status == HK_OK) status = hk_script_open(luaL_checkstring(L, 1), &options, &script, &error);
  if (status == HK_OK && !hk_script_scene(script))
    status = hk_error_set(&error, HK_SCRIPT, "the script drives its own runs");
  run_options.no_output = true; /* they are listed, not opened */
  if (status == HK_OK && hk_script_scene(script)->integrator_auto)
    run_options.integrator = simplest_method(options.registry);
  if (status == HK_OK) status = hk_run_open(hk_script_scene(script), &run_options, &run, &error);
  if (status == HK_OK) status = hk_step_estimate(run);
  if (status == HK_OK)
    describe(L, run);
  else
    lua_pushnil(L);
  hk_run_destroy(run);
  hk_script_close(script);
  lua_pushstring(L, error.text);
  return 2;
}
