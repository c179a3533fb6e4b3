/* scene:implicit{ f = function(x, y, z) | blobs = | union = | intersection = | difference =, size = }: the surface of a
 * formula as a mesh of triangles or, as = "solid", what it holds as tetrahedra. The service "isosurface/1" makes the
 * mesh; it is opened for this call alone, on one thread, since a script's functions are called from one. */
#include "core/app/builders/mesh_handle.h"
#include "core/app/shapes/shapes.h"

#include <string.h>

typedef enum result { AS_BODY, AS_SOLID, AS_SURFACE } result;

/* ---- the service ---- */

typedef struct opened {
  hk_shared shared;
  hk_plugin_spec *spec;
  hk_instance *instance;
} opened;

static const hk_isosurfaces *open_service(opened *o, hk_registry *registry, hk_error *error) {
  const hk_plugin *plugin;
  hk_view nothing = {0};
  o->shared = (hk_shared){.registry = registry, .error = error, .allocations_left = -1};
  o->shared.threads = hk_threads_create(1);
  if (!o->shared.threads) hk_error_set(error, HK_NO_MEMORY, "implicit: no memory");
  if (!o->shared.threads || hk_registry_find(registry, HK_SERVICE, "isosurface", false, &plugin, error) != HK_OK)
    return NULL;
  o->spec = hk_spec_create(plugin, "implicit", "", error);
  o->instance = o->spec ? hk_instance_create(o->spec, &o->shared, error) : NULL;
  if (!o->instance || hk_instance_start(o->instance, &nothing, 0, error) != HK_OK) return NULL;
  return plugin->service->table(o->instance->self);
}

static void close_service(opened *o) {
  hk_instance_destroy(o->instance);
  hk_spec_destroy(o->spec);
  hk_threads_destroy(o->shared.threads);
}

/* False: no memory. */
static bool copy_mesh(hk_mesh *m, const hk_implicit_mesh *found) {
  if (!hk_mesh_grow(&m->vertex, &m->vertex_capacity, found->vertices, 3 * sizeof *m->vertex) ||
      !hk_mesh_grow(&m->triangle, &m->triangle_capacity, found->triangles, sizeof *m->triangle) ||
      !hk_mesh_grow(&m->tetrahedron, &m->tetrahedron_capacity, found->tetrahedra, sizeof *m->tetrahedron))
    return false;
  m->vertices = found->vertices, m->triangles = found->triangles, m->tetrahedra = found->tetrahedra;
  memcpy(m->vertex, found->x, m->vertices * sizeof *found->x);
  if (m->triangles) memcpy(m->triangle, found->triangle, m->triangles * sizeof *m->triangle);
  if (m->tetrahedra) memcpy(m->tetrahedron, found->tetrahedron, m->tetrahedra * sizeof *m->tetrahedron);
  return true;
}

/* Raises nothing, so that the service is closed whatever happens. */
static hk_status find(hk_registry *registry, const hk_implicit_request *request, hk_mesh *m, hk_error *error) {
  opened o = {.spec = NULL};
  hk_implicit_mesh found;
  const hk_isosurfaces *service = open_service(&o, registry, error);
  hk_status status = service ? service->find(service->self, request, &found) : HK_FAILED;
  if (status == HK_OK && found.vertices > 1000000)
    status =
        hk_error_set(error, HK_BAD_PARAM,
                     "implicit: %zu particles are more than a million: take larger cells, size = ", found.vertices);
  if (status == HK_OK && !copy_mesh(m, &found)) status = hk_error_set(error, HK_NO_MEMORY, "implicit: no memory");
  close_service(&o);
  return status;
}

/* ---- what the script asks for ---- */

static bool one_of(lua_State *L, const char *key, const char *usual, const char *other) {
  hk_lua_field(L, 2, key);
  const char *word = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : lua_isnil(L, -1) ? usual : "";
  bool is_other = strcmp(word, other) == 0;
  if (!is_other && strcmp(word, usual) != 0)
    hk_lua_fail(L, HK_BAD_PARAM, "implicit: %s: expected \"%s\" or \"%s\"", key, usual, other);
  lua_pop(L, 1);
  return is_other;
}

static void read_box(lua_State *L, const hk_script_shape *s, hk_implicit_request *r) {
  if (hk_lua_field(L, 2, "box") == LUA_TNIL) {
    if (!hk_implicit_box(&s->shape, r->low, r->high))
      hk_lua_fail(
          L, HK_BAD_PARAM,
          "implicit: box is required where a function may be inside anywhere: { { x, y, z }, { x, y, z } }, its "
          "lower and its upper corner in m");
    for (int c = 0; c < 3; c++) r->low[c] -= r->cell, r->high[c] += r->cell;
    return;
  }
  if (!lua_istable(L, -1))
    hk_lua_fail(L, HK_BAD_PARAM, "implicit: box: expected two corners, { { x, y, z }, { x, y, z } }");
  lua_rawgeti(L, -1, 1);
  hk_lua_vector(L, -1, "implicit: box: the lower corner", r->low);
  lua_rawgeti(L, -2, 2);
  hk_lua_vector(L, -1, "implicit: box: the upper corner", r->high);
  for (int c = 0; c < 3; c++)
    if (!(r->low[c] < r->high[c]))
      hk_lua_fail(L, HK_BAD_PARAM,
                  "implicit: box: from %g m to %g m along %c: the first corner has to be the lower one", r->low[c],
                  r->high[c], 'x' + c);
}

static void shape_bounds(const void *self, const double low[3], const double high[3], double range[2]) {
  hk_implicit_bounds(&((const hk_script_shape *)self)->shape, low, high, range);
}

/* A grid of triangles has its points half a cell off the faces of the box, one of tetrahedra on them and beyond. */
static void close_box(hk_implicit_request *r, hk_boxed_shape *boxed) {
  memcpy(boxed->low, r->low, sizeof boxed->low);
  memcpy(boxed->high, r->high, sizeof boxed->high);
  for (int c = 0; c < 3; c++) {
    double length = r->high[c] - r->low[c], cell = length / fmax(1, ceil(length / r->cell * (1 - 1e-12)));
    r->low[c] -= r->solid ? cell : cell / 2, r->high[c] += r->solid ? cell : cell / 2;
  }
  if (r->bounds) r->bounds = hk_boxed_shape_bounds;
  r->evaluate = hk_boxed_shape_evaluate;
  r->self = boxed;
}

/* As few of the corners as 150,000, but no fewer than every fourth: calls of 0.2 us or so. */
static unsigned usual_coarse(const hk_implicit_request *r) {
  double corners = 1;
  for (int c = 0; c < 3; c++) corners *= (r->high[c] - r->low[c]) / r->cell + 1;
  return corners <= 1.5e5 ? 1 : corners <= 8 * 1.5e5 ? 2 : 4;
}

static hk_implicit_request read_request(lua_State *L, const hk_script_shape *s, result as, hk_boxed_shape *boxed) {
  hk_implicit_request r = {.evaluate = hk_script_shape_evaluate, .self = s, .solid = as == AS_SOLID};
  r.cell = hk_lua_field_number(L, 2, "implicit", "size", NAN);
  if (isnan(r.cell)) hk_lua_fail(L, HK_BAD_PARAM, "implicit: size is required, that of a cell in m");
  if (!(r.cell > 0)) hk_lua_fail(L, HK_BAD_PARAM, "implicit: size: %g m has to be above 0", r.cell);
  read_box(L, s, &r);
  r.cubes = one_of(L, "method", "tetrahedra", "cubes");
  r.coarse = (unsigned)hk_lua_field_whole(L, 2, "implicit", "coarse", usual_coarse(&r), 1000);
  if (r.coarse == 0) hk_lua_fail(L, HK_BAD_PARAM, "implicit: coarse: 0 is not a number of cells, 1 to 1000");
  if (!hk_implicit_has_function(&s->shape)) r.bounds = shape_bounds;
  if (hk_lua_field_flag(L, 2, "implicit", "close")) close_box(&r, boxed);
  r.most_bytes = hk_limits_left(hk_lua_script(L));
  return r;
}

static result read_result(lua_State *L) {
  static const char *const common[] = {"as", "size", "box", "method", "close", "coarse", "group", NULL};
  static const char *const body[] = {"position", "orientation", "path", "rotation", "fastest", "mass", "density", NULL};
  static const char *const solid[] = {"mass", "density", "E", NULL}, *const none[] = {NULL};
  const char *keys[40];
  int count = 0;
  hk_lua_field(L, 2, "as");
  const char *word = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : lua_isnil(L, -1) ? "body" : "";
  result as = strcmp(word, "solid") == 0 ? AS_SOLID : strcmp(word, "surface") == 0 ? AS_SURFACE : AS_BODY;
  if (as == AS_BODY && strcmp(word, "body") != 0)
    hk_lua_fail(
        L, HK_BAD_PARAM,
        "implicit: as: expected \"body\" (triangles of particles), \"solid\" (tetrahedra) or \"surface\" (numbers)");
  lua_pop(L, 1);
  const char *const *lists[] = {hk_shape_keys, common, as == AS_BODY ? body : as == AS_SOLID ? solid : none};
  for (int k = 0; k < 3; k++)
    for (const char *const *key = lists[k]; *key; key++) keys[count++] = *key;
  keys[count] = NULL;
  hk_lua_check_keys(L, 2, "implicit", keys);
  return as;
}

/* The clock of the script stands still while the engine works, but for its functions. */
static void find_mesh(lua_State *L, hk_scene *scene, hk_script_shape *s, const hk_implicit_request *r, hk_mesh *m) {
  hk_script *script = hk_lua_script(L);
  hk_error error = {0};
  bool inside = hk_limits_inside(script, false);
  hk_status status = find(scene->registry, r, m, &error);
  hk_limits_inside(script, inside);
  if (script->spent && script->limit.status != HK_OK) hk_lua_raise(L, &script->limit);
  if (s->error.status != HK_OK) hk_lua_raise(L, &s->error);
  if (status != HK_OK && s->shape.kind == HK_IMPLICIT_FUNCTION)
    hk_lua_fail(L, status, "%s (the field is %s)", error.text,
                s->shape.below ? "level - f, as inside = \"below\"" : "f - level; inside = \"below\" turns it round");
  if (status != HK_OK) hk_lua_raise(L, &error);
}

int hk_build_implicit(lua_State *L) {
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_script_shape s;
  hk_boxed_shape boxed = {.shape = &s.shape};
  hk_lua_check_table(L, 2, "implicit", "scene:implicit { ... }");
  lua_settop(L, 2);
  result as = read_result(L);
  hk_mesh *m = hk_mesh_new(L);
  hk_script_shape_read(L, 2, &s);
  hk_implicit_request request = read_request(L, &s, as, &boxed);
  find_mesh(L, scene, &s, &request, m);
  if (as == AS_BODY)
    hk_body_enter(L, scene, m, "implicit");
  else if (as == AS_SOLID)
    hk_solid_enter(L, scene, m, "implicit");
  else
    hk_mesh_push_numbers(L, m);
  hk_mesh_clear(m);
  return 1;
}
