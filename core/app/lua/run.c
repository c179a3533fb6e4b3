/* scene:run{}: runs driven by a script. Another scene:run{ to = } advances the run object further; state() and
 * summary() read it. The run is closed with the script. */
#include "core/app/lua/internal.h"

#include <float.h>

const char hk_lua_run_type[] = "hooke.run";
enum { CALL_COST = 100 }; /* instructions charged for scene:run, so that an endless loop of calls ends */

static void set_number(lua_State *L, const char *key, double value) {
  if (!isfinite(value)) return; /* an unknown figure is nil, as it is null in JSON */
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

static void set_text(lua_State *L, const char *key, const char *value) {
  if (value)
    hk_lua_push_plain(L, value);
  else
    lua_pushnil(L);
  lua_setfield(L, -2, key);
}

/* Pushes { name = value }; what is not finite is nil. */
static void push_measures(lua_State *L, size_t count, const char *const *name, const double *value) {
  lua_createtable(L, 0, (int)count);
  for (size_t k = 0; k < count; k++)
    if (isfinite(value[k])) {
      hk_lua_push_plain(L, name[k]);
      lua_pushnumber(L, value[k]);
      lua_rawset(L, -3);
    }
}

/* Pushes { name = unit } of the measures whose units the scene says. */
static void push_units(lua_State *L, const hk_summary *s) {
  lua_createtable(L, 0, (int)s->measures);
  for (size_t k = 0; k < s->measures; k++)
    if (*s->measure_unit[k]) {
      hk_lua_push_plain(L, s->measure_name[k]);
      lua_pushstring(L, s->measure_unit[k]);
      lua_rawset(L, -3);
    }
}

static void push_own_figures(lua_State *L, const hk_plugin_time *plugin) {
  lua_createtable(L, 0, (int)plugin->figures);
  for (size_t k = 0; k < plugin->figures; k++) set_number(L, plugin->figure[k].name, plugin->figure[k].value);
  lua_setfield(L, -2, "figures");
}

static void push_lists(lua_State *L, const hk_summary *s) {
  lua_createtable(L, (int)s->plugins, 0);
  for (size_t k = 0; k < s->plugins; k++) {
    lua_createtable(L, 0, 4);
    set_text(L, "kind", s->plugin[k].kind);
    set_text(L, "name", s->plugin[k].name);
    set_text(L, "label", s->plugin[k].label);
    set_number(L, "seconds", s->plugin[k].seconds);
    if (s->plugin[k].figures) push_own_figures(L, &s->plugin[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "plugins");
  push_measures(L, s->measures, s->measure_name, s->measure);
  lua_setfield(L, -2, "measures");
  push_units(L, s);
  lua_setfield(L, -2, "measure_units");
  lua_createtable(L, (int)s->warnings, 0);
  for (size_t k = 0; k < s->warnings; k++) {
    lua_pushstring(L, s->warning[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, -2, "warnings");
}

static void set_figure(lua_State *L, const hk_summary *s, const hk_figure *f) {
  const void *field = (const char *)s + f->offset;
  if (f->type == HK_FIGURE_NUMBER)
    set_number(L, f->key, *(const double *)field);
  else if (f->type == HK_FIGURE_COUNT) {
    lua_pushinteger(L, (lua_Integer) * (const size_t *)field);
    lua_setfield(L, -2, f->key);
  } else
    set_text(L, f->key, f->type == HK_FIGURE_BUFFER ? field : *(const char *const *)field); /* NULL: nil */
}

void hk_lua_push_summary(lua_State *L, const hk_summary *s) {
  lua_createtable(L, 0, 48);
  for (const hk_figure *f = hk_figure_table; f->key; f++) {
    if (f->group && lua_getfield(L, -1, f->group) == LUA_TNIL) {
      lua_pop(L, 1);
      lua_newtable(L);
      lua_pushvalue(L, -1);
      lua_setfield(L, -3, f->group);
    }
    set_figure(L, s, f);
    if (f->group) lua_pop(L, 1);
  }
  push_lists(L, s);
}

hk_run *hk_lua_run(lua_State *L) {
  const hk_lua_slot *slot = *(hk_lua_slot **)hk_lua_self(L, hk_lua_run_type, "run:state()");
  if (!slot->run) hk_lua_fail(L, HK_BAD_PARAM, "this run has ended");
  return slot->run;
}

static int state(lua_State *L) {
  hk_lua_run(L);
  lua_getiuservalue(L, 1, 1);
  hk_lua_push_state(L, -1);
  return 1;
}

static int summary(lua_State *L) {
  hk_summary s;
  hk_run_summary(hk_lua_run(L), &s);
  hk_lua_push_summary(L, &s);
  return 1;
}

/* measures() -> { name = value } of the present time; those of the summary are the last frame's. */
static int measures(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  hk_judgement *j = &run->judgement;
  hk_lua_check(L, hk_figures_measure(&run->loop, j, run), &run->error);
  push_measures(L, j->scene->measures, j->measure_name, j->measure);
  return 1;
}

/* Appends `width` numbers of each particle, in the order of ids. */
static void add_in_order(luaL_Buffer *buffer, const hk_model *m, const double *from, size_t width) {
  for (size_t k = 0; k < m->n; k++)
    luaL_addlstring(buffer, (const char *)(from + width * hk_model_nth(m, k)), width * sizeof *from);
}

/* The state as a string of doubles: n, t, then ids, positions and velocities, n, 3n and 3n of them. */
static int packed(lua_State *L) {
  const hk_view *view = hk_run_view(hk_lua_run(L));
  luaL_Buffer buffer;
  double head[2] = {(double)view->n, view->t};
  luaL_buffinit(L, &buffer);
  luaL_addlstring(&buffer, (const char *)head, sizeof head);
  for (size_t i = 0; i < view->n; i++) {
    double id = view->model->id[hk_model_nth(view->model, i)];
    luaL_addlstring(&buffer, (const char *)&id, sizeof id);
  }
  add_in_order(&buffer, view->model, view->x, 3);
  add_in_order(&buffer, view->model, view->v, 3);
  luaL_pushresult(&buffer);
  return 1;
}

static int save(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  hk_error error = {0};
  if (!hk_lua_script(L)->options.trust)
    return hk_lua_fail(L, HK_SCRIPT, "run:save writes a file: run with --trust to allow it");
  if (hk_run_save(run, hk_lua_text(L, 2, "run:save(\"state.csv\")"), &error) != HK_OK) return hk_lua_raise(L, &error);
  return 0;
}

static int severity(hk_verdict verdict) {
  return verdict == HK_DIVERGED ? 3 : verdict == HK_STOPPED ? 2 : verdict == HK_INACCURATE;
}

void hk_lua_note_verdict(hk_script *s, hk_run *run) {
  hk_summary now;
  hk_run_summary(run, &now);
  if (severity(now.verdict) > severity(s->worst)) s->worst = now.verdict;
}

hk_status hk_lua_end_run(hk_run *run, hk_error *error) {
  hk_status status = hk_run_close(run, error), left = hk_run_write_summary(run, NULL, error);
  return status == HK_OK ? left : status;
}

/* Advances to time `to`. At its end the run is closed and judged; a later call does nothing. */
static hk_status drive(hk_lua_slot *slot, const hk_run_options *options, double to, hk_error *error) {
  hk_status status = slot->run ? HK_OK : hk_run_open(slot->scene, options, &slot->run, error);
  if (status != HK_OK) return status;
  hk_run *run = slot->run;
  double end = hk_run_end(run);
  if (hk_run_view(run)->t >= end && end > 0) return HK_OK;
  status = hk_run_advance(run, to < end ? to : end, error);
  return status == HK_OK && to >= end ? hk_lua_end_run(run, error) : status;
}

/* A time that is a frame's but for rounding, such as k times the length of a frame, is the frame's, which is k/fps: the
 * step that ends there would else be followed by one of 1e-16 s. */
static double snapped(const hk_scene *scene, double to) {
  double frame = round(to * scene->fps) / scene->fps;
  return fabs(to - frame) <= 4 * DBL_EPSILON * to && frame <= scene->duration ? frame : to;
}

/* About what a run needs: some vectors like the state's, and what plugins and threads have of their own. */
static size_t run_bytes(const hk_scene *scene) {
  enum { VECTORS = 16, PLUGIN = 4096, BASE = 1 << 18 };
  size_t width = 6, plugins = 0;
  for (size_t k = 0; k < scene->particles.channels; k++) width += scene->particles.channel[k].size;
  for (int kind = 0; kind < HK_KINDS; kind++) plugins += scene->plugin[kind].count;
  return BASE + PLUGIN * plugins + VECTORS * width * scene->particles.n * sizeof(double);
}

/* A run does not go back: its state would be that of another time than the script thinks. */
static void check_end(lua_State *L, const hk_lua_slot *slot, double to) {
  const double rounding = 1e-9 / slot->scene->fps, now = slot->run ? hk_run_view(slot->run)->t : 0;
  if (to < INFINITY && to > slot->scene->duration)
    hk_lua_fail(L, HK_BAD_PARAM, "run: to: %g s is after the scene's duration, %g s", to, slot->scene->duration);
  if (to < now - rounding)
    hk_lua_fail(L, HK_BAD_PARAM, "run: to: %g s is before the run's present time, %g s, and it goes forwards only", to,
                now);
}

int hk_lua_scene_run(lua_State *L) {
  static const char *const keys[] = {"to", NULL};
  hk_script *s = hk_lua_script(L);
  hk_lua_slot *slot = hk_lua_slot_at(L, 1);
  hk_error error = {0};
  double to = INFINITY;
  lua_State *outer = s->current;
  lua_settop(L, 2);
  if (lua_istable(L, 2)) {
    hk_lua_check_keys(L, 2, "run", keys);
    to = hk_lua_field_number(L, 2, "run", "to", INFINITY);
  }
  check_end(L, slot, to);
  to = snapped(slot->scene, to);
  if (s->finished || s->driving)
    return hk_lua_fail(L, HK_SCRIPT, "a scene is run by the script itself, not by a function that the run calls");
  if (!slot->run) hk_limits_take(L, run_bytes(slot->scene));
  s->drove = s->driving = true;
  s->current = L;
  bool inside = hk_limits_inside(s, false);
  double used = hk_limits_pause(s);
  hk_status status = drive(slot, &hk_lua_owner(L, 1)->run_options, to, &error);
  hk_limits_resume(s, used);
  hk_limits_inside(s, inside);
  s->current = outer;
  s->driving = false;
  s->instructions += CALL_COST;
  if (slot->run && (status != HK_OK || to >= hk_run_end(slot->run))) hk_lua_note_verdict(s, slot->run);
  if (status != HK_OK) return hk_lua_raise(L, &error);
  hk_lua_slot **holder = lua_newuserdatauv(L, sizeof *holder, 1);
  *holder = slot;
  lua_pushvalue(L, 1);
  lua_setiuservalue(L, -2, 1); /* keeps the scene alive as long as the run */
  luaL_setmetatable(L, hk_lua_run_type);
  return 1;
}

void hk_lua_open_run(lua_State *L) {
  static const luaL_Reg methods[] = {{"state", state}, {"summary", summary}, {"measures", measures},
                                     {"save", save},   {"packed", packed},   {NULL, NULL}};
  luaL_newmetatable(L, hk_lua_run_type);
  lua_newtable(L);
  luaL_setfuncs(L, methods, 0);
  hk_lua_name_run_methods(L);
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
}
