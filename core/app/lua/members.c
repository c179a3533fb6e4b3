/* Members that `hooke`, a scene and a run do not have: scripts written from memory mix up what belongs to which, so the
 * errors say where a name is at home. The functions are __index of the tables that hold what there is. */
#include "core/app/lua/internal.h"

#include <string.h>

typedef struct keys {
  size_t count;
  const char *key[64];
} keys;

static const char *key_at(const void *context, size_t k) {
  const keys *list = context;
  return k < list->count ? list->key[k] : NULL;
}

/* The names in the table at 1. */
static keys keys_of(lua_State *L) {
  keys list = {0};
  for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1))
    if (lua_type(L, -2) == LUA_TSTRING && list.count < 64) list.key[list.count++] = lua_tostring(L, -2);
  return list;
}

static bool has(const keys *list, const char *name) {
  bool found = false;
  for (size_t k = 0; k < list->count; k++) found |= strcmp(list->key[k], name) == 0;
  return found;
}

/* The kind of plugin that a scene takes by a function of the kind's name, if there is one of that name; HK_KINDS: none.
 */
static hk_kind kind_of(lua_State *L, const keys *list, const char *name) {
  if (strchr(name, '/')) return HK_KINDS; /* of a file */
  for (hk_kind kind = 0; kind < HK_KINDS; kind++) {
    const hk_plugin *plugin;
    hk_error error = {0};
    if (!has(list, hk_kind_name(kind))) continue;
    if (hk_registry_find(hk_lua_script(L)->options.registry, kind, name, false, &plugin, &error) == HK_OK) return kind;
  }
  return HK_KINDS;
}

static int no_scene_member(lua_State *L) {
  keys list = keys_of(L);
  const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "/";
  hk_kind kind = kind_of(L, &list, name);
  if (kind < HK_KINDS)
    return hk_lua_fail(L, HK_BAD_PARAM, "a scene has no '%s'; '%s' is a plugin: scene:%s(\"%s\", { ... })", name, name,
                       hk_kind_name(kind), name);
  return hk_lua_no_member(L, "a scene", key_at, &list, "hooke.scene { ... } sets values, none is read");
}

static int no_run_member(lua_State *L) {
  keys list = keys_of(L);
  if (lua_type(L, 2) == LUA_TSTRING && hk_lua_state_has(lua_tostring(L, 2)))
    return hk_lua_fail(L, HK_BAD_PARAM, "a run has no '%s'; its state has: run:state()", lua_tostring(L, 2));
  return hk_lua_no_member(L, "a run", key_at, &list, "it has state, summary, measures and save");
}

/* Pushes "it has a, b". */
static const char *all(lua_State *L, const keys *list) {
  luaL_Buffer text;
  luaL_buffinit(L, &text);
  luaL_addstring(&text, "it has");
  for (size_t k = 0; k < list->count; k++) {
    luaL_addstring(&text, k ? ", " : " ");
    luaL_addstring(&text, list->key[k]);
  }
  luaL_pushresult(&text);
  return lua_tostring(L, -1);
}

static bool scenes_have(lua_State *L, const char *name) {
  luaL_getmetatable(L, hk_lua_scene_type);
  lua_getfield(L, -1, "__index");
  lua_pushstring(L, name);
  return lua_rawget(L, -2) != LUA_TNIL;
}

static int no_function(lua_State *L) {
  keys list = keys_of(L);
  const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
  if (strcmp(name, "run") == 0)
    return hk_lua_fail(L, HK_BAD_PARAM,
                       "hooke has no 'run'; a script returns its scene, and `hooke run FILE` runs it; scene:run { to = "
                       "t } is for scripts that drive it themselves");
  if (scenes_have(L, name))
    return hk_lua_fail(L, HK_BAD_PARAM,
                       "hooke has no '%s'; a scene has: local scene = hooke.scene { ... }; scene:%s(...)", name, name);
  return hk_lua_no_member(L, "hooke", key_at, &list, all(L, &list));
}

static void set_index(lua_State *L, lua_CFunction index) {
  lua_createtable(L, 0, 2);
  lua_pushcfunction(L, index);
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_setmetatable(L, -2);
}

void hk_lua_name_functions(lua_State *L) { set_index(L, no_function); }
void hk_lua_name_scene_methods(lua_State *L) { set_index(L, no_scene_member); }
void hk_lua_name_run_methods(lua_State *L) { set_index(L, no_run_member); }
