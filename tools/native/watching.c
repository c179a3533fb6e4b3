/* watching: calls of an output for `hooke check`, with as many particles as the tool says and a folder of its choice.
 */
#include "tools/native/common/actor.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* The path of every file that the output asks for. */
static char place[256];
static hk_status refusal;
static bool is_folder;
static lua_Integer asked; /* how often it asked for one, since `into` */

static hk_status path_of(void *context, const char *owner, const char *name, char *buffer, size_t size) {
  (void)context, (void)owner;
  asked++;
  if (refusal != HK_OK) return refusal;
  if (!is_folder) return snprintf(buffer, size, "%s", place) < (int)size ? HK_OK : HK_IO;
  size_t begin = (size_t)snprintf(buffer, size, "%s/", place);
  for (const char *c = name; *c && begin + 1 < size; c++) { /* the folders in the name are made, as in a run */
    buffer[begin] = 0;
    if (*c == '/') mkdir(buffer, 0777);
    buffer[begin++] = *c;
  }
  buffer[begin] = 0;
  return HK_OK;
}

/* quiet(scene, whether): runs that open from now on use no outputs. */
static int quiet(lua_State *L) {
  hk_script_run_options(hk_lua_owner(L, 1))->no_output = lua_toboolean(L, 2);
  return 0;
}

/* into(actor, folder), into(actor, path, true): the output's files are in the folder, or all of them are this one; nil:
 * it is refused its files. */
static int into(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  refusal = lua_isnoneornil(L, 2) ? HK_IO : HK_OK;
  is_folder = !lua_toboolean(L, 3);
  snprintf(place, sizeof place, "%s", luaL_optstring(L, 2, ""));
  a->run->shared.path = path_of;
  asked = 0;
  return 0;
}

/* asked() -> how many files the output has asked for since `into`: one that writes none has none that could fail. */
static int files_asked(lua_State *L) {
  lua_pushinteger(L, asked);
  return 1;
}

static int push_status(lua_State *L, hk_actor *a, hk_status status) {
  hk_guard_enter(NULL);
  lua_pushboolean(L, status == HK_OK);
  hk_actor_push_said(L, a);
  return 2;
}

static const hk_output *output_of(const hk_actor *a) { return a->instance->plugin->output; }

/* None acts on the crowd. `run` of the frame is its model. */
static hk_status no_force(const hk_frame *frame, size_t k, double *f) {
  (void)k;
  memset(f, 0, 3 * ((const hk_model *)frame->run)->n * sizeof *f);
  return HK_OK;
}

static bool no_flow(const hk_frame *frame, size_t k, const double *x, size_t count, double *u) {
  (void)frame, (void)k, (void)x, (void)count, (void)u;
  return false;
}

static bool no_contact(const hk_frame *frame, const hk_contact_points *points) {
  (void)frame, (void)points;
  return false;
}

/* A view of n particles, at rest in a row, whose arrays are guarded. */
static hk_view crowd(lua_State *L, hk_actor *a, size_t n, hk_model *model, hk_frame *frame) {
  static hk_guarded x, v, mass, inverse, id, group, pin, y;
  const hk_model *m = a->view.model;
  size_t channels = a->run->state.width;
  bool fine = hk_guard_get(&x, "the positions x", 3 * n * sizeof(double), HK_GUARD_BEHIND) &&
              hk_guard_get(&v, "the velocities v", 3 * n * sizeof(double), HK_GUARD_BEHIND) &&
              hk_guard_get(&y, "the channels y", channels * n * sizeof(double), HK_GUARD_BEHIND) &&
              hk_guard_get(&mass, "the masses", n * sizeof(double), HK_GUARD_BEHIND) &&
              hk_guard_get(&inverse, "the inverse masses", n * sizeof(double), HK_GUARD_BEHIND) &&
              hk_guard_get(&id, "the ids", n * sizeof(uint32_t), HK_GUARD_BEHIND) &&
              hk_guard_get(&group, "the groups", n * sizeof(uint32_t), HK_GUARD_BEHIND) &&
              hk_guard_get(&pin, "the pins", n, HK_GUARD_BEHIND);
  if (!fine) luaL_error(L, "no memory for %d particles", (int)n);
  for (size_t i = 0; i < n; i++) {
    ((double *)x.at)[3 * i] = (double)i;
    ((double *)mass.at)[i] = ((double *)inverse.at)[i] = 1;
    ((uint32_t *)id.at)[i] = (uint32_t)i + 1;
  }
  hk_guarded *const all[] = {&x, &v, &y, &mass, &inverse, &id, &group, &pin};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) hk_guard_allow(all[k], false);
  *model = *m;
  model->n = n;
  model->mass = mass.at;
  model->inverse_mass = inverse.at;
  model->id = id.at;
  model->group = group.at;
  model->pin = pin.at;
  model->edges.count = model->triangles.count = 0;
  model->element_lists = model->join_lists = 0;
  *frame = hk_run_output_frame(a->run);
  frame->force = no_force;
  frame->flow = no_flow;
  frame->contact_points = no_contact;
  frame->run = model;
  hk_view view = a->view;
  view.n = view.acting = n;
  view.x = x.at;
  view.v = v.at;
  view.y = channels ? y.at : NULL;
  view.model = model;
  return view;
}

/* As in a run, the plugin's fields follow births and deaths, and it hears of them before it sees them: those beyond the
 * smaller number. */
static hk_status tell_of_change(lua_State *L, hk_actor *a, const hk_view *view) {
  size_t old = a->told_of, size = (6 + a->run->state.width) * view->n + 1;
  if (view->n == old) return HK_OK;
  uint32_t *map = lua_newuserdatauv(L, (old + 1) * sizeof *map, 0);
  for (size_t i = 0; i < old; i++) map[i] = i < view->n ? (uint32_t)i : UINT32_MAX;
  a->told_of = view->n;
  hk_guard_enter("topology");
  hk_status status = hk_instance_remap(a->instance, map, old, view, size, &a->run->error);
  lua_pop(L, 1);
  return status;
}

/* begin(actor, n), frame(actor, n, index): with n particles -> whether it was fine, what it said */
static int begin(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  hk_model model;
  hk_frame frame;
  hk_view view = crowd(L, a, (size_t)luaL_checkinteger(L, 2), &model, &frame);
  frame.index = 0;
  hk_status status = tell_of_change(L, a, &view);
  if (status != HK_OK) return push_status(L, a, status);
  hk_guard_enter("open");
  return push_status(L, a, output_of(a)->open ? output_of(a)->open(a->instance->self, &view, &frame) : HK_OK);
}

static int show(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  hk_model model;
  hk_frame frame;
  hk_view view = crowd(L, a, (size_t)luaL_checkinteger(L, 2), &model, &frame);
  frame.index = (size_t)luaL_checkinteger(L, 3);
  view.t = (double)frame.index / frame.fps;
  hk_status status = tell_of_change(L, a, &view);
  if (status != HK_OK) return push_status(L, a, status);
  hk_guard_enter("frame");
  return push_status(L, a, output_of(a)->frame(a->instance->self, &view, &frame));
}

/* finish(actor, verdict): "ok", "diverged" or "stopped" */
static int finish(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  static const char *const names[] = {"ok", "diverged", "stopped", NULL};
  static const hk_verdict verdicts[] = {HK_VERDICT_OK, HK_DIVERGED, HK_STOPPED};
  hk_verdict verdict = verdicts[luaL_checkoption(L, 2, "ok", names)];
  hk_guard_enter("close");
  return push_status(L, a, output_of(a)->close ? output_of(a)->close(a->instance->self, verdict) : HK_OK);
}

/* files() -> how many files this process has open */
static int files(lua_State *L) {
  lua_Integer count = 0;
  DIR *folder = opendir("/proc/self/fd");
  while (folder && readdir(folder)) count++;
  if (folder) closedir(folder);
  lua_pushinteger(L, count);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_watching(lua_State *L);

int luaopen_watching(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"open", hk_actor_open}, {"watch", hk_actor_watch}, {"into", into},     {"asked", files_asked}, {"quiet", quiet},
      {"begin", begin},        {"frame", show},           {"finish", finish}, {"files", files},       {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
