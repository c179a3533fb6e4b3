/* hooke.explain(path, {name = value}, {trust = true}): the plugins that a scene loads, its sizes, its spectrum, and the
 * stable step of every integrator. The scene is opened as a run that makes no step. */
#include "core/app/tools/tools.h"
#include "core/engine/contract/contract.h"
#include "core/numerics/implicit/implicit.h"
#include "core/numerics/step_choice/step_choice.h"

#include <lauxlib.h>

static void push_plugin(lua_State *L, const hk_plugin_spec *spec) {
  static const char *const what[] = {"particles", "edges", "triangles", "tetrahedra"};
  lua_newtable(L);
  hk_tool_set_text(L, "kind", hk_kind_name(spec->plugin->kind));
  hk_tool_set_text(L, "name", spec->plugin->name);
  hk_tool_set_text(L, "label", spec->label);
  hk_tool_set_text(L, "where", spec->where);
  for (const hk_param *p = spec->plugin->params; p && p->name; p++) {
    const void *field = hk_param_in(p, spec->values);
    if (hk_param_arity(p))
      hk_tool_set_number(L, what[hk_param_arity(p) - 1], (double)((const hk_tuples *)field)->count);
  }
}

/* Who differentiates a force for `hooke gradient` and `hooke optimise`: itself, the host by its blocks, or the host by
 * differences. */
static const char *differentiated_by(const hk_plugin *plugin) {
  const hk_force_tables *f = hk_force_of(plugin);
  bool constant = !(f->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V));
  if (constant || f->implicit.transposed) return "itself";
  return f->implicit.jacobian && !(f->own.flags & HK_STIFFER_BLOCKS) ? "blocks" : "differences";
}

/* Of the scene, and the services that they asked for. */
static void push_plugins(lua_State *L, const hk_run *run) {
  const hk_scene *scene = run->scene;
  const hk_instances *services = &run->plugins.kind[HK_SERVICE];
  static const hk_kind order[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR, HK_SOURCE, HK_OUTPUT};
  lua_newtable(L);
  for (size_t o = 0; o < sizeof order / sizeof *order; o++)
    for (size_t k = 0; k < scene->plugin[order[o]].count; k++) {
      push_plugin(L, scene->plugin[order[o]].item[k]);
      if (order[o] == HK_FORCE) {
        hk_tool_set_flag(L, "apart", hk_evaluate_is_apart(&run->dynamics, k));
        hk_tool_set_text(L, "differentiated_by", differentiated_by(scene->plugin[HK_FORCE].item[k]->plugin));
      }
      lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
    }
  for (size_t k = 0; k < services->count; k++) {
    push_plugin(L, services->item[k]->spec);
    lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
  }
  lua_setfield(L, -2, "plugins");
}

/* The stable step of a method with a fast subset: that of the rest. */
static hk_stable step_of_rest(hk_run *run, const hk_plugin_spec *spec, hk_error *error) {
  hk_stable stable = {.limit = NAN, .suggestion = NAN};
  hk_system *s = &run->dynamics.system;
  const hk_host *host = s->host;
  const hk_fast_subset *fast = s->split->fast;
  hk_spectrum rest;
  const hk_integrator *method = spec->plugin->integrator;
  hk_instance *instance = hk_instance_create(spec, &run->shared, error);
  hk_status status = instance ? hk_instance_start(instance, &run->state.view, run->state.size, error) : HK_NO_MEMORY;
  if (status == HK_OK) {
    s->host = &instance->host;
    s->split->fast = NULL;
    status = hk_integrator_tables_of(method)->split.select_fast(instance->self, s);
  }
  if (status == HK_OK) status = hk_spectrum_estimate(s, &rest, error);
  if (status == HK_OK) stable = hk_stable_step(method, instance->self, &rest);
  s->host = host;
  s->split->fast = fast;
  hk_instance_destroy(instance);
  return stable;
}

/* The stable step of a method with its default parameters. */
static hk_stable stable_step(hk_run *run, const hk_plugin *plugin, const hk_spectrum *spectrum, hk_error *error) {
  hk_plugin_spec *spec = hk_spec_create(plugin, plugin->name, "", error);
  hk_stable stable = {.limit = NAN, .suggestion = NAN};
  if (spec && hk_integrator_of(plugin)->split.select_fast)
    stable = step_of_rest(run, spec, error);
  else if (spec)
    stable = hk_stable_step(plugin->integrator, spec->values, spectrum);
  hk_spec_destroy(spec);
  return stable;
}

static void push_steps(lua_State *L, hk_run *run, const hk_spectrum *spectrum) {
  const hk_registry *registry = run->scene->registry;
  lua_newtable(L);
  for (size_t k = 0; k < registry->count; k++) {
    const hk_plugin *plugin = registry->item[k].plugin;
    if (!plugin || plugin->kind != HK_INTEGRATOR) continue;
    hk_error error = {0};
    hk_stable stable = stable_step(run, plugin, spectrum, &error);
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
  hk_tool_set_number(L, "b_max", s->b_max);
  hk_tool_set_number(L, "alpha", s->alpha);
  hk_tool_set_number(L, "beta", s->beta);
  hk_tool_set_number(L, "channel_rate", s->channel_rate);
  lua_setfield(L, -2, "spectrum");
}

static double total_mass(const hk_run *run) {
  double sum = 0;
  for (size_t i = 0; i < run->state.model.n; i++) sum += run->state.mass[i];
  return sum;
}

/* Pushes the solver of linear systems and the warnings of the plugins' start. */
static void push_solver(lua_State *L, const hk_run *run) {
  const hk_instance *solver = hk_solver_in_use(&run->dynamics);
  char libraries[160] = "";
  if (solver) hk_tool_set_text(L, "solver", solver->plugin->name);
  if (solver && solver->plugin->solver->describe) {
    const hk_instance *outer = hk_enter(solver);
    solver->plugin->solver->describe(solver->self, libraries, sizeof libraries);
    hk_leave(solver, outer);
  }
  if (*libraries) hk_tool_set_text(L, "solver_libraries", libraries);
  lua_newtable(L);
  for (size_t k = 0; k < run->warnings.count; k++) {
    lua_pushstring(L, run->warnings.text[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "warnings");
}

static void push_wanted(lua_State *L, const hk_goal *goal) {
  if (goal->low == goal->high) hk_tool_set_number(L, "value", goal->low);
  if (goal->low < goal->high && goal->low > -INFINITY) hk_tool_set_number(L, "min", goal->low);
  if (goal->low < goal->high && goal->high < INFINITY) hk_tool_set_number(L, "max", goal->high);
}

/* Pushes what `hooke optimise` looks for: controls { name, duration, values, min, max }, goals { measure, value or
 * min and max, at, where }, and the measure that is the cost, or nil. */
static void push_goals(lua_State *L, const hk_scene *scene) {
  lua_createtable(L, (int)scene->controls, 0);
  for (size_t k = 0; k < scene->controls; k++) {
    const hk_control *c = &scene->control[k];
    lua_newtable(L);
    hk_tool_set_text(L, "name", c->name);
    hk_tool_set_number(L, "duration", c->duration);
    hk_tool_set_number(L, "min", c->min);
    hk_tool_set_number(L, "max", c->max);
    lua_createtable(L, (int)c->knots, 0);
    for (size_t j = 0; j < c->knots; j++) {
      lua_pushnumber(L, c->value[j]);
      lua_rawseti(L, -2, (lua_Integer)j + 1);
    }
    lua_setfield(L, -2, "values");
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "controls");
  lua_createtable(L, (int)scene->goals, 0);
  for (size_t k = 0; k < scene->goals; k++) {
    lua_newtable(L);
    hk_tool_set_text(L, "name", scene->measure[scene->goal[k].measure].name);
    push_wanted(L, &scene->goal[k]);
    hk_tool_set_number(L, "at", scene->goal[k].at);
    hk_tool_set_text(L, "where", scene->goal[k].where);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "goals");
  if (scene->cost) hk_tool_set_text(L, "cost", scene->cost);
}

static void push_measures(lua_State *L, const hk_scene *scene) {
  lua_createtable(L, (int)scene->measures, 0);
  for (size_t k = 0; k < scene->measures; k++) {
    lua_pushstring(L, scene->measure[k].name);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "measures");
  lua_createtable(L, 0, (int)scene->measures);
  for (size_t k = 0; k < scene->measures; k++)
    if (*scene->measure[k].unit) hk_tool_set_text(L, scene->measure[k].name, scene->measure[k].unit);
  lua_setfield(L, -2, "measure_units");
}

static void describe(lua_State *L, hk_run *run, const hk_spectrum *spectrum) {
  const hk_scene *scene = run->scene;
  size_t pinned = 0;
  for (size_t k = 0; k < run->pins.count; k++) pinned += run->pins.item[k].count;
  lua_newtable(L);
  hk_tool_set_text(L, "scene", scene->name);
  hk_tool_set_text(L, "integrator", scene->integrator_auto ? "auto" : run->step->integrator->plugin->name);
  hk_tool_set_number(L, "particles", (double)run->state.model.n);
  hk_tool_set_number(L, "pinned", (double)pinned);
  hk_tool_set_number(L, "triangles", (double)run->state.model.triangles.count);
  hk_tool_set_number(L, "mass", total_mass(run));
  hk_tool_set_number(L, "state_bytes", 8.0 * (double)run->state.size);
  hk_tool_set_number(L, "duration", run->asked.end);
  hk_tool_set_number(L, "fps", scene->fps);
  hk_tool_set_number(L, "dt", run->step->length.dt);
  hk_tool_set_number(L, "tol", run->dynamics.system.tol);
  hk_tool_set_flag(L, "dt_chosen", run->step->chosen);
  hk_tool_set_number(L, "longest_step", hk_loop_longest_step(&run->loop));
  push_goals(L, scene);
  push_measures(L, scene);
  push_plugins(L, run);
  push_solver(L, run);
  push_spectrum(L, spectrum);
  push_steps(L, run, spectrum);
}

/* The explicit symplectic and reversible method with the fewest stages, for a scene that names no integrator, since a
 * run needs one. NULL: there is none. */
static const char *simplest_method(const hk_registry *registry) {
  const hk_plugin *found = NULL;
  for (size_t k = 0; k < registry->count; k++) {
    const hk_plugin *plugin = registry->item[k].plugin;
    if (!plugin || plugin->kind != HK_INTEGRATOR || hk_integrator_of(plugin)->split.select_fast) continue;
    unsigned wanted = HK_SYMPLECTIC | HK_REVERSIBLE, flags = plugin->integrator->flags;
    if ((flags & (wanted | HK_IMPLICIT | HK_ADAPTIVE)) != wanted) continue;
    if (!found || plugin->integrator->stages < found->integrator->stages) found = plugin;
  }
  return found ? found->name : NULL;
}

/* Of the whole scene, whatever the run's method sets aside. The spectrum is not known where forces are not finite:
 * evaluating them leaves no sentence, the first step does. */
static hk_status estimate(hk_run *run, hk_spectrum *spectrum, hk_error *error) {
  hk_status status = hk_step_estimate(run->step, &run->dynamics);
  *spectrum = run->step->spectrum;
  if (status == HK_OK && run->dynamics.split.fast) {
    run->dynamics.split.fast = NULL;
    status = hk_spectrum_estimate(&run->dynamics.system, spectrum, &run->error);
  }
  if (status == HK_OK) return status;
  return hk_error_set(error, status, "%s",
                      *run->error.text
                          ? run->error.text
                          : "the stable step cannot be estimated: at the start, or close to it, forces are "
                            "not finite; hooke run names the first one");
}

int hk_tool_explain(lua_State *L) {
  hk_script_options options = *hk_script_asked(hk_lua_script(L));
  hk_run_options run_options = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .progress = -1};
  hk_error error = {0};
  hk_script *script = NULL;
  hk_run *run = NULL;
  hk_spectrum spectrum;
  options.trust = false;
  if (lua_istable(L, 3)) {
    lua_getfield(L, 3, "trust");
    options.trust = lua_toboolean(L, -1);
    lua_pop(L, 1);
    hk_tool_read_without(L, 3, "explain", &run_options);
    lua_getfield(L, 3, "integrator"); /* its text stays in the table */
    run_options.integrator = lua_tostring(L, -1);
    lua_pop(L, 1);
  }
  options.run = &run_options;
  run_options.acting = hk_script_run_options(hk_lua_script(L))->acting;
  options.given = hk_tool_push_given(L, 2, &options.given_count);
  hk_status status = hk_registry_load_all(options.registry, &error);
  if (status == HK_OK) status = hk_script_open(luaL_checkstring(L, 1), &options, &script, &error);
  if (status == HK_OK && !hk_script_scene(script))
    status = hk_error_set(&error, HK_SCRIPT, "the script drives its own runs");
  run_options.no_output = true; /* outputs are listed, but not opened */
  if (status == HK_OK && hk_script_scene(script)->integrator_auto && !run_options.integrator)
    run_options.integrator = simplest_method(options.registry);
  if (status == HK_OK) status = hk_run_open(hk_script_scene(script), &run_options, &run, &error);
  if (status == HK_OK) status = estimate(run, &spectrum, &error);
  if (status == HK_OK) {
    describe(L, run, &spectrum);
    hk_tool_push_parameters(L, script);
    lua_setfield(L, -2, "parameters");
  } else
    lua_pushnil(L);
  hk_run_destroy(run);
  hk_script_close(script);
  lua_pushstring(L, error.text);
  return 2;
}
