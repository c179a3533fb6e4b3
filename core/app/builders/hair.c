/* scene:hair{}: many strands of n particles on a surface, from a seed: a sphere or a cap of it, a parallelogram, the
 * numbers of scene:surface{}, or a mesh or grid of the scene as it is. Their roots are spread evenly (scene/scatter.c);
 * each grows along the surface's normal, turned by up to `spread`, with a length between 1 - vary_length and 1 +
 * vary_length of `length`, a curl between 1 - vary_curl and 1 + vary_curl of `curl`'s size, and any phase of it. Strand
 * k's particles follow those of strand k - 1, and so do its edges: what bends at consecutive edges bends no strand into
 * the next.
 *
 * Section, material and wall are those of scene:strand{} (clamped unless said otherwise): the root's second particle
 * lies on the surface, the first below it. Where lengths vary, `length` and `segment` are lists of a number a strand,
 * and `stiffness` one of a number an edge. */
#include "core/app/builders/filament.h"
#include "core/engine/base/base.h"

static const double pi = 3.14159265358979323846;
/* Instructions of a script that take as long, about: 10,000 strands of 32 particles are 0.1 s. */
enum { ROOT_COST = 1000, PARTICLE_COST = 30 };
enum { MOST = 20000000 }; /* particles; a script's memory is full before */

/* ---- the surface ---- */

static void read_sphere(lua_State *L, hk_scene *scene, int on, hk_skin *skin) {
  static const char *const keys[] = {"centre", "radius", "axis", "cap", NULL};
  hk_lua_check_keys(L, on, "hair: on", keys);
  lua_pushnil(L);
  if (lua_next(L, on))
    lua_pop(L, 2);
  else
    hk_lua_warn(L, scene,
                "hair: on: {} names no surface, so that it is a sphere with a radius of 1 m: give { radius = 1 } of "
                "one, { u =, v = } of a patch, scene:surface{}, or a mesh");
  skin->axis[2] = 1;
  hk_lua_field_vector(L, on, "hair: on", "centre", skin->centre);
  hk_lua_field_vector(L, on, "hair: on", "axis", skin->axis);
  hk_lua_unit(L, "hair: on", "axis", skin->axis);
  skin->radius = hk_lua_above_zero(L, on, "hair: on", "radius", 1);
  skin->cap = hk_lua_above_zero(L, on, "hair: on", "cap", pi);
  if (skin->cap > pi) hk_lua_fail(L, HK_BAD_PARAM, "hair: on: cap: %g rad is above pi", skin->cap);
}

static void read_patch(lua_State *L, int on, hk_skin *skin) {
  static const char *const keys[] = {"origin", "u", "v", NULL};
  static const uint32_t halves[2][3] = {{0, 1, 3}, {0, 3, 2}};
  double(*vertex)[3] = lua_newuserdatauv(L, 4 * sizeof *vertex, 0), u[3] = {1, 0, 0}, v[3] = {0, 1, 0}, from[3] = {0};
  hk_lua_check_keys(L, on, "hair: on", keys);
  hk_lua_field_vector(L, on, "hair: on", "origin", from);
  hk_lua_field_vector(L, on, "hair: on", "u", u);
  hk_lua_field_vector(L, on, "hair: on", "v", v);
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++) vertex[k][c] = from[c] + (k & 1) * u[c] + (k >> 1) * v[c];
  *skin = (hk_skin){.vertices = 4, .triangles = 2, .vertex = (const double(*)[3])vertex, .triangle = halves};
}

static double *numbers_of(lua_State *L, int on, const char *key, size_t *count) {
  hk_lua_field(L, on, key);
  double *list = hk_lua_to_ids(L, -1, count);
  if (!list || *count % 3)
    hk_lua_fail(L, HK_BAD_PARAM, "hair: on: %s: expected a list of numbers, three by three, as of scene:surface{}",
                key);
  return list;
}

/* The numbers of scene:surface{}. */
static void read_surface(lua_State *L, int on, hk_skin *skin) {
  size_t coordinates, corners;
  const double *x = numbers_of(L, on, "vertices", &coordinates), *face = numbers_of(L, on, "faces", &corners);
  const size_t vertices = coordinates / 3;
  uint32_t(*triangle)[3] = lua_newuserdatauv(L, (corners + 1) * sizeof **triangle, 0);
  for (size_t k = 0; k < corners; k++) {
    if (!(face[k] >= 1 && face[k] <= (double)vertices && floor(face[k]) == face[k]))
      hk_lua_fail(L, HK_BAD_PARAM, "hair: on: faces[%d]: there is no vertex %.15g", (int)k + 1, face[k]);
    triangle[k / 3][k % 3] = (uint32_t)face[k] - 1;
  }
  *skin = (hk_skin){.vertices = vertices,
                    .triangles = corners / 3,
                    .vertex = (const double(*)[3])(const void *)x,
                    .triangle = (const uint32_t(*)[3])triangle};
}

/* A mesh or a grid of the scene: its triangles, between particles where they are. */
static void read_handle(lua_State *L, const hk_scene *scene, int on, hk_skin *skin) {
  lua_getfield(L, on, "triangles");
  lua_pushvalue(L, on);
  lua_call(L, 1, 1);
  size_t count = lua_rawlen(L, -1);
  int list = lua_gettop(L);
  uint32_t(*triangle)[3] = lua_newuserdatauv(L, (count + 1) * sizeof *triangle, 0);
  for (size_t k = 0; k < 3 * count; k++) {
    lua_rawgeti(L, list, (lua_Integer)(k / 3) + 1);
    lua_rawgeti(L, -1, (lua_Integer)(k % 3) + 1);
    triangle[k / 3][k % 3] = (uint32_t)lua_tointeger(L, -1) - 1;
    lua_pop(L, 2);
  }
  *skin = (hk_skin){.vertices = scene->particles.n,
                    .triangles = count,
                    .vertex = (const double(*)[3])(const void *)scene->particles.position,
                    .triangle = (const uint32_t(*)[3])triangle};
}

static hk_skin read_skin(lua_State *L, hk_scene *scene) {
  static const hk_skin none = {0};
  hk_skin skin = none;
  int type = hk_lua_field(L, 2, "on"), on = lua_gettop(L);
  if (hk_lua_to_handle(L, on))
    read_handle(L, scene, on, &skin);
  else if (type != LUA_TTABLE)
    hk_lua_fail(L, HK_BAD_PARAM,
                "hair: on is required: { radius = } of a sphere, { u =, v = } of a patch, scene:surface{}, or a mesh");
  else if (hk_lua_given(L, on, "faces"))
    read_surface(L, on, &skin);
  else if (hk_lua_given(L, on, "u") || hk_lua_given(L, on, "v"))
    read_patch(L, on, &skin);
  else
    read_sphere(L, scene, on, &skin);
  if (skin.axis[0] == 0 && skin.axis[1] == 0 && skin.axis[2] == 0 && skin.triangles == 0)
    hk_lua_fail(L, HK_BAD_PARAM, "hair: on: the surface has no triangles");
  return skin;
}

/* ---- the strands ---- */

typedef struct hair {
  uint32_t n, strands;
  bool wall;
  double length, spread, vary_length, vary_curl;
  hk_lua_material material;
  hk_lua_curl curl;
  uint64_t random[4];
  double (*root)[3], (*normal)[3], *grown; /* of each strand; its length, m */
  double (*x)[3], *mass;                   /* of all particles */
} hair;

static double between(uint64_t random[4], double vary) { return 1 + vary * (2 * hk_random_uniform(random) - 1); }

static void grow(hair *h) {
  for (uint32_t k = 0; k < h->strands; k++) {
    double direction[3], *mass = h->mass + (size_t)k * h->n;
    hk_random_in_cone(h->random, h->normal[k], h->spread, direction);
    h->grown[k] = h->length * between(h->random, h->vary_length);
    double phase = h->curl.phased ? 0 : 2 * pi * hk_random_uniform(h->random);
    hk_helix helix = hk_lua_curl_helix(&h->curl, h->root[k], direction, phase, between(h->random, h->vary_curl));
    hk_lua_lay(&helix, h->n, h->wall, h->grown[k] / (h->n - 1 - h->wall), h->x + (size_t)k * h->n);
    hk_lua_material one = h->material; /* all strands weigh `mass` together, longer ones more */
    one.mass = h->material.mass / h->strands * h->grown[k] / h->length;
    hk_lua_share_mass(&one, h->n, h->wall, h->grown[k], mass);
  }
}

static void set_list(lua_State *L, int table, const char *key, const hair *h, double (*value)(const hair *, uint32_t),
                     uint32_t each) {
  lua_createtable(L, (int)(h->strands * each), 0);
  for (uint32_t k = 0; k < h->strands * each; k++) {
    lua_pushnumber(L, value(h, k / each));
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  lua_setfield(L, table, key);
}

static double length_of(const hair *h, uint32_t k) { return h->grown[k]; }
static double segment_of(const hair *h, uint32_t k) { return h->grown[k] / (h->n - 1 - h->wall); }
static double stiffness_of(const hair *h, uint32_t k) { return h->material.numbers.EA / segment_of(h, k); }

static void set_numbers(lua_State *L, const hair *h) {
  int handle = lua_gettop(L);
  hk_lua_set_numbers(L, handle, &h->material, h->length, h->length / (h->n - 1 - h->wall));
  if (h->vary_length == 0) return;
  lua_getiuservalue(L, handle, HK_LUA_NUMBERS);
  int table = lua_gettop(L);
  set_list(L, table, "length", h, length_of, 1);
  set_list(L, table, "segment", h, segment_of, 1);
  if (h->material.there && !isnan(h->material.numbers.EA)) set_list(L, table, "stiffness", h, stiffness_of, h->n - 1);
  lua_settop(L, handle);
}

static double below(lua_State *L, const char *key, double most) {
  double value = hk_lua_field_number(L, 2, "hair", key, 0);
  if (value < 0 || value > most) hk_lua_fail(L, HK_BAD_PARAM, "hair: %s: %g is not from 0 to %g", key, value, most);
  return value;
}

static void read(lua_State *L, hk_scene *scene, hair *h) {
  h->wall = hk_lua_flag(L, 2, "hair", "clamped", true);
  h->n = hk_lua_count(L, 2, "hair", "n", h->wall ? 3 : 2);
  h->strands = hk_lua_count(L, 2, "hair", "strands", 1);
  if ((double)h->n * h->strands > MOST)
    hk_lua_fail(L, HK_BAD_PARAM, "hair: %d strands of %d particles are too many: at most %d particles", (int)h->strands,
                (int)h->n, MOST);
  h->length = hk_lua_above_zero(L, 2, "hair", "length", 1);
  h->spread = below(L, "spread", pi);
  h->vary_length = below(L, "vary_length", 0.99);
  h->vary_curl = below(L, "vary_curl", 0.99);
  h->material = hk_lua_read_material(L, 2, scene, "hair");
  h->curl = hk_lua_read_curl(L, 2, "hair");
  hk_random_seed(h->random, hk_lua_field_whole(L, 2, "hair", "seed", scene->seed, 9007199254740992.0)); /* 2^53 */
}

static void reserve(lua_State *L, hair *h) {
  size_t particles = (size_t)h->n * h->strands;
  h->root = lua_newuserdatauv(L, h->strands * sizeof *h->root, 0);
  h->normal = lua_newuserdatauv(L, h->strands * sizeof *h->normal, 0);
  h->grown = lua_newuserdatauv(L, h->strands * sizeof *h->grown, 0);
  h->x = lua_newuserdatauv(L, particles * sizeof *h->x, 0);
  h->mass = lua_newuserdatauv(L, particles * sizeof *h->mass, 0);
}

int hk_build_hair(lua_State *L) {
  static const char *const keys[] = {"on",   "strands", "n",    "length",    "spread",  "vary_length",
                                     "curl", "seed",    "mass", "vary_curl", "radius",  "E",
                                     "nu",   "density", "pin",  "group",     "clamped", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_error error = {0};
  hair h = {0};
  hk_lua_check_table(L, 2, "hair", "scene:hair { ... }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "hair", keys);
  luaL_checkstack(L, 40, "hair");
  read(L, scene, &h);
  hk_skin skin = read_skin(L, scene);
  hk_limits_count(L, (size_t)h.strands * (ROOT_COST + (size_t)h.n * PARTICLE_COST));
  reserve(L, &h);
  if (hk_scatter(&skin, h.strands, h.random, h.root, h.normal, &error) != HK_OK) hk_lua_raise_for(L, "hair", &error);
  grow(&h);
  size_t particles = (size_t)h.n * h.strands;
  hk_lua_handle handle = {.count = (uint32_t)particles, .nx = h.n, .ny = h.strands, .chain = true};
  handle.roots = h.wall ? 2 : 1;
  handle.first =
      hk_lua_add(L, scene, "hair", particles, &h.x[0][0], NULL, h.mass, 0, hk_lua_group(L, scene, 2, "hair"));
  hk_lua_keep_section(L, scene, &h.material, handle.first, particles);
  hk_lua_push_structural(L, &handle);
  hk_lua_add_edges(L, scene);
  if (h.wall && hk_lua_flag(L, 2, "hair", "pin", true)) hk_lua_pin_roots(L, scene, &handle, "hair");
  hk_lua_push_handle(L, handle);
  set_numbers(L, &h);
  return 1;
}
