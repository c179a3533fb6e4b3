/* page: what `hooke view` needs beside Lua: numbers of particles in few bytes (view/motion_code.h), indices and bytes
 * as packed text, the largest and least of packed numbers, and what pictures and pages share. Packed numbers are
 * strings of doubles, packed indices strings of uint32, in the machine's order, which is little endian. */
#include "plugins/common/colour/palette.h"
#include "plugins/common/colour/range.h"
#include "plugins/common/frame_data/frame_data.h"
#include "plugins/common/frame_data/radii.h"
#include "tools/native/view/motion_code.h"
#include "tools/native/view/packed_text.h"

#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char encoder_type[] = "hooke.page.encoder";

static int push_packed(lua_State *L, const void *byte, size_t bytes) {
  size_t length;
  char *text = hk_packed_text(byte, bytes, &length);
  if (!text) return luaL_error(L, "no memory for a page's data");
  lua_pushlstring(L, text, length); /* an error here loses the text: the process is at its end without memory */
  free(text);
  return 1;
}

/* ---- encoder ---- */

/* encoder(low, step): low, a table of one number a component. */
static int make_encoder(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  size_t components = lua_rawlen(L, 1);
  double step = luaL_checknumber(L, 2);
  luaL_argcheck(L, components >= 1 && components <= HK_MOTION_COMPONENTS, 1, "1 to 9 components");
  hk_motion_code *m = lua_newuserdatauv(L, sizeof *m, 0);
  *m = (hk_motion_code){.components = components, .step = step};
  luaL_setmetatable(L, encoder_type);
  for (size_t c = 0; c < components; c++) {
    lua_rawgeti(L, 1, (lua_Integer)c + 1);
    m->low[c] = luaL_checknumber(L, -1);
    lua_pop(L, 1);
  }
  return 1;
}

/* encoder:add(numbers [, ids]): the next frame. */
static int add(lua_State *L) {
  hk_motion_code *m = luaL_checkudata(L, 1, encoder_type);
  size_t bytes, of_ids = 0;
  const char *number = luaL_checklstring(L, 2, &bytes), *id = luaL_optlstring(L, 3, NULL, &of_ids);
  size_t n = bytes / (m->components * sizeof(double));
  luaL_argcheck(L, bytes == n * m->components * sizeof(double), 2, "not so many components");
  luaL_argcheck(L, !id || of_ids == n * sizeof(uint32_t), 3, "not one id for each particle");
  if (!hk_motion_code_add(m, n, number, id)) return luaL_error(L, "no memory for a frame of %d particles", (int)n);
  return 0;
}

/* encoder:block() -> the frames since the last one as packed text; the next frame is a key frame. */
static int block(lua_State *L) {
  hk_motion_code *m = luaL_checkudata(L, 1, encoder_type);
  push_packed(L, m->byte ? m->byte : (unsigned char *)"", m->bytes);
  hk_motion_code_begin_block(m);
  return 1;
}

/* encoder:error() -> the largest distance between what was given and what will be read. */
static int error_of(lua_State *L) {
  const hk_motion_code *m = luaL_checkudata(L, 1, encoder_type);
  lua_pushnumber(L, m->error);
  return 1;
}

static int free_encoder(lua_State *L) {
  hk_motion_code_free(luaL_checkudata(L, 1, encoder_type));
  return 0;
}

/* ---- strings ---- */

static double number_at(const char *text, size_t k) {
  double value;
  memcpy(&value, text + k * sizeof value, sizeof value);
  return value;
}

static uint32_t id_at(const char *text, size_t k) {
  uint32_t value;
  memcpy(&value, text + k * sizeof value, sizeof value);
  return value;
}

/* range(numbers, components) -> {least ...}, {largest ...} of those that are finite; inf, -inf: there is none. */
static int range(lua_State *L) {
  size_t bytes;
  const char *at = luaL_checklstring(L, 1, &bytes);
  lua_Integer components = luaL_checkinteger(L, 2);
  luaL_argcheck(L, components >= 1 && components <= HK_MOTION_COMPONENTS, 2, "1 to 9 components");
  double low[HK_MOTION_COMPONENTS], high[HK_MOTION_COMPONENTS];
  for (int c = 0; c < components; c++) low[c] = INFINITY, high[c] = -INFINITY;
  for (size_t k = 0; k < bytes / sizeof(double); k++) {
    double value = number_at(at, k);
    if (!isfinite(value)) continue;
    int c = (int)(k % (size_t)components);
    low[c] = fmin(low[c], value);
    high[c] = fmax(high[c], value);
  }
  for (int list = 0; list < 2; list++) {
    lua_createtable(L, (int)components, 0);
    for (int c = 0; c < components; c++) {
      lua_pushnumber(L, list ? high[c] : low[c]);
      lua_rawseti(L, -2, c + 1);
    }
  }
  return 2;
}

/* sizes(numbers, components, every) -> {the number, or of a vector the length, of every so manieth particle}, of those
 * that are finite. */
static int sizes(lua_State *L) {
  size_t bytes;
  const char *at = luaL_checklstring(L, 1, &bytes);
  lua_Integer components = luaL_checkinteger(L, 2), every = luaL_checkinteger(L, 3), found = 0;
  luaL_argcheck(L, components >= 1, 2, "no components");
  luaL_argcheck(L, every >= 1, 3, "not a whole number above 0");
  size_t width = (size_t)components, n = bytes / sizeof(double) / width;
  lua_newtable(L);
  for (size_t i = 0; i < n; i += (size_t)every) {
    double square = 0, value = number_at(at, i * width);
    for (size_t c = 0; c < width; c++) square += number_at(at, i * width + c) * number_at(at, i * width + c);
    if (width > 1) value = sqrt(square);
    if (!isfinite(value)) continue;
    lua_pushnumber(L, value);
    lua_rawseti(L, -2, ++found);
  }
  return 1;
}

/* distance(positions, ids, positions, ids) -> m, RMS and largest distance of particles of the same id; NAN: there is
 * none. Both lists of ids rise. */
static int distance(lua_State *L) {
  size_t bytes[4];
  const char *text[4];
  for (int k = 0; k < 4; k++) text[k] = luaL_checklstring(L, k + 1, &bytes[k]);
  size_t n = bytes[1] / sizeof(uint32_t), m = bytes[3] / sizeof(uint32_t), pairs = 0;
  luaL_argcheck(L, bytes[0] == 3 * n * sizeof(double), 1, "not a position for each id");
  luaL_argcheck(L, bytes[2] == 3 * m * sizeof(double), 3, "not a position for each id");
  double sum = 0, most = 0;
  for (size_t i = 0, k = 0; i < n; i++) {
    uint32_t id = id_at(text[1], i);
    while (k < m && id_at(text[3], k) < id) k++;
    if (k == m || id_at(text[3], k) != id) continue;
    double square = 0;
    for (size_t c = 0; c < 3; c++) {
      double d = number_at(text[0], 3 * i + c) - number_at(text[2], 3 * k + c);
      square += d * d;
    }
    sum += square;
    most = fmax(most, sqrt(square));
    pairs++;
  }
  lua_pushnumber(L, pairs ? sqrt(sum / (double)pairs) : NAN);
  lua_pushnumber(L, pairs ? most : NAN);
  return 2;
}

/* indices(packed) -> packed text: each is the difference to the one before, modulo 2^32; all first bytes, then all
 * second ones ... */
static int indices(lua_State *L) {
  size_t bytes;
  const char *at = luaL_checklstring(L, 1, &bytes);
  size_t count = bytes / sizeof(uint32_t);
  unsigned char *plane = lua_newuserdatauv(L, 4 * count + 1, 0);
  uint32_t last = 0;
  for (size_t k = 0; k < count; k++) {
    uint32_t value = id_at(at, k);
    for (int b = 0; b < 4; b++) plane[(size_t)b * count + k] = (unsigned char)((value - last) >> 8 * b);
    last = value;
  }
  return push_packed(L, plane, 4 * count);
}

/* ---- what pictures and pages share ---- */

/* colours_of(numbers, map) -> the least and the largest number that the colours of a motion stand for, as pictures
 * choose them (plugins/common/colour/range.h). */
static int colours_of(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  size_t count = lua_rawlen(L, 1);
  float *number = lua_newuserdatauv(L, (count + 1) * sizeof *number, 0);
  hk_scale scale = {0};
  for (size_t k = 0; k < count; k++, lua_pop(L, 1)) {
    lua_rawgeti(L, 1, (lua_Integer)k + 1);
    number[k] = (float)lua_tonumber(L, -1);
  }
  hk_range_choose(&scale, number, count, strcmp(luaL_checkstring(L, 2), hk_map_names[HK_MAP_DIVERGING]) == 0);
  lua_pushnumber(L, scale.low);
  lua_pushnumber(L, scale.high);
  return 2;
}

/* Packed text of the 512 colours of each map that a field has, red, green, blue, 255 each. */
static void push_maps(lua_State *L) {
  uint8_t table[HK_MAP_SIZE][4];
  lua_newtable(L);
  for (int k = 0; k < HK_FIELD_KINDS; k++) {
    hk_colormap_fill(hk_field_kinds[k].map, 0, table);
    push_packed(L, table, sizeof table);
    lua_setfield(L, -2, hk_map_names[hk_field_kinds[k].map]);
  }
}

static void push_things(lua_State *L) {
  lua_newtable(L);
  for (int k = 0; k < HK_PALETTE_SIZE; k++) {
    lua_createtable(L, 3, 0);
    for (int c = 0; c < 3; c++) {
      lua_pushinteger(L, hk_palette_colours[k][c]);
      lua_rawseti(L, -2, c + 1);
    }
    lua_setfield(L, -2, hk_palette_names[k]);
  }
}

/* The colours of groups, in turn. */
static void push_group_colours(lua_State *L) {
  lua_createtable(L, HK_GROUP_COLOURS, 0);
  for (uint32_t k = 0; k < HK_GROUP_COLOURS; k++) {
    uint8_t colour[4];
    hk_colormap_group(k, colour);
    lua_createtable(L, 3, 0);
    for (int c = 0; c < 3; c++) {
      lua_pushinteger(L, colour[c]);
      lua_rawseti(L, -2, c + 1);
    }
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

static void push_solids(lua_State *L) {
  lua_newtable(L);
  for (int k = 0; k <= HK_SHAPE_MESH; k++) {
    lua_pushstring(L, hk_solid_names[k]);
    lua_rawseti(L, -2, k + 1);
  }
}

static void push_list(lua_State *L, const double *value, int count, const char *name) {
  lua_createtable(L, count, 0);
  for (int k = 0; k < count; k++) {
    lua_pushnumber(L, value[k]);
    lua_rawseti(L, -2, k + 1);
  }
  lua_setfield(L, -2, name);
}

static void push_radii(lua_State *L) {
  const hk_drawn_radii *r = &hk_drawn;
  const double one[] = {r->on_tubes, r->loose, r->least, r->largest, r->pin, r->pin_on_tubes};
  static const char *const names[] = {"on_tubes", "loose", "least", "largest", "pin", "pin_on_tubes"};
  lua_newtable(L);
  push_list(L, r->tube, HK_TUBE_CLASSES, "tube");
  push_list(L, r->most, HK_TUBE_CLASSES - 1, "most");
  for (int k = 0; k < 6; k++) {
    lua_pushnumber(L, one[k]);
    lua_setfield(L, -2, names[k]);
  }
}

static void push_field_kinds(lua_State *L) {
  lua_newtable(L);
  for (int k = 0; k < HK_FIELD_KINDS; k++) {
    const hk_field_kind *kind = &hk_field_kinds[k];
    lua_createtable(L, 0, 3);
    lua_pushstring(L, kind->unit);
    lua_setfield(L, -2, "unit");
    lua_pushstring(L, kind->painted);
    lua_setfield(L, -2, "painted");
    lua_pushstring(L, hk_map_names[kind->map]);
    lua_setfield(L, -2, "map");
    lua_setfield(L, -2, kind->name);
  }
}

/* shared() -> maps { name = packed text }, things { name = { red, green, blue } }, groups { colours }, solids { names
 * of the kinds }, radii (frame_data/radii.h), fields { kind = { unit =, painted =, map = } } */
static int shared(lua_State *L) {
  lua_createtable(L, 0, 6);
  push_maps(L);
  lua_setfield(L, -2, "maps");
  push_things(L);
  lua_setfield(L, -2, "things");
  push_group_colours(L);
  lua_setfield(L, -2, "groups");
  push_solids(L);
  lua_setfield(L, -2, "solids");
  push_radii(L);
  lua_setfield(L, -2, "radii");
  push_field_kinds(L);
  lua_setfield(L, -2, "fields");
  return 1;
}

__attribute__((visibility("default"))) int luaopen_page(lua_State *L);

int luaopen_page(lua_State *L) {
  static const luaL_Reg functions[] = {{"encoder", make_encoder}, {"range", range},     {"sizes", sizes},
                                       {"distance", distance},    {"indices", indices}, {"colours_of", colours_of},
                                       {"shared", shared},        {NULL, NULL}};
  static const luaL_Reg methods[] = {{"add", add}, {"block", block}, {"error", error_of}, {NULL, NULL}};
  luaL_newmetatable(L, encoder_type);
  luaL_newlib(L, methods);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, free_encoder);
  lua_setfield(L, -2, "__gc");
  lua_pop(L, 1);
  luaL_newlib(L, functions);
  return 1;
}
