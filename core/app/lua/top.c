/* Opening and closing a script: the one file of core/app/lua that includes all others. It makes the Lua state,
 * registers every library, runs the file in its sandbox and keeps the scene that it returns. A tool's state differs in
 * two things: it has full rights, and core/app/tools registers the functions that only tools have. */
#include "core/app/lua/internal.h"
#include "core/app/builders/builders.h"
#include "core/engine/base/base.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Lua begins with a seed of chance: a trusted scene that draws random numbers would be another one in each run, and in
 * the run that it is compared with. The seed is that of the sandbox. */
static void seed_random(lua_State *L) {
  lua_getglobal(L, "math");
  lua_getfield(L, -1, "randomseed");
  lua_pushinteger(L, 0);
  lua_call(L, 1, 0);
  lua_pop(L, 1);
}

/* Lua's libraries, `hooke` and `param` as globals. What the environment says of Lua's folders is not asked for. */
static void open_libraries(lua_State *L) {
  lua_pushboolean(L, 1);
  lua_setfield(L, LUA_REGISTRYINDEX, "LUA_NOENV"); /* as lua -E does */
  luaL_openlibs(L);
  seed_random(L);
  hk_lua_open_edges(L);
  hk_lua_open_handles(L);
  hk_lua_open_rigid(L);
  hk_lua_open_joint(L);
  hk_lua_open_scene(L);
  hk_lua_open_state(L);
  hk_lua_open_run(L);
  lua_pushcfunction(L, hk_lua_param);
  lua_setglobal(L, "param");
}

static bool set_names(hk_script *s, const char *path) {
  const char *slash = strrchr(path, '/');
  s->path = hk_string_copy(path);
  s->name = hk_string_copy(slash ? slash + 1 : path);
  s->folder = hk_string_copy(slash ? path : ".");
  if (s->folder && slash) s->folder[slash == path ? 1 : slash - path] = 0;
  return s->path && s->name && s->folder;
}

/* Makes a script whose file is not run yet: limits and Lua state, no libraries. NULL: no memory. */
static hk_script *new_script(const char *path, const hk_script_options *options) {
  hk_script *s = calloc(1, sizeof *s);
  if (!s) return NULL;
  s->options = *options;
  if (options->run) s->run_options = *options->run;
  s->worst = HK_VERDICT_OK;
  if (set_names(s, path) && hk_limits_open(s)) return s;
  hk_script_close(s);
  return NULL;
}

/* Pushes the script as a function in its environment, or nil when the file cannot be read. */
static int prepare(lua_State *L) {
  open_libraries(L);
  hk_lua_push_sandbox(L);
  int code = hk_lua_load_script(L);
  if (code == LUA_ERRFILE) return 0;
  if (code != LUA_OK) return lua_error(L);
  lua_insert(L, -2);
  lua_setupvalue(L, -2, 1); /* _ENV */
  return 1;
}

void hk_lua_run_file(lua_State *L) {
  const hk_script *s = hk_lua_script(L);
  hk_lua_push_sandbox(L);
  int code = hk_lua_load(L, s->path, s->name, NULL);
  if (code == LUA_ERRFILE) hk_lua_fail(L, HK_IO, "cannot read %s: %s", s->path, strerror(errno));
  if (code != LUA_OK) lua_error(L);
  lua_insert(L, -2);
  lua_setupvalue(L, -2, 1); /* _ENV */
  lua_call(L, 0, 1);
}

/* Closes the runs that the script left open. */
static hk_status close_runs(hk_script *s, hk_error *error) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < s->slots; k++) {
    hk_run *run = s->slot[k]->run;
    if (!run) continue;
    hk_status closed = hk_lua_end_run(run, error);
    if (status == HK_OK) status = closed;
    hk_lua_note_verdict(s, run);
  }
  return status;
}

/* The script has ended: what its scenes were made from is known, and they stay as they are. */
static hk_status note_origin(hk_script *s, hk_error *error) {
  char name[256];
  bool fine = true;
  for (size_t k = 0; k < s->params && fine; k++) {
    snprintf(name, sizeof name, "the parameter %s", s->param[k].name);
    fine = s->param[k].value && hk_origin_add(&s->origin, name, s->param[k].value);
  }
  for (size_t k = 0; k < s->slots && fine; k++) {
    hk_scene *scene = s->slot[k]->scene;
    scene->frozen = true;
    snprintf(name, sizeof name, "%llu", (unsigned long long)scene->seed);
    scene->origin = s->origin ? hk_string_copy(s->origin) : NULL;
    fine = hk_origin_add(&scene->origin, "the seed", name);
  }
  return fine ? HK_OK : hk_error_set(error, HK_NO_MEMORY, "no memory for what %s was made from", s->name);
}

static hk_status run_script(hk_script *s, hk_error *error) {
  lua_State *L = s->L;
  lua_pushcfunction(L, prepare);
  hk_status status = hk_lua_call(L, 0, 1, error);
  if (status == HK_OK && lua_isnil(L, -1)) return hk_lua_no_file(s, error);
  if (status == HK_OK) status = hk_lua_call(L, 0, 1, error);
  s->finished = true;
  if (status == HK_OK) status = hk_lua_check_given(s, error);
  if (status != HK_OK) return status;
  const hk_lua_scene_handle *returned = luaL_testudata(L, -1, hk_lua_scene_type);
  if (returned) s->returned = returned->slot;
  status = note_origin(s, error);
  if (status != HK_OK) return status;
  lua_settop(L, 0);
  lua_gc(L, LUA_GCCOLLECT, 0); /* frees lists of edges, which the plugins have copied, before the run allocates */
  if (s->returned) return HK_OK;
  if (s->drove) return close_runs(s, error);
  return hk_error_set(error, HK_SCRIPT, "%s returned no scene: end it with 'return scene'", s->name);
}

hk_status hk_script_open(const char *path, const hk_script_options *options, hk_script **script, hk_error *error) {
  *script = new_script(path, options);
  if (!*script) return hk_error_set(error, HK_NO_MEMORY, "no memory for the script %s", path);
  return run_script(*script, error);
}

void hk_script_close(hk_script *s) {
  if (!s) return;
  for (size_t k = 0; k < s->slots; k++) {
    hk_run *run = s->slot[k]->run;
    if (run) hk_lua_end_run(run, NULL);
    hk_run_destroy(run);
    hk_scene_destroy(s->slot[k]->scene);
    free(s->slot[k]);
  }
  if (s->L) lua_close(s->L);
  for (size_t k = 0; k < s->params; k++) {
    free(s->param[k].name);
    free(s->param[k].help);
    free(s->param[k].initial);
    free(s->param[k].value);
  }
  free(s->param);
  free(s->origin);
  free(s->slot);
  free(s->path);
  free(s->name);
  free(s->folder);
  free(s);
}

hk_lua_slot *hk_script_slot(hk_script *s) { return s->returned; }
hk_scene *hk_script_scene(const hk_script *s) { return s->returned ? s->returned->scene : NULL; }

bool hk_script_drove(const hk_script *s, hk_verdict *worst) {
  *worst = s->worst;
  return s->drove && !s->returned;
}

size_t hk_script_params(const hk_script *s, const hk_param_declared **params) {
  *params = s->param;
  return s->params;
}

hk_work hk_script_work(const hk_script *s) {
  hk_work work = {.worst = s->worst};
  for (size_t k = 0; k < s->slots; k++) {
    if (!s->slot[k]->run) continue;
    hk_summary of;
    hk_run_summary(s->slot[k]->run, &of);
    work.runs++;
    work.steps += of.steps;
    work.evaluations += of.force_evaluations;
  }
  return work;
}

const hk_script_options *hk_script_asked(const hk_script *s) { return &s->options; }
hk_run_options *hk_script_run_options(hk_script *s) { return &s->run_options; }
const char *hk_script_path(const hk_script *s) { return s->path; }
const char *hk_script_folder(const hk_script *s) { return s->folder; }

/* ---- a tool ---- */

typedef struct entry {
  lua_CFunction function;
  void *context;
} entry;

static int enter(lua_State *L) {
  const entry *e = lua_touserdata(L, 1);
  open_libraries(L);
  lua_pushcfunction(L, e->function);
  lua_pushlightuserdata(L, e->context);
  lua_call(L, 1, 0);
  return 0;
}

hk_status hk_script_host(const char *path, const hk_script_options *options, lua_CFunction function, void *context,
                         hk_error *error) {
  entry e = {function, context};
  hk_script *s = new_script(path, options);
  if (!s) return hk_error_set(error, HK_NO_MEMORY, "no memory for the tool %s", path);
  lua_pushcfunction(s->L, enter);
  lua_pushlightuserdata(s->L, &e);
  hk_status status = hk_lua_call(s->L, 1, 0, error);
  hk_script_close(s);
  return status;
}

/* ---- the scene opened again ---- */

/* Also twice over: a trial of what would do is compared with other runs itself. */
typedef struct second_script {
  const char *path;
  const hk_script_options *options;
  hk_script *script[2]; /* those that are open */
  int count;
} second_script;

static hk_status open_again(void *context, const hk_run_options *run, hk_run **again, hk_error *error) {
  second_script *second = context;
  hk_script_options options = *second->options;
  options.run = run;
  options.silent = true;
  hk_script **script = &second->script[second->count++];
  *script = NULL;
  hk_status status = hk_script_open(second->path, &options, script, error);
  return status == HK_OK ? hk_run_open(hk_script_scene(*script), run, again, error) : status;
}

static void close_again(void *context, hk_run *again) {
  second_script *second = context;
  hk_run_destroy(again);
  hk_script_close(second->script[--second->count]);
}

hk_status hk_script_verify(const char *path, const hk_script_options *options, const hk_run_options *run, bool half,
                           hk_run *whole, hk_summary *summary, hk_error *error) {
  second_script second = {.path = path, .options = options};
  hk_scene_loader loader = {open_again, close_again, &second};
  hk_status status = hk_verify(&loader, run, half, whole, summary, error);
  if (status == HK_OK && summary->verdict == HK_INACCURATE) hk_remedy_try(&loader, run, whole, summary);
  return status;
}

void hk_script_runtime_estimate(const char *path, const hk_script_options *options, const hk_run_options *run,
                                hk_run *whole) {
  second_script second = {.path = path, .options = options};
  hk_scene_loader loader = {open_again, close_again, &second};
  hk_runtime_estimate(&loader, run, whole);
}
