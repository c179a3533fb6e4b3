/* recording: the motion that the output `trajectory` has written, for tools. Frames are counted from 1; numbers of
 * particles are strings of doubles, indices strings of uint32_t, in the machine's order (little endian wherever hooke
 * runs): string.unpack("<d", text, 8 * k + 1). */
#include "plugins/common/frame_data/gatherer.h"
#include "plugins/common/recording/reader.h"
#include "plugins/common/recording/recorded_frame.h"

#include <lauxlib.h>
#include <lua.h>
#include <string.h>

static const char type_name[] = "hooke.recording";

static hk_recording *at(lua_State *L) {
  hk_recording **r = luaL_checkudata(L, 1, type_name);
  luaL_argcheck(L, *r, 1, "the recording is closed");
  return *r;
}

/* The frame that argument `index` names, from 0. */
static size_t frame_at(lua_State *L, const hk_recording *r, int index) {
  lua_Integer k = luaL_checkinteger(L, index);
  luaL_argcheck(L, k >= 1 && (size_t)k <= r->frames, index, "there is no such frame");
  return (size_t)k - 1;
}

static void push_list(lua_State *L, const double *value, size_t count) {
  lua_createtable(L, (int)count, 0);
  for (size_t k = 0; k < count; k++) {
    lua_pushnumber(L, value[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

/* The string on top of the stack's buffer, or an error where the file could not be read. */
static int finish(lua_State *L, luaL_Buffer *b, size_t bytes, bool fine, size_t k) {
  if (!fine) return luaL_error(L, "frame %d cannot be read: the file is damaged", (int)k + 1);
  luaL_pushresultsize(b, bytes);
  return 1;
}

static int moving(lua_State *L, const hk_recording *r, hid_t set, size_t k, size_t width) {
  luaL_Buffer b;
  size_t bytes = (size_t)hk_recorded_part_of(r, k)->n * width * sizeof(double);
  double *to = (double *)(void *)luaL_buffinitsize(L, &b, bytes + 8);
  return finish(L, &b, bytes, hk_recording_moving(r, set, k, width, to), k);
}

static int fixed(lua_State *L, hid_t set, hid_t type, size_t item) {
  const hk_recording *r = at(L);
  luaL_Buffer b;
  size_t k = frame_at(L, r, 2), bytes = (size_t)hk_recorded_part_of(r, k)->n * item;
  void *to = luaL_buffinitsize(L, &b, bytes + 8);
  return finish(L, &b, bytes, hk_recording_fixed(r, set, k, type, to), k);
}

/* positions(k), velocities(k): n x 3 doubles. strain(k): n doubles, of each particle; nil where there are no elements.
 */
static int positions(lua_State *L) {
  const hk_recording *r = at(L);
  return moving(L, r, r->points, frame_at(L, r, 2), 3);
}

static int velocities(lua_State *L) {
  const hk_recording *r = at(L);
  return moving(L, r, r->velocity, frame_at(L, r, 2), 3);
}

static int strain(lua_State *L) {
  const hk_recording *r = at(L);
  size_t k = frame_at(L, r, 2);
  return r->strain < 0 ? 0 : moving(L, r, r->strain, k, 1);
}

/* ids(k): n uint32_t. masses(k): n doubles. pins(k): n bytes (core/plugin/model.h, hk_pin). */
static int ids(lua_State *L) { return fixed(L, at(L)->id, H5T_NATIVE_UINT32, sizeof(uint32_t)); }
static int masses(lua_State *L) { return fixed(L, at(L)->mass, H5T_NATIVE_DOUBLE, sizeof(double)); }
static int pins(lua_State *L) { return fixed(L, at(L)->pin, H5T_NATIVE_UINT8, 1); }

/* groups_and_radii(k) -> n uint32_t, of each particle its place in `groups`, from 0, or nil where there is one group; n
 * doubles, m, the radii of strands, 0 of what is of none, or nil. */
static int groups_and_radii(lua_State *L) {
  const hk_recording *r = at(L);
  luaL_Buffer b;
  size_t k = frame_at(L, r, 2), bytes = (size_t)hk_recorded_part_of(r, k)->n * sizeof(uint32_t);
  lua_settop(L, 2);
  void *to = r->group < 0 ? lua_pushnil(L), NULL : luaL_buffinitsize(L, &b, bytes + 8);
  if (to) finish(L, &b, bytes, hk_recording_groups(r, k, to), k);
  return 1 + (r->strand_radius < 0 ? 0 : fixed(L, r->strand_radius, H5T_NATIVE_DOUBLE, sizeof(double)));
}

/* edges(k): 2 uint32_t for each, indices of particles from 0. triangles(k): 3 for each. */
static int edges(lua_State *L) {
  const hk_recording *r = at(L);
  luaL_Buffer b;
  size_t k = frame_at(L, r, 2), bytes = 2 * (size_t)hk_recorded_part_of(r, k)->segments * sizeof(uint32_t);
  void *to = luaL_buffinitsize(L, &b, bytes + 8);
  return finish(L, &b, bytes, hk_recording_segments(r, k, to), k);
}

static int triangles(lua_State *L) {
  const hk_recording *r = at(L);
  luaL_Buffer b;
  size_t k = frame_at(L, r, 2), bytes = 3 * (size_t)hk_recorded_part_of(r, k)->triangles * sizeof(uint32_t);
  void *to = luaL_buffinitsize(L, &b, bytes + 8);
  return finish(L, &b, bytes, hk_recording_triangles(r, k, to), k);
}

static int strain_of_cells(lua_State *L, const hk_recording *r, size_t k, size_t first, size_t count) {
  luaL_Buffer b;
  if (r->cell_strain < 0) return 0;
  double *to = (double *)(void *)luaL_buffinitsize(L, &b, count * sizeof *to + 8);
  return finish(L, &b, count * sizeof *to, hk_recording_cell_strain(r, k, first, count, to), k);
}

/* edge_strain(k), triangle_strain(k): a double for each, NaN where none is known; nil where there are no elements. */
static int edge_strain(lua_State *L) {
  const hk_recording *r = at(L);
  size_t k = frame_at(L, r, 2);
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  return strain_of_cells(L, r, k, (size_t)p->vertices, (size_t)p->segments);
}

static int triangle_strain(lua_State *L) {
  const hk_recording *r = at(L);
  size_t k = frame_at(L, r, 2);
  const hk_recorded_part *p = hk_recorded_part_of(r, k);
  return strain_of_cells(L, r, k, (size_t)(p->vertices + p->segments), (size_t)p->triangles);
}

static int array(lua_State *L, bool force) {
  const hk_recording *r = at(L);
  const char *name = luaL_checkstring(L, 2);
  size_t k = frame_at(L, r, 3);
  for (size_t a = 0; a < r->arrays; a++)
    if (r->array[a].force == force && strcmp(r->array[a].name, name) == 0)
      return moving(L, r, r->array[a].set, k, r->array[a].width);
  return luaL_argerror(L, 2, force ? "the recording has no such force" : "the recording has no such channel");
}

/* channel(name, k): n x size doubles. force(name, k): n x 3 doubles, N. */
static int channel(lua_State *L) { return array(L, false); }
static int force(lua_State *L) { return array(L, true); }

/* field(j, k): the numbers of `fields[j]`. */
static int field_of(lua_State *L) {
  const hk_recording *r = at(L);
  lua_Integer j = luaL_checkinteger(L, 2), own = r->strain >= 0 ? 2 : 1;
  size_t k = frame_at(L, r, 3);
  luaL_argcheck(L, j >= 1 && j <= own + (lua_Integer)r->arrays, 2, "there is no such field");
  if (j <= own) return moving(L, r, j == 1 ? r->velocity : r->strain, k, j == 1 ? 3 : 1);
  return moving(L, r, r->array[j - own - 1].set, k, r->array[j - own - 1].width);
}

/* n(k): number of particles. topology_changed(k): whether ids, masses, pins, edges or triangles are others than in the
 * frame before; true for the first. */
static int number(lua_State *L) {
  const hk_recording *r = at(L);
  lua_pushinteger(L, hk_recorded_part_of(r, frame_at(L, r, 2))->n);
  return 1;
}

static int topology_changed(lua_State *L) {
  const hk_recording *r = at(L);
  lua_pushboolean(L, r->frame[frame_at(L, r, 2)].changed);
  return 1;
}

/* solid_places(k): 12 doubles for each of `solids`: the centre, then three axes from there to the surface. */
static int solid_places(lua_State *L) {
  const hk_recording *r = at(L);
  luaL_Buffer b;
  size_t k = frame_at(L, r, 2), bytes = r->solids.count * HK_SOLID_NUMBERS * sizeof(double);
  double *to = (double *)(void *)luaL_buffinitsize(L, &b, bytes + 8);
  return finish(L, &b, bytes, hk_recorded_solids_place(&r->solids, k, to), k);
}

/* marks_of(j, k) -> places, vectors: 3 doubles for each mark of list j in frame k; of how many they are a part. */
static int marks_of(lua_State *L) {
  const hk_recording *r = at(L);
  lua_Integer j = luaL_checkinteger(L, 2);
  luaL_argcheck(L, j >= 1 && (size_t)j <= r->marks.count, 2, "there is no such list");
  size_t k = frame_at(L, r, 3);
  const hk_recorded_marks *m = &r->marks.list[j - 1];
  size_t count = (size_t)m->rows[k][1];
  double *all = lua_newuserdatauv(L, (count * HK_MARK_NUMBERS + 1) * sizeof *all, 0);
  if (!hk_recorded_marks_get(m, k, all))
    return luaL_error(L, "frame %d cannot be read: the file is damaged", (int)k + 1);
  for (size_t half = 0; half < HK_MARK_NUMBERS; half += 3) {
    luaL_Buffer b;
    double *to = (double *)(void *)luaL_buffinitsize(L, &b, 3 * count * sizeof *to + 8);
    for (size_t i = 0; i < count; i++) memcpy(to + 3 * i, all + HK_MARK_NUMBERS * i + half, 3 * sizeof *to);
    luaL_pushresultsize(&b, 3 * count * sizeof *to);
  }
  lua_pushinteger(L, m->rows[k][2]);
  return 3;
}

static int close_recording(lua_State *L) {
  hk_recording **r = luaL_checkudata(L, 1, type_name);
  hk_recording_close(*r);
  *r = NULL;
  return 0;
}

/* ---- the fields: made when the recording is opened, kept in the user value ---- */

static void push_channels(lua_State *L, const hk_recording *r) {
  lua_newtable(L);
  lua_newtable(L);
  for (size_t a = 0; a < r->arrays; a++) {
    int list = r->array[a].force ? -1 : -2;
    if (r->array[a].force) {
      lua_pushstring(L, r->array[a].name);
    } else {
      lua_createtable(L, 0, 2);
      lua_pushstring(L, r->array[a].name);
      lua_setfield(L, -2, "name");
      lua_pushinteger(L, (lua_Integer)r->array[a].width);
      lua_setfield(L, -2, "size");
    }
    lua_rawseti(L, list - 1, (lua_Integer)lua_rawlen(L, list - 1) + 1);
  }
}

static void set_text(lua_State *L, const char *key, const char *text) {
  lua_pushstring(L, text);
  lua_setfield(L, -2, key);
}

/* What frames have numbers of, as hk_frame_field_at tells: {kind =, name =, components =}. */
static bool push_frame_fields(lua_State *L, const hk_recording *r) {
  hk_gatherer frame;
  hk_frame_field field;
  double some;
  if (!hk_recording_frame_open(r, &frame)) return false;
  frame.data.strain = r->strain >= 0 ? &some : NULL;
  lua_newtable(L);
  for (size_t k = 0; hk_frame_field_at(&frame.data, k, &field); k++) {
    lua_createtable(L, 0, 3);
    set_text(L, "kind", hk_field_kinds[field.kind].name);
    set_text(L, "name", field.name);
    lua_pushinteger(L, (lua_Integer)field.components);
    lua_setfield(L, -2, "components");
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  frame.data.strain = NULL;
  hk_gatherer_free(&frame);
  return true;
}

static void push_attributes(lua_State *L, const hk_recording *r) {
  lua_newtable(L);
  set_text(L, "scene", r->scene);
  set_text(L, "origin", r->origin);
  set_text(L, "verdict", r->verdict);
  lua_pushinteger(L, r->every);
  lua_setfield(L, -2, "every");
}

static void push_solid(lua_State *L, const hk_frame_solid *s) {
  lua_createtable(L, 0, 5);
  set_text(L, "kind", hk_solid_names[s->kind]);
  lua_pushboolean(L, s->hollow);
  lua_setfield(L, -2, "hollow");
  lua_pushinteger(L, s->group);
  lua_setfield(L, -2, "group");
  lua_pushboolean(L, s->body);
  lua_setfield(L, -2, "body");
  lua_pushlstring(L, s->vertices ? (const char *)s->vertex : "", s->vertices * 3 * sizeof *s->vertex);
  lua_setfield(L, -2, "vertices");
  lua_pushlstring(L, s->faces ? (const char *)s->face : "", s->faces * sizeof *s->face);
  lua_setfield(L, -2, "faces");
}

static void push_solids(lua_State *L, const hk_recorded_solids *s) {
  lua_createtable(L, (int)s->count, 0);
  for (size_t k = 0; k < s->count; k++) {
    push_solid(L, &s->solid[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

/* The names of the groups; empty where there is one. */
static void push_groups(lua_State *L, const char *names) {
  lua_newtable(L);
  for (const char *end; (end = strchr(names, '\n')); names = end + 1) {
    lua_pushlstring(L, names, (size_t)(end - names));
    lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
  }
}

static void push_marks(lua_State *L, const hk_recorded_mark_lists *m) {
  lua_createtable(L, (int)m->count, 0);
  for (size_t k = 0; k < m->count; k++) {
    lua_createtable(L, 0, 2);
    set_text(L, "name", m->list[k].name);
    set_text(L, "kind", hk_mark_kind(m->list[k].contact));
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

static void push_fields(lua_State *L, const hk_recording *r) {
  lua_newtable(L);
  lua_pushinteger(L, (lua_Integer)r->frames);
  lua_setfield(L, -2, "frames");
  lua_pushnumber(L, r->fps / (double)(r->every > 0 ? r->every : 1));
  lua_setfield(L, -2, "fps");
  push_list(L, r->time, r->frames);
  lua_setfield(L, -2, "times");
  if (push_frame_fields(L, r)) lua_setfield(L, -2, "fields");
  push_channels(L, r);
  lua_setfield(L, -3, "forces");
  lua_setfield(L, -2, "channels");
  lua_newtable(L);
  lua_newtable(L); /* units */
  for (size_t k = 0; k < r->series; k++) {
    push_list(L, r->serie[k].value, r->frames);
    lua_setfield(L, -3, r->serie[k].name);
    lua_pushstring(L, r->serie[k].unit);
    lua_setfield(L, -2, r->serie[k].name);
  }
  lua_setfield(L, -3, "units");
  lua_setfield(L, -2, "series");
  push_groups(L, r->groups);
  lua_setfield(L, -2, "groups");
  push_solids(L, &r->solids);
  lua_setfield(L, -2, "solids");
  push_marks(L, &r->marks);
  lua_setfield(L, -2, "marks");
  push_attributes(L, r);
  lua_setfield(L, -2, "attributes");
}

/* recording[key]: a method, or a field. */
static int get_field(lua_State *L) {
  if (luaL_getmetafield(L, 1, "methods") != LUA_TNIL) {
    lua_pushvalue(L, 2);
    if (lua_rawget(L, -2) != LUA_TNIL) return 1;
  }
  lua_getiuservalue(L, 1, 1);
  lua_pushvalue(L, 2);
  lua_rawget(L, -2);
  return 1;
}

/* open(path) -> a recording; or nil and the reason */
static int open_recording(lua_State *L) {
  char why[512];
  const char *path = luaL_checkstring(L, 1);
  hk_recording **r = lua_newuserdatauv(L, sizeof *r, 1);
  *r = NULL;
  luaL_setmetatable(L, type_name);
  *r = hk_recording_open(path, why, sizeof why);
  if (!*r) {
    lua_pushnil(L);
    lua_pushstring(L, why);
    return 2;
  }
  push_fields(L, *r);
  lua_setiuservalue(L, -2, 1);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_recording(lua_State *L);

int luaopen_recording(lua_State *L) {
  static const luaL_Reg methods[] = {{"positions", positions},
                                     {"velocities", velocities},
                                     {"strain", strain},
                                     {"ids", ids},
                                     {"masses", masses},
                                     {"pins", pins},
                                     {"groups_and_radii", groups_and_radii},
                                     {"edges", edges},
                                     {"triangles", triangles},
                                     {"edge_strain", edge_strain},
                                     {"triangle_strain", triangle_strain},
                                     {"channel", channel},
                                     {"force", force},
                                     {"field", field_of},
                                     {"n", number},
                                     {"topology_changed", topology_changed},
                                     {"solid_places", solid_places},
                                     {"marks_of", marks_of},
                                     {"close", close_recording},
                                     {NULL, NULL}};
  static const luaL_Reg functions[] = {{"open", open_recording}, {NULL, NULL}};
  luaL_newmetatable(L, type_name);
  luaL_newlib(L, methods);
  lua_setfield(L, -2, "methods");
  lua_pushcfunction(L, get_field);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, close_recording);
  lua_setfield(L, -2, "__gc");
  lua_pop(L, 1);
  luaL_newlib(L, functions);
  return 1;
}
