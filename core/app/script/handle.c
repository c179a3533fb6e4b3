/* The handles that builders return: a range of ids and, for a grid, its shape. Lists of edges are made on request;
 * those of a mesh are kept with its handle. */
#include "core/app/script/script.h"

#include <stdlib.h>
#include <string.h>

static const char handle_type[] = "hooke.handle";

hk_lua_handle *hk_lua_to_handle(lua_State *L, int index) { return luaL_testudata(L, index, handle_type); }

hk_lua_handle *hk_lua_push_handle(lua_State *L, hk_lua_handle shape) {
  hk_lua_handle *h =
      lua_newuserdatauv(L, sizeof *h, HK_LUA_TETRAHEDRA); /* 1 to 3: a mesh's edges, triangles and flexion edges */
  *h = shape;
  luaL_setmetatable(L, handle_type);
  return h;
}

double *hk_lua_to_ids(lua_State *L, int index, size_t *count) {
  index = lua_absindex(L, index);
  const hk_lua_handle *h = hk_lua_to_handle(L, index);
  bool single = lua_type(L, index) == LUA_TNUMBER;
  if (!h && !single && !lua_istable(L, index)) return NULL;
  *count = h ? h->count : single ? 1 : lua_rawlen(L, index);
  double *ids = lua_newuserdatauv(L, (*count + 1) * sizeof *ids, 0);
  for (size_t k = 0; k < *count; k++) {
    if (h)
      ids[k] = h->first + (double)k;
    else if (single)
      ids[k] = lua_tonumber(L, index);
    else {
      bool number = lua_rawgeti(L, index, (lua_Integer)k + 1) == LUA_TNUMBER;
      ids[k] = lua_tonumber(L, -1);
      lua_pop(L, 1);
      if (!number) return NULL;
    }
  }
  return ids;
}

/* ---- edges of a grid or a chain ---- */

/* Writes the pairs (i, j)-(i + di, j + dj) row by row. */
static void offset_edges(const hk_lua_handle *h, int di, int dj, hk_lua_edges *into, size_t *at) {
  uint32_t i0 = di < 0 ? (uint32_t)-di : 0, i1 = h->nx - (di > 0 ? (uint32_t)di : 0);
  for (uint32_t j = 0; j + (uint32_t)dj < h->ny; j++)
    for (uint32_t i = i0; i < i1; i++, ++*at) {
      into->pair[*at][0] = h->first + j * h->nx + i;
      into->pair[*at][1] = h->first + (j + (uint32_t)dj) * h->nx + (uint32_t)((int)i + di);
    }
}

static size_t offset_count(const hk_lua_handle *h, int di, int dj) {
  size_t across = (size_t)abs(di), along = (size_t)dj;
  return h->nx > across && h->ny > along ? (h->nx - across) * (h->ny - along) : 0;
}

static int push_offsets(lua_State *L, const hk_lua_handle *h, int (*offset)[2], size_t count) {
  size_t total = 0, at = 0;
  for (size_t k = 0; k < count; k++) total += offset_count(h, offset[k][0], offset[k][1]);
  hk_lua_edges *edges = hk_lua_new_edges(L, total);
  for (size_t k = 0; k < count; k++)
    if (offset_count(h, offset[k][0], offset[k][1])) offset_edges(h, offset[k][0], offset[k][1], edges, &at);
  return 1;
}

static int structural_offsets[2][2] = {{1, 0}, {0, 1}};

int hk_lua_push_structural(lua_State *L, const hk_lua_handle *h) {
  return push_offsets(L, h, structural_offsets, h->grid ? 2 : 1);
}

/* ---- methods ---- */

static hk_lua_handle *self(lua_State *L) { return hk_lua_self(L, handle_type, "handle:at(1)"); }

/* Left out: 1. */
static lua_Integer place(lua_State *L, int index, const char *form) {
  return lua_isnoneornil(L, index) ? 1 : hk_lua_integer(L, index, form);
}

static int at(lua_State *L) {
  const hk_lua_handle *h = self(L);
  const char *form = h->nz > 0 ? "block:at(1, 1, 1)" : h->grid ? "grid:at(1, 1)" : "strand:at(1)";
  lua_Integer i = hk_lua_integer(L, 2, form), j = place(L, 3, form), k = place(L, 4, form);
  if (h->nz > 0 && (i < 1 || i > h->nx || j < 1 || j > h->ny || k < 1 || k > h->nz))
    return hk_lua_fail(L, HK_BAD_PARAM, "at(%lld, %lld, %lld) is outside the block of %d x %d x %d", (long long)i,
                       (long long)j, (long long)k, (int)h->nx, (int)h->ny, (int)h->nz);
  if (i < 1 || i > h->nx || j < 1 || j > h->ny) {
    if (h->grid || h->ny > 1)
      return hk_lua_fail(L, HK_BAD_PARAM, "at(%lld, %lld) is outside the %s of %d x %d", (long long)i, (long long)j,
                         h->grid ? "grid" : "strands", (int)h->nx, (int)h->ny);
    return hk_lua_fail(L, HK_BAD_PARAM, "at(%lld) is outside 1 to %d", (long long)i, (int)h->nx);
  }
  lua_pushinteger(L, h->first + ((k - 1) * h->ny * (h->nz > 0) + j - 1) * h->nx + (i - 1));
  return 1;
}

static int ids(lua_State *L) {
  const hk_lua_handle *h = self(L);
  lua_createtable(L, (int)h->count, 0);
  for (uint32_t k = 0; k < h->count; k++) {
    lua_pushinteger(L, h->first + k);
    lua_rawseti(L, -2, k + 1);
  }
  return 1;
}

static int structural(lua_State *L) {
  const hk_lua_handle *h = self(L);
  if (lua_getiuservalue(L, 1, 1) == LUA_TUSERDATA) return 1; /* a mesh's */
  if (h->grid || h->chain) return hk_lua_push_structural(L, h);
  return hk_lua_fail(L, HK_BAD_PARAM, "particles have no edges of their own: list them, { {1, 2}, {2, 3} }");
}

static int shear(lua_State *L) {
  int offset[2][2] = {{1, 1}, {-1, 1}};
  if (!self(L)->grid) return hk_lua_fail(L, HK_BAD_PARAM, "only a grid has shear edges");
  return push_offsets(L, self(L), offset, 2);
}

static int flexion(lua_State *L) {
  int offset[2][2] = {{2, 0}, {0, 2}};
  const hk_lua_handle *h = self(L);
  if (lua_getiuservalue(L, 1, 3) == LUA_TUSERDATA) return 1; /* a mesh's */
  if (!h->grid && !h->chain) return hk_lua_fail(L, HK_BAD_PARAM, "particles have no flexion edges");
  return push_offsets(L, h, offset, h->grid ? 2 : 1);
}

/* Pushes the numbers of the k-th of several chains: of a list, its element. */
static void push_numbers_of(lua_State *L, lua_Integer k, lua_Integer edges) {
  lua_newtable(L);
  if (lua_getiuservalue(L, 1, HK_LUA_NUMBERS) == LUA_TTABLE)
    for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
      const char *key = lua_tostring(L, -2);
      lua_pushvalue(L, -1);
      if (lua_istable(L, -1)) lua_rawgeti(L, -1, strcmp(key, "stiffness") == 0 ? (k - 1) * edges + 1 : k);
      lua_setfield(L, 3, key);
      lua_settop(L, 6);
    }
  lua_settop(L, 3);
}

/* The k-th of several chains. */
static int strand(lua_State *L) {
  const hk_lua_handle *h = self(L);
  lua_Integer k = hk_lua_integer(L, 2, "hair:strand(1)");
  lua_settop(L, 2);
  if (!h->chain) return hk_lua_fail(L, HK_BAD_PARAM, "only strands and hair have strands");
  if (k < 1 || k > h->ny)
    return hk_lua_fail(L, HK_BAD_PARAM, "strand(%lld) is outside 1 to %d", (long long)k, (int)h->ny);
  push_numbers_of(L, k, h->nx - 1);
  hk_lua_push_handle(L, (hk_lua_handle){.first = h->first + (uint32_t)(k - 1) * h->nx,
                                        .count = h->nx,
                                        .nx = h->nx,
                                        .ny = 1,
                                        .chain = true,
                                        .roots = h->roots});
  lua_insert(L, 3);
  lua_setiuservalue(L, 3, HK_LUA_NUMBERS);
  return 1;
}

static int roots(lua_State *L) {
  const hk_lua_handle *h = self(L);
  if (!h->chain) return hk_lua_fail(L, HK_BAD_PARAM, "only strands and hair have roots");
  lua_createtable(L, (int)(h->ny * h->roots), 0);
  for (uint32_t k = 0; k < h->ny * h->roots; k++) {
    lua_pushinteger(L, hk_lua_root(h, k));
    lua_rawseti(L, -2, k + 1);
  }
  return 1;
}

/* With the corners a, b below and c, d above, the cell is cut from a to d, or, every other one of an alternating grid,
 * from b to c. */
void hk_lua_grid_triangle(const hk_lua_handle *h, size_t k, uint32_t corner[3]) {
  size_t cell = k / 2, row = cell / (h->nx - 1), column = cell % (h->nx - 1);
  uint32_t a = h->first + (uint32_t)(row * h->nx + column), b = a + 1, c = a + h->nx, d = c + 1;
  bool other = h->alternating && (row + column) % 2 == 1, upper = k % 2 == 1;
  corner[0] = other && upper ? b : a;
  corner[1] = upper ? d : b;
  corner[2] = upper || other ? c : d;
}

static int triangles(lua_State *L) {
  const hk_lua_handle *h = self(L);
  if (lua_getiuservalue(L, 1, 2) == LUA_TTABLE) return 1;
  size_t count = h->grid ? 2 * (size_t)(h->nx - 1) * (h->ny - 1) : 0;
  lua_createtable(L, (int)count, 0);
  for (size_t t = 0; t < count; t++) {
    uint32_t corner[3];
    hk_lua_grid_triangle(h, t, corner);
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
      lua_pushinteger(L, corner[k]);
      lua_rawseti(L, -2, k + 1);
    }
    lua_rawseti(L, -2, (lua_Integer)t + 1);
  }
  return 1;
}

static int tetrahedra(lua_State *L) {
  self(L);
  if (lua_getiuservalue(L, 1, HK_LUA_TETRAHEDRA) == LUA_TTABLE) return 1;
  return hk_lua_fail(L, HK_BAD_PARAM, "only what scene:block and scene:tetrahedra made has tetrahedra");
}

/* The ids of a solid's particles that are in none of the triangles of its skin. */
static int inside(lua_State *L) {
  const hk_lua_handle *h = self(L);
  lua_settop(L, 1);
  if (lua_getiuservalue(L, 1, HK_LUA_TETRAHEDRA) != LUA_TTABLE || lua_getiuservalue(L, 1, 2) != LUA_TTABLE)
    return hk_lua_fail(L, HK_BAD_PARAM, "only what scene:block and scene:tetrahedra made has an inside");
  char *outer = lua_newuserdatauv(L, h->count, 0);
  memset(outer, 0, h->count);
  for (lua_Integer t = 1; lua_rawgeti(L, 3, t) == LUA_TTABLE; t++, lua_pop(L, 1))
    for (int c = 1; c <= 3; c++, lua_pop(L, 1)) {
      lua_rawgeti(L, 5, c);
      lua_Integer k = lua_tointeger(L, -1) - h->first;
      if (k >= 0 && k < h->count) outer[k] = 1;
    }
  lua_newtable(L);
  for (uint32_t k = 0, found = 0; k < h->count; k++) {
    if (outer[k]) continue;
    lua_pushinteger(L, (lua_Integer)h->first + k);
    lua_rawseti(L, -2, ++found);
  }
  return 1;
}

static const luaL_Reg methods[] = {{"at", at},
                                   {"ids", ids},
                                   {"edges", structural},
                                   {"structural", structural},
                                   {"shear", shear},
                                   {"flexion", flexion},
                                   {"triangles", triangles},
                                   {"strand", strand},
                                   {"roots", roots},
                                   {"tetrahedra", tetrahedra},
                                   {"inside", inside},
                                   {NULL, NULL}};

static int missing(lua_State *L) {
  return hk_lua_no_member(
      L, "a handle", hk_lua_method_name, methods,
      "its particles are :at(i, j) and :ids(); strands and hair have length and segment, with radius "
      "and E also EA, EI, EI2, stiffness, with nu GJ; solids with E have stiffness");
}

static int count(lua_State *L) {
  lua_pushinteger(L, self(L)->count);
  return 1;
}

/* Methods, the upvalue, come first; then the numbers that the builder left. */
static int member(lua_State *L) {
  self(L);
  lua_settop(L, 2);
  lua_pushvalue(L, 2);
  if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL) return 1;
  if (lua_getiuservalue(L, 1, HK_LUA_NUMBERS) != LUA_TTABLE) return missing(L);
  lua_pushvalue(L, 2);
  return lua_rawget(L, -2) != LUA_TNIL ? 1 : missing(L);
}

void hk_lua_open_handles(lua_State *L) {
  luaL_newmetatable(L, handle_type);
  lua_newtable(L);
  luaL_setfuncs(L, methods, 0);
  lua_pushcclosure(L, member, 1);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, count);
  lua_setfield(L, -2, "__len");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
}
