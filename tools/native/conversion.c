/* conversion: recordings (recording.c) as files of other formats, by the writers of formats/. */
#include "plugins/common/recording/recorded_frame.h"
#include "plugins/common/recording/recording.h"
#include "tools/native/formats/csv.h"
#include "tools/native/formats/formats.h"
#include "tools/native/formats/gltf.h"
#include "tools/native/formats/pc2.h"
#include "tools/native/formats/usd.h"
#include "tools/native/common/tool_host.h"
#include "plugins/common/frame_data/gatherer.h"
#include "plugins/common/particle_surface/surface_frame.h"

#include <lauxlib.h>
#include <lua.h>
#include <string.h>
#include <unistd.h>

typedef struct conversion {
  hk_recording *recording;
  hk_gatherer gatherer;
  size_t from, to, every; /* frames from..to, from 0 */
  char why[512];
} conversion;

static const char type_name[] = "hooke.conversion";

static conversion *at(lua_State *L) { return luaL_checkudata(L, 1, type_name); }

static int free_conversion(lua_State *L) {
  conversion *c = at(L);
  hk_recording_close(c->recording);
  hk_gatherer_free(&c->gatherer);
  *c = (conversion){0};
  return 0;
}

static int answer(lua_State *L, conversion *c, bool fine, lua_Integer frames) {
  if (fine) {
    lua_pushinteger(L, frames);
    return 1;
  }
  lua_pushnil(L);
  lua_pushstring(L, c->why);
  return 2;
}

static bool shoot(conversion *c, size_t k) {
  if (hk_recording_frame_read(c->recording, k, &c->gatherer) && hk_recorded_solids_move(&c->recording->solids, k))
    return true;
  snprintf(c->why, sizeof c->why, "frame %zu cannot be read: the file is damaged, or there is no memory", k + 1);
  return false;
}

/* Particles of which the frame has no other than those with these ids; the cells are void then. */
static void keep(hk_frame_data *s, const uint32_t *ids, bool *seen, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < s->n; i++) {
    bool wanted = false;
    for (size_t k = 0; k < count; k++)
      if (ids[k] == s->id[i]) wanted = seen[k] = true;
    if (!wanted) continue;
    memcpy(s->x + 3 * kept, s->x + 3 * i, 3 * sizeof *s->x);
    memcpy(s->v + 3 * kept, s->v + 3 * i, 3 * sizeof *s->v);
    s->id[kept] = s->id[i], s->mass[kept] = s->mass[i], s->pin[kept] = s->pin[i];
    if (s->strain) s->strain[kept] = s->strain[i];
    for (size_t a = 0; a < s->arrays; a++) {
      hk_frame_array *array = &s->array[a];
      memcpy(array->value + array->width * kept, array->value + array->width * i, array->width * sizeof(double));
    }
    kept++;
  }
  s->n = kept;
  s->cells = (hk_frame_cells){.vertex = s->cells.vertex, .segment = s->cells.segment, .triangle = s->cells.triangle};
}

/* open(path, from, to, every) -> the frames of a recording that are to be converted, counted from 1; or nil, reason */
static int open_conversion(lua_State *L) {
  const char *path = luaL_checkstring(L, 1);
  lua_Integer from = luaL_optinteger(L, 2, 1), to = luaL_optinteger(L, 3, LUA_MAXINTEGER),
              every = luaL_optinteger(L, 4, 1);
  conversion *c = lua_newuserdatauv(L, sizeof *c, 0);
  *c = (conversion){0};
  luaL_setmetatable(L, type_name);
  c->recording = hk_recording_open(path, c->why, sizeof c->why);
  bool fine = c->recording && hk_recording_frame_open(c->recording, &c->gatherer);
  if (fine && (from < 1 || from > to || (size_t)from > c->recording->frames || every < 1)) {
    if (from > to)
      snprintf(c->why, sizeof c->why, "--from-frame %lld is after --to-frame %lld", (long long)from, (long long)to);
    else
      snprintf(c->why, sizeof c->why, "--from-frame %lld: %s has the frames 1 to %zu", (long long)from, path,
               c->recording->frames);
    fine = false;
  }
  if (!fine) return answer(L, c, false, 0);
  c->from = (size_t)from - 1, c->every = (size_t)every;
  c->to = (size_t)to < c->recording->frames ? (size_t)to - 1 : c->recording->frames - 1;
  return 1;
}

static bool cannot_write(conversion *c, const char *path, const char *why) {
  snprintf(c->why, sizeof c->why, "cannot write %.200s: %s", path, why);
  return false;
}

/* ---- surfaces of particles ---- */

static double number_at(lua_State *L, int table, const char *key) {
  lua_getfield(L, table, key);
  double value = lua_tonumber(L, -1);
  lua_pop(L, 1);
  return value;
}

/* { radius =, reach =, cell =, threshold =, field = "density", position_smoothing =, stretch =, cubes = true }, of
 * which what is nil is 0, left out; false: none is asked for. */
static bool read_surface(lua_State *L, int table, hk_particle_surface_options *o) {
  static const char *const names[] = {"zhu_bridson", "density", "anisotropic", NULL};
  if (!lua_istable(L, table)) return false;
  *o = (hk_particle_surface_options){.radius = number_at(L, table, "radius"),
                                     .reach = number_at(L, table, "reach"),
                                     .cell = number_at(L, table, "cell"),
                                     .smoothing = (unsigned)number_at(L, table, "smoothing"),
                                     .threshold = number_at(L, table, "threshold"),
                                     .stretch = number_at(L, table, "stretch")};
  lua_getfield(L, table, "position_smoothing");
  o->position_smoothing = lua_isnil(L, -1) ? 0 : lua_tonumber(L, -1) > 0 ? lua_tonumber(L, -1) : -1;
  lua_getfield(L, table, "field");
  o->kind = (hk_particle_field_kind)luaL_checkoption(L, -1, names[0], names);
  lua_getfield(L, table, "cubes");
  o->method = lua_toboolean(L, -1) ? HK_MARCHING_CUBES : HK_MARCHING_TETRAHEDRA;
  lua_pop(L, 3);
  return true;
}

typedef struct surfaces { /* a zeroed one makes none */
  hk_tool_host holder;
  const hk_host *host;
  hk_particle_surface_options options;
  bool cut; /* by the obstacles of the frame */
  hk_surface_frame frame;
} surfaces;

/* By the table at this place of the stack, if there is one. */
static bool surfaces_open(surfaces *s, lua_State *L, int table, conversion *c) {
  *s = (surfaces){.holder = {.plugin = {.kind = HK_SERVICE}}};
  if (!read_surface(L, table, &s->options)) return true;
  lua_getfield(L, table, "cut");
  s->cut = lua_toboolean(L, -1);
  lua_pop(L, 1);
  s->host = hk_tool_host_open(&s->holder, "--isosurface");
  if (!s->host) snprintf(c->why, sizeof c->why, "no memory, or no threads");
  return s->host != NULL;
}

static void surfaces_close(surfaces *s) {
  if (s->host) hk_surface_frame_free(&s->frame, s->host);
  hk_tool_host_close(&s->holder);
}

/* The frame that was read, with the surface of its loose particles in their stead where that is asked for; NULL: it
 * cannot be made. */
static const hk_frame_data *shown(conversion *c, surfaces *s) {
  if (!s->host) return &c->gatherer.data;
  hk_recorded_solids *solids = &c->recording->solids;
  hk_solid_list walls = {solids->count, solids->solid};
  if (hk_surface_frame_make(&s->frame, s->host, &c->gatherer.data, &s->options, s->cut ? &walls : NULL) == HK_OK)
    return &s->frame.data;
  snprintf(c->why, sizeof c->why, "at t = %g s: %.400s", c->gatherer.data.t, s->holder.error.text);
  return NULL;
}

/* c:sequence(format, folder, surface): files 000000.FORMAT and so on, with a table `surface` those of frames in which
 * the surface of loose particles stands for these -> number of files; or nil, reason */
static int sequence(lua_State *L) {
  static const hk_sequence_format *const formats[] = {&hk_sequence_ply, &hk_sequence_obj, &hk_sequence_vtk};
  static const char *const names[] = {"ply", "obj", "vtk", NULL};
  conversion *c = at(L);
  const hk_sequence_format *format = formats[luaL_checkoption(L, 2, NULL, names)];
  const char *folder = luaL_checkstring(L, 3);
  surfaces surface;
  lua_Integer written = 0;
  bool fine = surfaces_open(&surface, L, 4, c);
  for (size_t k = c->from; k <= c->to && fine; k += c->every) {
    char path[4096], why[256] = "";
    snprintf(path, sizeof path, "%s/%06lld.%s", folder, (long long)written, format->name);
    const hk_frame_data *data = shoot(c, k) ? shown(c, &surface) : NULL;
    fine = data != NULL;
    if (fine && !hk_sequence_write(format, data, path, why, sizeof why)) fine = cannot_write(c, path, why);
    written += fine;
  }
  surfaces_close(&surface);
  return answer(L, c, fine, written);
}

/* c:table(path, {id, ...}): the particles with these ids, or all -> number of frames; or nil, reason */
static int table(lua_State *L) {
  conversion *c = at(L);
  const char *path = luaL_checkstring(L, 2);
  size_t count = lua_istable(L, 3) ? lua_rawlen(L, 3) : 0;
  uint32_t *ids = lua_newuserdatauv(L, (count + 1) * sizeof *ids, 0);
  bool *seen = memset(lua_newuserdatauv(L, (count + 1) * sizeof *seen, 0), 0, (count + 1) * sizeof *seen);
  for (size_t k = 0; k < count; k++, lua_pop(L, 1)) {
    lua_rawgeti(L, 3, (lua_Integer)k + 1);
    ids[k] = (uint32_t)lua_tointeger(L, -1);
  }
  char why[256] = "";
  hk_whole_file file;
  bool fine = hk_whole_open(&file, path, why, sizeof why), read = fine;
  lua_Integer written = 0;
  for (size_t k = c->from; k <= c->to && fine && read; k += c->every, written++) {
    read = shoot(c, k);
    if (read && count) keep(&c->gatherer.data, ids, seen, count);
    if (read && written == 0) hk_csv_head(file.stream, &c->gatherer.data);
    if (read) hk_csv_rows(file.stream, &c->gatherer.data);
    fine = hk_whole_check(&file);
  }
  for (size_t k = 0; k < count && fine && read; k++)
    if (!(read = seen[k]))
      snprintf(c->why, sizeof c->why, "--ids: no particle of these frames has the id %u", (unsigned)ids[k]);
  if (!hk_whole_close(&file, read, why, sizeof why)) fine = false;
  if (*why) cannot_write(c, path, why);
  return answer(L, c, fine && read, written);
}

static bool add_sample(conversion *c, hk_pc2 *cache, size_t k) {
  char why[256] = "";
  if (!shoot(c, k)) return false;
  if (!hk_pc2_fits(cache, &c->gatherer.data)) {
    snprintf(
        c->why, sizeof c->why,
        "particles were born or died before t = %g s: a point cache is of a mesh that stays the same; take ply, obj "
        "or vtk, or frames before (--to-frame %zu)",
        c->gatherer.data.t, k);
    return false;
  }
  if (hk_pc2_add(cache, &c->gatherer.data, why, sizeof why)) return true;
  return cannot_write(c, cache->file.path, why);
}

static bool write_cache(conversion *c, const char *path, lua_Integer *written) {
  char why[256] = "";
  hk_pc2 cache = {0};
  bool fine = hk_pc2_open(&cache, path, &c->gatherer.data, why, sizeof why) || cannot_write(c, path, why);
  for (size_t k = c->from; k <= c->to && fine; k += c->every, ++*written) fine = add_sample(c, &cache, k);
  return hk_pc2_close(&cache, fine, why, sizeof why) ? fine : cannot_write(c, path, why);
}

/* c:point_cache(pc2, obj): the mesh of the first frame and the positions at all -> number of frames; or nil, reason */
static int point_cache(lua_State *L) {
  conversion *c = at(L);
  const char *path = luaL_checkstring(L, 2), *mesh = luaL_checkstring(L, 3);
  char why[256] = "";
  lua_Integer written = 0;
  bool fine = shoot(c, c->from) && write_cache(c, path, &written) && shoot(c, c->from);
  if (fine && !hk_sequence_write(&hk_sequence_obj, &c->gatherer.data, mesh, why, sizeof why))
    fine = cannot_write(c, mesh, why);
  return answer(L, c, fine, written);
}

/* Whether the particles or cells of frame k are others than those of the frame that was taken before. */
static bool has_changed(const conversion *c, const surfaces *s, size_t k) {
  return s->host || (k > c->from && c->recording->frame[k].part != c->recording->frame[k - c->every].part);
}

typedef struct motion { /* one of the two is written */
  bool is_usd;
  hk_gltf gltf;
  hk_usd usd;
} motion;

static bool write_motion(conversion *c, surfaces *s, motion *m, const char *path, bool z_up, lua_Integer *written) {
  char why[256] = "";
  bool fine = m->is_usd ? hk_usd_open(&m->usd, path, c->recording->fps, z_up, why, sizeof why)
                        : hk_gltf_open(&m->gltf, path, (c->to - c->from) / c->every + 1, z_up, why, sizeof why);
  bool read = fine;
  for (size_t k = c->from; k <= c->to && fine && read; k += c->every, *written += fine && read) {
    const hk_frame_data *data = shoot(c, k) ? shown(c, s) : NULL;
    read = data != NULL;
    if (read)
      fine = m->is_usd ? hk_usd_add(&m->usd, data, has_changed(c, s, k), why, sizeof why)
                       : hk_gltf_add(&m->gltf, data, has_changed(c, s, k), why, sizeof why);
  }
  bool closed = m->is_usd ? hk_usd_close(&m->usd, fine && read, why, sizeof why)
                          : hk_gltf_close(&m->gltf, fine && read, why, sizeof why);
  fine = fine && closed;
  if (!fine) cannot_write(c, path, why);
  return fine && read;
}

static int motion_to(lua_State *L, bool is_usd) {
  conversion *c = at(L);
  const char *path = luaL_checkstring(L, 2);
  surfaces surface;
  motion m = {.is_usd = is_usd};
  lua_Integer written = 0;
  bool fine = surfaces_open(&surface, L, 4, c) && write_motion(c, &surface, &m, path, lua_toboolean(L, 3), &written);
  surfaces_close(&surface);
  return answer(L, c, fine, written);
}

/* c:gltf(path, z_up, surface), c:usd(path, z_up, surface): with a table `surface` as sequence -> number of frames; or
 * nil, reason */
static int gltf(lua_State *L) { return motion_to(L, false); }
static int usd(lua_State *L) { return motion_to(L, true); }

/* ---- a recording again ---- */

static double figure(const hk_recording *r, const char *name, size_t k) {
  for (size_t s = 0; s < r->series; s++)
    if (strcmp(r->serie[s].name, name) == 0) return r->serie[s].value[k];
  return NAN;
}

static void fill_vector(const hk_recording *r, const char *name, size_t k, double v[3]) {
  char full[64];
  for (int c = 0; c < 3; c++) {
    snprintf(full, sizeof full, "%s %c", name, 'x' + c);
    v[c] = figure(r, full, k);
  }
}

/* names: room for names and units of all series. */
static hk_frame frame_of(const hk_recording *r, size_t k, const char **names, double *values) {
  hk_frame f = {
      .index = k, .fps = r->fps, .measure_name = names, .measure = values, .scene = r->scene, .origin = r->origin};
  f.measure_unit = names + r->series;
  f.kinetic = figure(r, "kinetic", k), f.potential = figure(r, "potential", k), f.work = figure(r, "work", k);
  f.step = figure(r, "step", k), f.error = figure(r, "error", k);
  fill_vector(r, "momentum", k, f.momentum);
  fill_vector(r, "angular momentum", k, f.angular_momentum);
  for (size_t s = 0; s < r->series; s++) {
    if (!r->serie[s].measure) continue;
    names[f.measures] = r->serie[s].name;
    names[r->series + f.measures] = r->serie[s].unit;
    values[f.measures++] = r->serie[s].value[k];
  }
  return f;
}

/* Writes the frames; `read` false: one of them could not be read, or have its surface made. Returns how many. */
static lua_Integer record_frames(lua_State *L, conversion *c, surfaces *surface, const char *h5, const char *xdmf,
                                 bool *fine, bool *read) {
  const hk_recording *r = c->recording;
  const char **names = lua_newuserdatauv(L, (2 * r->series + 1) * sizeof *names, 0);
  double *values = lua_newuserdatauv(L, (r->series + 1) * sizeof *values, 0);
  char why[256] = "";
  hk_recorder_setup setup = {.single = lua_toboolean(L, 4), .level = 1, .every = c->every * (size_t)r->every};
  hk_recorder *recorder = NULL;
  lua_Integer written = 0;
  int64_t part = -1;
  bool begun = false;
  for (size_t k = c->from; k <= c->to && *fine && *read; k += c->every, written += *fine && *read) {
    const hk_frame_data *data = shoot(c, k) ? shown(c, surface) : NULL;
    *read = data != NULL;
    hk_frame frame = frame_of(r, k, names, values);
    if (*read && !begun) recorder = hk_recorder_open(h5, xdmf, &setup, data, &frame, why, sizeof why);
    bool changed = surface->host || r->frame[k].part != part;
    if (*read) *fine = recorder && hk_recorder_add(recorder, data, changed, &frame, why, sizeof why);
    begun = begun || *read;
    part = r->frame[k].part;
  }
  if (recorder && !hk_recorder_close(recorder, *fine && *read ? r->verdict : NULL, why, sizeof why)) *fine = false;
  if (!*fine) cannot_write(c, h5, why);
  if (begun && !(*fine && *read)) { /* a part of the motion is none */
    unlink(h5);
    unlink(xdmf);
  }
  return written;
}

/* c:recording(h5, xdmf, single, surface): with a table `surface` as sequence -> number of frames; or nil, reason */
static int record(lua_State *L) {
  conversion *c = at(L);
  const char *h5 = luaL_checkstring(L, 2), *xdmf = luaL_checkstring(L, 3);
  surfaces surface;
  if (!surfaces_open(&surface, L, 5, c)) return answer(L, c, false, 0);
  bool fine = true, read = true;
  lua_Integer written = record_frames(L, c, &surface, h5, xdmf, &fine, &read);
  surfaces_close(&surface);
  return answer(L, c, fine && read, written);
}

__attribute__((visibility("default"))) int luaopen_conversion(lua_State *L);

int luaopen_conversion(lua_State *L) {
  static const luaL_Reg methods[] = {{"sequence", sequence},     {"table", table}, {"point_cache", point_cache},
                                     {"recording", record},      {"gltf", gltf},   {"usd", usd},
                                     {"close", free_conversion}, {NULL, NULL}};
  static const luaL_Reg functions[] = {{"open", open_conversion}, {NULL, NULL}};
  luaL_newmetatable(L, type_name);
  luaL_newlib(L, methods);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, free_conversion);
  lua_setfield(L, -2, "__gc");
  lua_pop(L, 1);
  luaL_newlib(L, functions);
  return 1;
}
