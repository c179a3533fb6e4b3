/* An actor: see actor.h. */
#include "tools/native/common/actor.h"

#include <string.h>

static const char type[] = "hooke.actor";

void hk_actor_push_said(lua_State *L, hk_actor *a) {
  const char *text = a->run->error.text;
  size_t length = strlen(a->instance->where);
  if (length && strncmp(text, a->instance->where, length) == 0 && strncmp(text + length, ": ", 2) == 0)
    text += length + 2;
  lua_pushstring(L, text);
  a->run->error = (hk_error){0};
}

hk_actor *hk_actor_at(lua_State *L, int index) { return luaL_checkudata(L, index, type); }

static int close_actor(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  if (a->own) hk_instance_destroy(a->instance);
  a->own = false;
  hk_guard_free(&a->x);
  hk_guard_free(&a->v);
  hk_guard_free(&a->out[0]);
  hk_guard_free(&a->out[1]);
  return 0;
}

static void find(lua_State *L, hk_actor *a, const char *kind, bool fresh) {
  hk_run *run = a->run;
  int k = 0;
  while (k < HK_KINDS - 1 && strcmp(hk_kind_name((hk_kind)k), kind) != 0) k++;
  a->instance = run->plugins.kind[k].count ? run->plugins.kind[k].item[0] : NULL;
  if (a->instance && !fresh) return;
  if (!a->instance && run->scene->plugin[k].count == 0) luaL_error(L, "the scene has no %s", kind);
  const hk_plugin_spec *spec = a->instance ? a->instance->spec : run->scene->plugin[k].item[0];
  a->instance = hk_instance_create(spec, &run->shared, &run->error);
  if (!a->instance) luaL_error(L, "%s", run->error.text);
  a->own = true;
  hk_view view = hk_instance_view(a->instance, &run->state.view);
  hk_guard_enter("create");
  hk_status status = hk_instance_start(a->instance, &view, run->state.size, &run->error);
  hk_guard_enter(NULL);
  if (status == HK_OK) return;
  hk_actor_push_said(L, a);
  lua_error(L);
}

static void take(lua_State *L, hk_guarded *g, const char *name, const double *from, size_t count, hk_guard_side side) {
  if (!hk_guard_get(g, name, count * sizeof(double), side)) luaL_error(L, "no memory for %s", name);
  if (from) memcpy(g->at, from, count * sizeof(double));
}

int hk_actor_open(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  const char *kind = luaL_checkstring(L, 2);
  static const char *const sides[] = {"behind", "before", NULL};
  int side = luaL_checkoption(L, 3, "behind", sides);
  lua_settop(L, 4);
  hk_actor *a = lua_newuserdatauv(L, sizeof *a, 1);
  *a = (hk_actor){.run = run, .n = run->state.model.n, .side = side ? HK_GUARD_BEFORE : HK_GUARD_BEHIND};
  a->told_of = a->n;
  lua_pushvalue(L, 1);
  lua_setiuservalue(L, -2, 1);
  if (luaL_newmetatable(L, type)) {
    lua_pushcfunction(L, close_actor);
    lua_setfield(L, -2, "__gc");
  }
  lua_setmetatable(L, -2);
  find(L, a, kind, lua_toboolean(L, 4));
  a->view = hk_instance_view(a->instance, &run->state.view);
  take(L, &a->x, "the positions x", run->state.X, 3 * a->n, a->side);
  take(L, &a->v, "the velocities v", run->state.X + 3 * a->n, 3 * a->n, a->side);
  a->view.x = a->x.at;
  a->view.v = a->v.at;
  hk_guard_allow(&a->x, false);
  hk_guard_allow(&a->v, false);
  return 1;
}

int hk_actor_watch(lua_State *L) {
  hk_guard_watch((int)luaL_checkinteger(L, 1));
  return 0;
}

static void set_array(lua_State *L, const char *key, hk_guarded *g) {
  if (lua_getfield(L, 2, key) == LUA_TTABLE) {
    hk_guard_allow(g, true);
    hk_table_read(L, lua_gettop(L), g->at, g->bytes / sizeof(double));
    hk_guard_allow(g, false);
  }
  lua_pop(L, 1);
}

int hk_actor_set(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  hk_error error = {0};
  set_array(L, "x", &a->x);
  set_array(L, "v", &a->v);
  if (lua_getfield(L, 2, "t") == LUA_TNUMBER) a->view.t = lua_tonumber(L, -1);
  if (hk_instance_set_time(a->instance, a->view.t, &error) != HK_OK) return luaL_error(L, "%s", error.text);
  return 0;
}

double *hk_actor_out(lua_State *L, hk_actor *a, int k, const char *name, size_t count) {
  take(L, &a->out[k], name, NULL, count, a->side);
  return a->out[k].at;
}
