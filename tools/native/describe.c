/* describe: what a plugin says of itself in its one constant, which is read without running any of its code. */
#include "core/registry.h"

#include <dlfcn.h>
#include <lauxlib.h>
#include <limits.h>
#include <lua.h>
#include <stdlib.h>

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
  set_text(L, "type", type[p->type]);
  set_text(L, "text", p->text);
  set_flag(L, "required", p->flags & HK_REQUIRED);
  set_flag(L, "optional", p->flags & HK_OPTIONAL);
  set_flag(L, "above_min", p->flags & HK_ABOVE_MIN);
  set_flag(L, "zero", p->initial[0] == 0 && p->initial[1] == 0 && p->initial[2] == 0);
  if (p->min == 0 && p->max == 0) return;
  set_number(L, "min", p->min);
  set_number(L, "max", p->max);
}

static void push_force_flags(lua_State *L, const hk_force *f) {
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

static void push_method(lua_State *L, const hk_integrator *m) {
  set_number(L, "order", m->order);
  set_flag(L, "implicit", m->flags & HK_IMPLICIT);
  set_flag(L, "adaptive", m->flags & HK_ADAPTIVE);
  set_flag(L, "reversible", m->flags & HK_REVERSIBLE);
}

/* The constant of the plugin at `path`, or NULL and the reason on the stack. */
static const hk_plugin *plugin_at(lua_State *L, const char *path) {
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  const hk_plugin *p = handle ? dlsym(handle, "hk_plugin_main") : NULL;
  if (!handle)
    lua_pushstring(L, dlerror());
  else if (!p)
    lua_pushfstring(L, "%s exports no hk_plugin_main: it is not a plugin of hooke", path);
  else if (p->abi >> 16 != HK_ABI_MAJOR || (p->abi & 0xffff) > HK_ABI_MINOR)
    lua_pushfstring(L, "%s was built for plugin interface %d.%d and this hooke has %d.%d: build it again", path,
                    (int)(p->abi >> 16), (int)(p->abi & 0xffff), HK_ABI_MAJOR, HK_ABI_MINOR);
  else if ((unsigned)p->kind >= HK_KINDS || !p->name || !p->summary || !p->force)
    lua_pushfstring(L, "%s: its kind, name, summary or functions are missing", path);
  else
    return p;
  return NULL;
}

/* open(path) -> {path (absolute), kind, name, summary, params, and by kind its flags}; or nil and the reason. */
static int open_plugin(lua_State *L) {
  const hk_plugin *p = plugin_at(L, luaL_checkstring(L, 1));
  char path[PATH_MAX];
  if (!p || !realpath(lua_tostring(L, 1), path)) {
    if (p) lua_pushfstring(L, "%s: there is no such file", lua_tostring(L, 1));
    lua_pushnil(L);
    lua_insert(L, -2);
    return 2;
  }
  lua_newtable(L);
  set_text(L, "path", path);
  set_text(L, "kind", hk_kind_name(p->kind));
  set_text(L, "name", p->name);
  set_text(L, "summary", p->summary);
  if (p->kind == HK_FORCE) push_force_flags(L, p->force);
  if (p->kind == HK_INTEGRATOR) push_method(L, p->integrator);
  lua_newtable(L);
  lua_Integer count = 0;
  for (const hk_param *q = p->params; q && q->name; q++) {
    push_param(L, q);
    lua_rawseti(L, -2, ++count);
  }
  lua_setfield(L, -2, "params");
  return 1;
}

__attribute__((visibility("default"))) int luaopen_describe(lua_State *L);

int luaopen_describe(lua_State *L) {
  static const luaL_Reg functions[] = {{"open", open_plugin}, {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
