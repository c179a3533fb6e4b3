/* material = "name" in a builder's or a plugin's table stands for numbers of the module `material_numbers`, which is in
 * scripts/lib, or beside the scene: a table of materials, each a table of tables of values, by the name of the builder
 * or plugin that takes them. What is given beside it goes first. So what a material is stands in one place, in the
 * language of scenes, and the engine knows neither cloths nor their plugins. */
#include "core/app/script/script.h"
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"

#include <string.h>

typedef struct names {
  size_t count;
  const char *at[256]; /* in the order of the alphabet; keys of the table, which holds them */
} names;

static const char *name_at(const void *context, size_t k) {
  const names *list = context;
  return k < list->count ? list->at[k] : NULL;
}

/* Whether the value on top of the stack is a table, which holds one under the name `of`; NULL: any. */
static bool is_table_with(lua_State *L, const char *of) {
  bool has = lua_istable(L, -1);
  if (!has || !of) return has;
  has = hk_lua_field(L, -1, of) == LUA_TTABLE;
  lua_pop(L, 1);
  return has;
}

/* The keys of the table on top of the stack that are names of tables, sorted; of those that hold one under `of`, unless
 * it is NULL. */
static void collect(lua_State *L, names *list, const char *of) {
  list->count = 0;
  for (lua_pushnil(L); list->count < 256 && lua_next(L, -2); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING || !is_table_with(L, of)) continue;
    const char *name = lua_tostring(L, -2);
    size_t k = list->count++;
    for (; k > 0 && strcmp(list->at[k - 1], name) > 0; k--) list->at[k] = list->at[k - 1];
    list->at[k] = name;
  }
}

/* Pushes "a, b, c". */
static const char *push_list(lua_State *L, const names *list) {
  luaL_Buffer text;
  luaL_buffinit(L, &text);
  for (size_t k = 0; k < list->count; k++) {
    if (k > 0) luaL_addstring(&text, ", ");
    luaL_addstring(&text, list->at[k]);
  }
  luaL_pushresult(&text);
  return lua_tostring(L, -1);
}

/* Pushes the table of the module. */
static void push_materials(lua_State *L, const char *what) {
  if (lua_getfield(L, LUA_REGISTRYINDEX, HK_LUA_REQUIRE) != LUA_TFUNCTION)
    hk_lua_fail(L, HK_SCRIPT, "%s: material: there are no modules here", what);
  lua_pushliteral(L, "material_numbers");
  lua_call(L, 1, 1);
  if (!lua_istable(L, -1))
    hk_lua_fail(L, HK_SCRIPT, "%s: material: the module 'material_numbers' gives no table", what);
}

/* Replaces the table on top of the stack by the table that it holds under `key`; false: it holds none. */
static bool descend(lua_State *L, const char *key) {
  bool found = hk_lua_field(L, -1, key) == LUA_TTABLE;
  if (found)
    lua_remove(L, -2);
  else
    lua_pop(L, 1);
  return found;
}

/* Replaces the module's table on top of the stack by that of the material. */
static void find_material(lua_State *L, const char *what, const char *name) {
  names list;
  if (descend(L, name)) return;
  collect(L, &list, what);
  if (list.count == 0) collect(L, &list, NULL);
  const char *near = hk_nearest_name(name, name_at, &list), *all = push_list(L, &list);
  if (near)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: material: there is no '%s'; did you mean '%s'? There are %s", what, name, near,
                all);
  hk_lua_fail(L, HK_BAD_PARAM, "%s: material: there is no '%s'; there are %s", what, name, all);
}

/* Replaces the material's table on top of the stack by its values for `what`. */
static void find_values(lua_State *L, const char *what, const char *name) {
  names list;
  if (descend(L, what)) return;
  collect(L, &list, NULL);
  hk_lua_fail(L, HK_BAD_PARAM, "%s: material: '%s' has nothing for it, but for %s", what, name, push_list(L, &list));
}

/* Copies the fields of the table at `from` to that on top of the stack where it has none; false: it has them all. */
static bool merge(lua_State *L, int from) {
  bool copied = false;
  for (lua_pushnil(L); lua_next(L, from); lua_pop(L, 1)) {
    lua_pushvalue(L, -2);
    if (lua_rawget(L, -4) == LUA_TNIL) {
      lua_pushvalue(L, -3);
      lua_pushvalue(L, -3);
      lua_rawset(L, -6);
      copied = true;
    }
    lua_pop(L, 1);
  }
  return copied;
}

void hk_lua_take_material(lua_State *L, hk_scene *scene, int table, const char *what) {
  int top = lua_gettop(L);
  if (hk_lua_field(L, table, "material") == LUA_TNIL) {
    lua_settop(L, top);
    return;
  }
  if (lua_type(L, -1) != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: material: expected a name, got a %s", what, luaL_typename(L, -1));
  const char *name = lua_tostring(L, -1);
  push_materials(L, what);
  find_material(L, what, name);
  find_values(L, what, name);
  int values = lua_gettop(L);
  lua_newtable(L);
  merge(L, table);
  if (!merge(L, values))
    hk_lua_warn(L, scene,
                "%s: material '%s' has no effect, since all of its numbers are given beside it: leave one or the other "
                "out",
                what, name);
  lua_pushnil(L);
  lua_setfield(L, -2, "material");
  lua_replace(L, table);
  lua_settop(L, top);
}
