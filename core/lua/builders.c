/* Builders: particle, particles, grid and strand. They add particles, edges and triangles to the scene and return a
 * handle. */
#include "core/lua/internal.h"

#include <stdlib.h>
#include <string.h>

uint32_t hk_lua_group(lua_State *L, hk_scene *scene, int table, const char *what) {
  hk_error error = {0};
  uint32_t group = 0;
  if (hk_lua_field(L, table, "group") != LUA_TNIL) {
    if (lua_type(L, -1) != LUA_TSTRING) hk_lua_fail(L, HK_BAD_PARAM, "%s: group: expected a name", what);
    hk_limits_take(L, lua_rawlen(L, -1) + 64);
    if (hk_scene_add_group(scene, lua_tostring(L, -1), &group, &error) != HK_OK) hk_lua_raise(L, &error);
  }
  lua_pop(L, 1);
  return group;
}

static void prefix_raise(lua_State *L, const char *what, const hk_error *error) {
  hk_lua_fail(L, error->status, "%s: %s", what, error->text);
}

uint32_t hk_lua_add(lua_State *L, hk_scene *scene, const char *what, size_t count, const double *x, const double *v,
                    const double *mass, double common, uint32_t group) {
  hk_error error = {0};
  uint32_t first = 0;
  if (scene->frozen) hk_lua_fail(L, HK_BAD_PARAM, "%s: the scene runs and can no longer be edited", what);
  hk_limits_take(L, count * (7 * sizeof(double) + sizeof(uint32_t)));
  for (size_t k = 0; k < scene->channels; k++) hk_limits_take(L, count * scene->channel[k].size * sizeof(double));
  if (hk_scene_add_particles(scene, count, x, v, mass, common, group, &first, &error) != HK_OK)
    prefix_raise(L, what, &error);
  return first;
}

/* ---- particle ---- */

static void set_channels(lua_State *L, hk_scene *scene, int table, uint32_t id) {
  for (size_t k = 0; k < scene->channels; k++) {
    const hk_channel_spec *channel = &scene->channel[k];
    hk_error error = {0};
    if (hk_lua_field(L, table, channel->name) != LUA_TNIL) {
      size_t count = 1;
      double number, *list = &number;
      if (lua_isnumber(L, -1))
        number = lua_tonumber(L, -1);
      else
        list = hk_lua_to_ids(L, -1, &count); /* a list of numbers in any accepted form */
      if (!list) hk_lua_fail(L, HK_BAD_PARAM, "particle: %s: expected numbers", channel->name);
      if (hk_scene_set_channel(scene, channel->name, id, list, count, &error) != HK_OK)
        prefix_raise(L, "particle", &error);
    }
    lua_settop(L, table);
  }
}

static int particle(lua_State *L) {
  const char *keys[64] = {"position", "velocity", "mass", "group"};
  hk_scene *scene = hk_lua_scene(L, 1);
  double x[3] = {0}, v[3] = {0};
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  for (size_t k = 0; k < scene->channels && k < 58; k++) keys[4 + k] = scene->channel[k].name;
  hk_lua_check_keys(L, 2, "particle", keys);
  hk_lua_field_vector(L, 2, "particle", "position", x);
  hk_lua_field_vector(L, 2, "particle", "velocity", v);
  double mass = hk_lua_field_number(L, 2, "particle", "mass", 1);
  uint32_t id = hk_lua_add(L, scene, "particle", 1, x, v, NULL, mass, hk_lua_group(L, scene, 2, "particle"));
  set_channels(L, scene, 2, id);
  lua_pushinteger(L, id);
  return 1;
}

/* ---- particles ---- */

/* Converts a list of triples to a block on the Lua stack; NULL: the key is absent. */
static double *triples(lua_State *L, int table, const char *key, size_t *count) {
  char what[64];
  if (hk_lua_field(L, table, key) == LUA_TNIL) return NULL;
  int list = lua_gettop(L);
  if (!lua_istable(L, list)) hk_lua_fail(L, HK_BAD_PARAM, "particles: %s: expected a list of {x, y, z}", key);
  *count = lua_rawlen(L, list);
  double *block = lua_newuserdatauv(L, (3 * *count + 1) * sizeof *block, 0);
  for (size_t k = 0; k < *count; k++) {
    snprintf(what, sizeof what, "particles: %s[%zu]", key, k + 1);
    lua_rawgeti(L, list, (lua_Integer)k + 1);
    hk_lua_vector(L, -1, what, block + 3 * k);
    lua_pop(L, 1);
  }
  return block;
}

static int particles(lua_State *L) {
  static const char *const keys[] = {"positions", "velocities", "masses", "mass", "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  hk_lua_check_keys(L, 2, "particles", keys);
  size_t count = 0, velocities = 0, masses = 0;
  const double *x = triples(L, 2, "positions", &count), *v = triples(L, 2, "velocities", &velocities), *m = NULL;
  if (!x) return hk_lua_fail(L, HK_BAD_PARAM, "particles: positions is required");
  if (v && velocities != count)
    return hk_lua_fail(L, HK_BAD_PARAM, "particles: %d velocities for %d positions", (int)velocities, (int)count);
  if (hk_lua_field(L, 2, "masses") != LUA_TNIL) {
    m = hk_lua_to_ids(L, -1, &masses);
    if (!m || masses != count)
      return hk_lua_fail(L, HK_BAD_PARAM, "particles: masses: expected %d numbers", (int)count);
  }
  double mass = hk_lua_field_number(L, 2, "particles", "mass", 1);
  uint32_t first = hk_lua_add(L, scene, "particles", count, x, v, m, mass, hk_lua_group(L, scene, 2, "particles"));
  hk_lua_push_handle(L, (hk_lua_handle){first, (uint32_t)count, (uint32_t)count, 1, false, false});
  return 1;
}

/* ---- grid ---- */

static uint32_t whole(lua_State *L, int table, const char *what, const char *key, double least) {
  double value = hk_lua_field_number(L, table, what, key, NAN);
  if (isnan(value)) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s is required", what, key);
  if (value < least || value > 1e6 || floor(value) != value)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: %.7g is not a whole number from %g to a million", what, key, value, least);
  return (uint32_t)value;
}

static void add_surface(lua_State *L, hk_scene *scene, const hk_lua_handle *h) {
  hk_error error = {0};
  size_t cells = (size_t)(h->nx - 1) * (h->ny - 1), at = 0;
  uint32_t(*triangle)[3] = lua_newuserdatauv(L, (2 * cells + 1) * sizeof *triangle, 0);
  hk_limits_take(L, 2 * cells * sizeof *triangle);
  for (uint32_t j = 0; j + 1 < h->ny; j++)
    for (uint32_t i = 0; i + 1 < h->nx; i++) {
      uint32_t a = h->first + j * h->nx + i, b = a + 1, c = a + h->nx, d = c + 1;
      memcpy(triangle[at++], (uint32_t[]){a, b, d}, sizeof *triangle);
      memcpy(triangle[at++], (uint32_t[]){a, d, c}, sizeof *triangle);
    }
  if (hk_scene_add_triangles(scene, 2 * cells, (const uint32_t(*)[3])triangle, &error) != HK_OK)
    hk_lua_raise(L, &error);
}

static void add_edges(lua_State *L, hk_scene *scene) {
  hk_error error = {0};
  const hk_lua_edges *edges = hk_lua_to_edges(L, -1);
  hk_limits_take(L, edges->count * sizeof *edges->pair);
  if (hk_scene_add_edges(scene, edges->count, (const uint32_t(*)[2])edges->pair, &error) != HK_OK)
    hk_lua_raise(L, &error);
}

static int grid(lua_State *L) {
  static const char *const keys[] = {"nx", "ny", "width", "height", "mass", "origin", "u", "v", "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "grid", keys);
  hk_lua_handle h = {.nx = whole(L, 2, "grid", "nx", 1), .ny = whole(L, 2, "grid", "ny", 1), .grid = true};
  double origin[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
  double width = hk_lua_field_number(L, 2, "grid", "width", 1), height = hk_lua_field_number(L, 2, "grid", "height", 1);
  double mass = hk_lua_field_number(L, 2, "grid", "mass", 1);
  hk_lua_field_vector(L, 2, "grid", "origin", origin);
  hk_lua_field_vector(L, 2, "grid", "u", u);
  hk_lua_field_vector(L, 2, "grid", "v", v);
  size_t n = (size_t)h.nx * h.ny;
  double *x = lua_newuserdatauv(L, 3 * n * sizeof *x, 0);
  for (size_t k = 0; k < n; k++) {
    size_t row = k / h.nx;
    double s = h.nx > 1 ? width * (double)(k % h.nx) / (h.nx - 1) : 0,
           t = h.ny > 1 ? height * (double)row / (h.ny - 1) : 0;
    for (int c = 0; c < 3; c++) x[3 * k + c] = origin[c] + s * u[c] + t * v[c];
  }
  h.count = (uint32_t)n;
  h.first = hk_lua_add(L, scene, "grid", n, x, NULL, NULL, mass / (double)n, hk_lua_group(L, scene, 2, "grid"));
  lua_settop(L, 2);
  hk_lua_push_structural(L, &h);
  add_edges(L, scene);
  if (h.nx > 1 && h.ny > 1) add_surface(L, scene, &h);
  lua_settop(L, 2);
  hk_lua_push_handle(L, h);
  return 1;
}

/* ---- strand ---- */

static int strand(lua_State *L) {
  static const char *const keys[] = {"n", "from", "to", "length", "direction", "mass", "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "strand", keys);
  uint32_t n = whole(L, 2, "strand", "n", 2);
  double from[3] = {0, 0, 0}, to[3], direction[3] = {0, 0, -1};
  hk_lua_field_vector(L, 2, "strand", "from", from);
  if (!hk_lua_field_vector(L, 2, "strand", "to", to)) {
    hk_lua_field_vector(L, 2, "strand", "direction", direction);
    double size = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    double length = hk_lua_field_number(L, 2, "strand", "length", 1);
    if (size == 0) return hk_lua_fail(L, HK_BAD_PARAM, "strand: direction: must not be zero");
    for (int c = 0; c < 3; c++) to[c] = from[c] + length * direction[c] / size;
  }
  double mass = hk_lua_field_number(L, 2, "strand", "mass", 1), *x = lua_newuserdatauv(L, 3 * n * sizeof *x, 0);
  for (uint32_t k = 0; k < n; k++)
    for (int c = 0; c < 3; c++) x[3 * k + c] = from[c] + (to[c] - from[c]) * k / (n - 1);
  hk_lua_handle h = {0, n, n, 1, false, true};
  h.first = hk_lua_add(L, scene, "strand", n, x, NULL, NULL, mass / n, hk_lua_group(L, scene, 2, "strand"));
  hk_lua_push_structural(L, &h);
  add_edges(L, scene);
  hk_lua_push_handle(L, h);
  return 1;
}

/* ---- hooke.gust{} ---- */

/* A number or a vector at `key`; a number stands for `all` three, or for the first. Returns whether it is a vector. */
static bool gust_numbers(lua_State *L, const char *key, bool all, double out[HK_COLUMNS]) {
  bool vector = hk_lua_field(L, 1, key) == LUA_TTABLE;
  lua_pop(L, 1);
  if (vector) return hk_lua_field_vector(L, 1, "gust", key, out);
  out[0] = hk_lua_field_number(L, 1, "gust", key, 0);
  for (int c = 1; c < HK_COLUMNS; c++) out[c] = all ? out[0] : 0;
  return false;
}

int hk_lua_gust(lua_State *L) {
  static const char *const keys[] = {"mean", "amplitude", "shortest", "longest", "seed", NULL};
  double mean[HK_COLUMNS], amplitude[HK_COLUMNS];
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  hk_lua_check_keys(L, 1, "gust", keys);
  bool vector = gust_numbers(L, "mean", false, mean), turns = gust_numbers(L, "amplitude", true, amplitude);
  double shortest = hk_lua_field_number(L, 1, "gust", "shortest", NAN);
  double longest = hk_lua_field_number(L, 1, "gust", "longest", 20 * shortest);
  if (turns && !vector && mean[0] != 0)
    return hk_lua_fail(L, HK_BAD_PARAM, "gust: mean: a number, where the amplitude is a vector: mean = { x, y, z }");
  if (!(shortest > 0))
    return hk_lua_fail(L, HK_BAD_PARAM, "gust: shortest: the shortest period, in s, has to be given, and above 0");
  if (!(longest >= shortest))
    return hk_lua_fail(L, HK_BAD_PARAM, "gust: longest: %g s is below the shortest period, %g s", longest, shortest);
  for (int c = 0; c < HK_COLUMNS; c++)
    if (amplitude[c] < 0)
      return hk_lua_fail(L, HK_BAD_PARAM, "gust: amplitude: %g is below the minimum 0", amplitude[c]);
  uint64_t seed = hk_lua_field_whole(L, 1, "gust", "seed", 1, 9007199254740992.0); /* 2^53 */
  hk_gust_make(hk_lua_push_gust(L), vector || turns ? HK_COLUMNS : 1, mean, amplitude, shortest, longest, seed);
  return 1;
}

/* ---- */

void hk_lua_open_builders(lua_State *L) {
  static const luaL_Reg builders[] = {
      {"particle", particle}, {"particles", particles}, {"grid", grid}, {"strand", strand}, {NULL, NULL}};
  luaL_setfuncs(L, builders, 0);
}
