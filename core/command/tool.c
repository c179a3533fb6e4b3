/* Tools: Lua scripts with full rights, the engine's Lua face, and what only they need. */
#include "core/command/tool.h"
#include "core/run/engine.h"
#include "core/lua/internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- hooke.catalogue() ---- */

static void set_text(lua_State *L, const char *key, const char *value) {
  lua_pushstring(L, value ? value : "");
  lua_setfield(L, -2, key);
}

static void set_number(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

static void set_flag(lua_State *L, const char *key, bool value) {
  lua_pushboolean(L, value);
  lua_setfield(L, -2, key);
}

static void push_param(lua_State *L, const hk_param *p) {
  static const char *const type[] = {"number", "integer", "boolean",   "string", "choice",
                                     "vector", "numbers", "particles", "edges",  "per edge"};
  lua_newtable(L);
  set_text(L, "name", p->name);
  set_text(L, "unit", p->unit);
  set_text(L, "help", p->help);
  set_text(L, "type", type[p->type]);
  set_text(L, "text", p->text);
  set_flag(L, "required", p->flags & HK_REQUIRED);
  set_flag(L, "optional", p->flags & HK_OPTIONAL);
  set_flag(L, "timed", p->flags & HK_TIMED);
  set_flag(L, "above_min", p->flags & HK_ABOVE_MIN);
  if (p->min != 0 || p->max != 0) {
    set_number(L, "min", p->min);
    set_number(L, "max", p->max);
  }
  lua_createtable(L, 3, 0);
  for (int c = 0; c < 3; c++) {
    lua_pushnumber(L, p->initial[c]);
    lua_rawseti(L, -2, c + 1);
  }
  lua_setfield(L, -2, "initial");
}

static void set_force(lua_State *L, const hk_force *f) {
  set_flag(L, "on_x", f->flags & HK_DEPENDS_ON_X);
  set_flag(L, "on_v", f->flags & HK_DEPENDS_ON_V);
  set_flag(L, "on_t", f->flags & HK_DEPENDS_ON_T);
  set_flag(L, "momentum", f->flags & HK_CONSERVES_MOMENTUM);
  set_flag(L, "angular_momentum", f->flags & HK_CONSERVES_ANGULAR_MOMENTUM);
  set_flag(L, "symmetric", f->flags & HK_SYMMETRIC_JACOBIAN);
  set_flag(L, "power", f->flags & HK_POWER);
  set_flag(L, "offers_symmetric", f->flags & HK_OFFERS_SYMMETRIC);
  set_flag(L, "offers_definite", f->flags & HK_OFFERS_DEFINITE);
  set_flag(L, "energy", f->energy != NULL);
  set_flag(L, "jacobian", f->jacobian != NULL);
}

static void set_method(lua_State *L, const hk_integrator *m) {
  set_number(L, "order", m->order);
  set_number(L, "stages", m->stages);
  set_flag(L, "implicit", m->flags & HK_IMPLICIT);
  set_flag(L, "adaptive", m->flags & HK_ADAPTIVE);
  set_flag(L, "symplectic", m->flags & HK_SYMPLECTIC);
  set_flag(L, "reversible", m->flags & HK_REVERSIBLE);
}

static void push_plugin(lua_State *L, const hk_loaded *item) {
  const hk_plugin *plugin = item->plugin;
  lua_newtable(L);
  set_text(L, "path", item->path);
  set_text(L, "kind", hk_kind_name(plugin->kind));
  set_text(L, "name", plugin->name);
  set_text(L, "summary", plugin->summary);
  set_text(L, "reference", plugin->reference);
  if (plugin->kind == HK_FORCE) set_force(L, plugin->force);
  if (plugin->kind == HK_INTEGRATOR) set_method(L, plugin->integrator);
  lua_newtable(L);
  lua_Integer count = 0;
  for (const hk_param *p = plugin->params; p && p->name; p++) {
    push_param(L, p);
    lua_rawseti(L, -2, ++count);
  }
  lua_setfield(L, -2, "params");
}

/* The plugins, and the loads that failed: {path =, reason =}. */
static int catalogue(lua_State *L) {
  hk_registry *registry = hk_lua_script(L)->options.registry;
  hk_error error = {0};
  lua_Integer good = 0, bad = 0;
  if (hk_registry_load_all(registry, &error) != HK_OK) return hk_lua_raise(L, &error);
  lua_newtable(L);
  lua_newtable(L);
  for (size_t k = 0; k < registry->count; k++) {
    const hk_loaded *item = &registry->item[k];
    if (item->plugin) {
      push_plugin(L, item);
      lua_rawseti(L, -3, ++good);
    } else {
      lua_newtable(L);
      set_text(L, "path", item->path);
      set_text(L, "reason", item->reason);
      lua_rawseti(L, -2, ++bad);
    }
  }
  return 2;
}

/* hooke.describe(path): one plugin of the catalogue, by its file; or nil and the reason. */
static int describe_plugin(lua_State *L) {
  hk_error error = {0};
  const hk_loaded *item = hk_registry_load(hk_lua_script(L)->options.registry, luaL_checkstring(L, 1), &error);
  if (item) {
    push_plugin(L, item);
    return 1;
  }
  lua_pushnil(L);
  lua_pushstring(L, error.text);
  return 2;
}

/* ---- hooke.explain(path, {name = value}, {trust = true}) ---- */

static void push_force(lua_State *L, const hk_instance *instance) {
  const hk_edges *edges = hk_instance_edges(instance);
  lua_newtable(L);
  set_text(L, "kind", hk_kind_name(instance->plugin->kind));
  set_text(L, "name", instance->plugin->name);
  set_text(L, "label", instance->label);
  set_text(L, "where", instance->where);
  if (edges) set_number(L, "edges", (double)edges->count);
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
    set_text(L, "name", plugin->name);
    set_number(L, "limit", stable.limit);
    set_number(L, "suggestion", stable.suggestion);
    set_number(L, "growth_rate", stable.growth_rate);
    lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
  }
  lua_setfield(L, -2, "steps");
}

static void push_spectrum(lua_State *L, const hk_spectrum *s) {
  lua_newtable(L);
  set_number(L, "w_max", s->w_max);
  set_number(L, "g_max", s->g_max);
  set_number(L, "alpha", s->alpha);
  set_number(L, "beta", s->beta);
  set_number(L, "channel_rate", s->channel_rate);
  lua_setfield(L, -2, "spectrum");
}

static double total_mass(const hk_run *run) {
  double sum = 0;
  for (size_t i = 0; i < run->model.n; i++) sum += run->mass[i];
  return sum;
}

/* What solves linear systems, and what the plugins said when they were started. */
static void push_solver(lua_State *L, const hk_run *run) {
  char libraries[160];
  hk_solver_libraries(run, libraries, sizeof libraries);
  if (run->scene->solver) set_text(L, "solver", run->scene->solver->plugin->name);
  if (*libraries) set_text(L, "solver_libraries", libraries);
  lua_newtable(L);
  for (size_t k = 0; k < run->warnings; k++) {
    lua_pushstring(L, run->warning[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "warnings");
}

static void describe(lua_State *L, hk_run *run) {
  const hk_scene *scene = run->scene;
  size_t pinned = 0;
  for (size_t k = 0; k < run->pins; k++) pinned += run->pin_state[k].count;
  lua_newtable(L);
  set_text(L, "scene", scene->name);
  set_text(L, "integrator", scene->integrator_auto ? "auto" : scene->integrator->plugin->name);
  set_number(L, "particles", (double)run->model.n);
  set_number(L, "pinned", (double)pinned);
  set_number(L, "triangles", (double)run->model.triangles);
  set_number(L, "mass", total_mass(run));
  set_number(L, "state_bytes", 8.0 * (double)run->system.size);
  set_number(L, "duration", run->end);
  set_number(L, "fps", scene->fps);
  set_number(L, "dt", run->dt);
  set_flag(L, "dt_chosen", run->dt_chosen);
  push_plugins(L, scene);
  push_solver(L, run);
  push_spectrum(L, &run->spectrum);
  push_steps(L, run);
}

/* Implicit methods start their solver in the first step, which is not taken here. */
static hk_status start_solver(hk_run *run, hk_error *error) {
  hk_instance *solver;
  if (!(run->method->flags & HK_IMPLICIT)) return HK_OK;
  hk_status status = hk_solver_get(run, &solver);
  return status == HK_OK ? status : hk_error_set(error, status, "%s", run->error.text);
}

static int explain(lua_State *L) {
  const hk_script *tool = hk_lua_script(L);
  hk_script_options options = tool->options;
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
  options.given = hk_lua_push_given(L, 2, &options.given_count);
  hk_status status = hk_registry_load_all(options.registry, &error);
  if (status == HK_OK) status = hk_script_open(luaL_checkstring(L, 1), &options, &script, &error);
  if (status == HK_OK && !hk_script_scene(script))
    status = hk_error_set(&error, HK_SCRIPT, "the script drives its own runs");
  run_options.no_output = true; /* they are listed, not opened */
  if (status == HK_OK && hk_script_scene(script)->integrator_auto) run_options.integrator = "leapfrog";
  if (status == HK_OK) status = hk_run_open(hk_script_scene(script), &run_options, &run, &error);
  if (status == HK_OK) status = hk_step_estimate(run);
  if (status == HK_OK) status = start_solver(run, &error);
  if (status == HK_OK)
    describe(L, run);
  else
    lua_pushnil(L);
  hk_run_destroy(run);
  hk_script_close(script);
  lua_pushstring(L, error.text);
  return 2;
}

/* hooke.nearest(word, list) */
static const char *item_at(const void *context, size_t k) {
  lua_State *L = *(lua_State *const *)context;
  lua_rawgeti(L, 2, (lua_Integer)k + 1);
  const char *text = lua_tostring(L, -1); /* stays alive in the list */
  lua_pop(L, 1);
  return text;
}

static int nearest(lua_State *L) {
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_pushstring(L, hk_nearest_name(luaL_checkstring(L, 1), item_at, &L));
  return 1;
}

/* hooke.chosen(integrator, dt, tol): the answer of tools/auto.lua; dt and tol may be nil. */
static int chosen(lua_State *L) {
  hk_choice *choice = &hk_lua_script(L)->chosen;
  const char *name = luaL_checkstring(L, 1);
  luaL_argcheck(L, strlen(name) < sizeof choice->integrator, 1, "too long");
  strcpy(choice->integrator, name);
  choice->dt = luaL_optnumber(L, 2, NAN);
  choice->tol = luaL_optnumber(L, 3, NAN);
  return 0;
}

static void open_tool(lua_State *L, const hk_script *s, int argc, char **argv) {
  static const luaL_Reg functions[] = {{"catalogue", catalogue},
                                       {"describe", describe_plugin},
                                       {"explain", explain},
                                       {"load", hk_lua_load_scene},
                                       {"nearest", nearest},
                                       {"chosen", chosen},
                                       {NULL, NULL}};
  lua_getglobal(L, "hooke");
  luaL_setfuncs(L, functions, 0);
  set_text(L, "plugins", s->options.registry->root);
  set_text(L, "library", s->options.library);
  set_text(L, "folder", s->folder);
  lua_pop(L, 1);
  lua_createtable(L, argc, 0);
  for (int k = 0; k < argc; k++) {
    lua_pushstring(L, argv[k]);
    lua_rawseti(L, -2, k);
  }
  lua_setglobal(L, "arg");
  lua_getglobal(L, "package");
  lua_getfield(L, -1, "path");
  lua_pushfstring(L, "%s/?.lua;%s/?.lua;%s", s->folder, s->options.library ? s->options.library : ".",
                  lua_tostring(L, -1));
  lua_setfield(L, -3, "path");
  lua_getfield(L, -2, "cpath"); /* native modules of tools are built beside the plugins' folder */
  lua_pushfstring(L, "%s/../tools/?.so;%s", s->options.registry->root, lua_tostring(L, -1));
  lua_setfield(L, -4, "cpath");
  lua_pop(L, 3);
}

typedef struct call {
  int argc;
  char **argv;
  int exit_code;
} call;

static int run_tool(lua_State *L) {
  call *c = lua_touserdata(L, 1);
  const hk_script *s = hk_lua_script(L);
  hk_lua_open_face(L);
  open_tool(L, s, c->argc, c->argv);
  if (luaL_loadfilex(L, s->path, "t") != LUA_OK) return lua_error(L);
  lua_call(L, 0, 1);
  c->exit_code = (int)luaL_optinteger(L, -1, 0);
  return 0;
}

hk_status hk_tool_run(const char *path, int argc, char **argv, const hk_script_options *options, int *exit_code,
                      hk_choice *choice, hk_error *error) {
  hk_script *s = hk_script_new(path, options);
  call c = {argc, argv, 0};
  if (!s) return hk_error_set(error, HK_NO_MEMORY, "no memory for the tool %s", argv[0]);
  lua_pushcfunction(s->L, run_tool);
  lua_pushlightuserdata(s->L, &c);
  hk_status status = hk_lua_call(s->L, 1, 0, error);
  *exit_code = c.exit_code;
  if (choice) *choice = s->chosen;
  hk_script_close(s);
  return status;
}
