/* Edges in Lua: a userdata block of pairs of ids, so that a million edges cost eight megabytes and no tables. #edges is
 * the number of edges, edges[k] gives {i, j}, and a .. b concatenates; functions that take edges accept tables of pairs
 * and of blocks as well. */
#include "core/app/script/script.h"

#include <string.h>

static const char type_name[] = "hooke.edges";
enum { DEEPEST = 16, VISIT = 8 }; /* depth of nested lists; instructions that looking at a member costs, about */

hk_lua_edges *hk_lua_new_edges(lua_State *L, size_t count) {
  hk_lua_edges *e = lua_newuserdatauv(L, sizeof *e + count * sizeof e->pair[0], 0);
  e->count = count;
  luaL_setmetatable(L, type_name);
  return e;
}

static uint32_t id_at(lua_State *L, int table, int k, size_t edge) {
  lua_rawgeti(L, table, k);
  double id = lua_isnumber(L, -1) ? lua_tonumber(L, -1) : -1;
  lua_pop(L, 1);
  if (!(id >= 0 && id <= UINT32_MAX && floor(id) == id))
    hk_lua_fail(L, HK_BAD_PARAM, "edge %d is not a pair of particle ids", (int)edge);
  return (uint32_t)id;
}

static bool is_pair(lua_State *L, int index) {
  if (!lua_istable(L, index) || lua_rawlen(L, index) != 2) return false;
  bool numbers = lua_rawgeti(L, index, 1) == LUA_TNUMBER;
  numbers = lua_rawgeti(L, index, 2) == LUA_TNUMBER && numbers;
  lua_pop(L, 2);
  return numbers;
}

/* Counts the edges in a table of pairs and blocks; false: the table has a member of another kind, or contains
 * itself. */
static bool count_edges(lua_State *L, int table, int depth, size_t *count) {
  *count = 0;
  for (lua_Integer k = 1;; k++) {
    hk_limits_count(L, VISIT);
    if (lua_rawgeti(L, table, k) == LUA_TNIL) {
      lua_pop(L, 1);
      return true;
    }
    const hk_lua_edges *block = luaL_testudata(L, -1, type_name);
    bool pair = is_pair(L, lua_gettop(L));
    size_t inner = 0;
    bool nested =
        !block && !pair && lua_istable(L, -1) && depth < DEEPEST && count_edges(L, lua_gettop(L), depth + 1, &inner);
    lua_pop(L, 1);
    if (!block && !pair && !nested) return false;
    *count += block ? block->count : pair ? 1 : inner;
  }
}

static void fill(lua_State *L, int table, hk_lua_edges *into, size_t *at) {
  for (lua_Integer k = 1; lua_rawgeti(L, table, k) != LUA_TNIL; k++, lua_pop(L, 1)) {
    int member = lua_gettop(L);
    const hk_lua_edges *block = luaL_testudata(L, member, type_name);
    if (block) {
      memcpy(into->pair + *at, block->pair, block->count * sizeof block->pair[0]);
      *at += block->count;
    } else if (is_pair(L, member)) {
      for (int c = 0; c < 2; c++) into->pair[*at][c] = id_at(L, member, c + 1, *at + 1);
      ++*at;
    } else
      fill(L, member, into, at);
  }
  lua_pop(L, 1);
}

hk_lua_edges *hk_lua_to_edges(lua_State *L, int index) {
  index = lua_absindex(L, index);
  hk_lua_edges *block = luaL_testudata(L, index, type_name);
  size_t count, at = 0;
  if (block) {
    lua_pushvalue(L, index);
    return block;
  }
  luaL_checkstack(L, 4 * DEEPEST, "lists of edges");
  if (!lua_istable(L, index) || !count_edges(L, index, 0, &count)) return NULL;
  hk_lua_edges *made = hk_lua_new_edges(L, count);
  fill(L, index, made, &at);
  return made;
}

static int length(lua_State *L) {
  const hk_lua_edges *e = luaL_checkudata(L, 1, type_name);
  lua_pushinteger(L, (lua_Integer)e->count);
  return 1;
}

static int element(lua_State *L) {
  const hk_lua_edges *e = luaL_checkudata(L, 1, type_name);
  lua_Integer k = luaL_checkinteger(L, 2);
  if (k < 1 || (size_t)k > e->count) return 0;
  lua_createtable(L, 2, 0);
  for (int c = 0; c < 2; c++) {
    lua_pushinteger(L, e->pair[k - 1][c]);
    lua_rawseti(L, -2, c + 1);
  }
  return 1;
}

static int join(lua_State *L) {
  lua_settop(L, 2);
  const hk_lua_edges *a = hk_lua_to_edges(L, 1), *b = hk_lua_to_edges(L, 2);
  if (!a || !b) return hk_lua_fail(L, HK_BAD_PARAM, "only lists of edges can be joined to edges");
  hk_lua_edges *both = hk_lua_new_edges(L, a->count + b->count);
  memcpy(both->pair, a->pair, a->count * sizeof a->pair[0]);
  memcpy(both->pair + a->count, b->pair, b->count * sizeof b->pair[0]);
  return 1;
}

void hk_lua_open_edges(lua_State *L) {
  static const luaL_Reg methods[] = {
      {"__len", length}, {"__index", element}, {"__concat", join}, {"__add", join}, {NULL, NULL}};
  luaL_newmetatable(L, type_name);
  luaL_setfuncs(L, methods, 0);
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
}
