/* scene:body{ shape = "sphere" | "box" | "capsule" | "cylinder" | "plane" | "mesh" }: what is solid, as particles and
 * the triangles of its surface. Without a mass its particles are pinned, and move together as `path` and `rotation`
 * say; contact keeps others off them. With `mass` or `density` they are free, and forces may make the closed mesh a
 * soft body. Round shapes are inscribed polyhedra, see body_shapes.h. */
#include "core/app/builders/mesh_handle.h"
#include "core/engine/text/text.h"

#include <stdio.h>
#include <string.h>

static const double default_detail = 1e-3, least_detail = 1e-6, most_detail = 0.2;

static double positive(lua_State *L, const char *key, double otherwise) {
  double value = hk_lua_field_number(L, 2, "body", key, otherwise);
  if (!(value > 0)) hk_lua_fail(L, HK_BAD_PARAM, "body: %s: a length in m above 0 has to be given", key);
  return value;
}

/* ---- shapes ---- */

static double read_detail(lua_State *L) {
  double detail = hk_lua_field_number(L, 2, "body", "detail", default_detail);
  if (!(detail >= least_detail && detail <= most_detail))
    hk_lua_fail(L, HK_BAD_PARAM, "body: detail: %g is not from %g to %g, the depth of a facet in radii", detail,
                least_detail, most_detail);
  return detail;
}

static const char *add_sphere(lua_State *L, hk_mesh *m) {
  return hk_mesh_add_sphere(m, positive(L, "radius", NAN), read_detail(L));
}

static const char *add_capsule(lua_State *L, hk_mesh *m) {
  return hk_mesh_add_capsule(m, positive(L, "radius", NAN), positive(L, "length", NAN), read_detail(L));
}

static const char *add_cylinder(lua_State *L, hk_mesh *m) {
  return hk_mesh_add_cylinder(m, positive(L, "radius", NAN), positive(L, "length", NAN), read_detail(L));
}

static const char *add_box(lua_State *L, hk_mesh *m) {
  double size[3];
  if (hk_lua_field(L, 2, "size") == LUA_TTABLE)
    hk_lua_vector(L, -1, "body: size", size);
  else
    size[0] = size[1] = size[2] = positive(L, "size", NAN);
  if (!(size[0] > 0 && size[1] > 0 && size[2] > 0))
    hk_lua_fail(L, HK_BAD_PARAM, "body: size: {%g, %g, %g}: lengths have to be above 0", size[0], size[1], size[2]);
  return hk_mesh_add_box(m, size);
}

static const char *add_plane(lua_State *L, hk_mesh *m) { return hk_mesh_add_square(m, positive(L, "size", NAN)); }

static const char *add_mesh(lua_State *L, hk_mesh *m) {
  double scale = positive(L, "scale", 1);
  if (hk_lua_field(L, 2, "file") != LUA_TSTRING) hk_lua_fail(L, HK_BAD_PARAM, "body: file: expected an OBJ file");
  hk_mesh_load(L, m, "body", lua_tostring(L, -1));
  for (size_t k = 0; k < 3 * m->vertices; k++) m->vertex[k] *= scale;
  return NULL;
}

/* A key of the table belongs to the shapes that take it; those for all shapes come last. */
static const struct shape {
  const char *name;
  const char *(*add)(lua_State *, hk_mesh *);
  const char *keys[16];
} shapes[] = {
#define FOR_ALL "shape", "position", "orientation", "path", "rotation", "fastest", "mass", "density", "group", NULL
    {"sphere", add_sphere, {"radius", "detail", FOR_ALL}},
    {"box", add_box, {"size", FOR_ALL}},
    {"capsule", add_capsule, {"radius", "length", "detail", FOR_ALL}},
    {"cylinder", add_cylinder, {"radius", "length", "detail", FOR_ALL}},
    {"plane", add_plane, {"size", FOR_ALL}},
    {"mesh", add_mesh, {"file", "scale", FOR_ALL}},
#undef FOR_ALL
};

enum { SHAPES = sizeof shapes / sizeof *shapes };

static const char *shape_at(const void *context, size_t k) {
  (void)context;
  return k < SHAPES ? shapes[k].name : NULL;
}

static const struct shape *read_shape(lua_State *L) {
  if (hk_lua_field(L, 2, "shape") != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "body: shape: expected sphere, box, capsule, cylinder, plane or mesh");
  const char *name = lua_tostring(L, -1);
  for (size_t k = 0; k < SHAPES; k++)
    if (strcmp(name, shapes[k].name) == 0) return &shapes[k];
  const char *near = hk_nearest_name(name, shape_at, NULL);
  hk_lua_fail(L, HK_BAD_PARAM, "body: shape: there is no '%s'; %s%s%s", name, near ? "did you mean '" : "",
              near ? near : "there are sphere, box, capsule, cylinder, plane and mesh", near ? "'?" : "");
}

/* ---- where it is, and how it moves ---- */

static void put_in_place(lua_State *L, hk_mesh *m, const char *what, const double position[3]) {
  double turn[3] = {0}, R[9];
  hk_lua_field_vector(L, 2, what, "orientation", turn);
  hk_rotation(turn, R);
  for (size_t i = 0; i < m->vertices; i++) {
    double *x = m->vertex + 3 * i, at[3];
    for (int c = 0; c < 3; c++) at[c] = position[c] + R[3 * c] * x[0] + R[3 * c + 1] * x[1] + R[3 * c + 2] * x[2];
    memcpy(x, at, sizeof at);
  }
}

static void read_motion(lua_State *L, const char *what, hk_pin_spec *pin) {
  bool path = hk_lua_field_function(L, 2, what, "path", &pin->path);
  bool rotation = hk_lua_field_function(L, 2, what, "rotation", &pin->rotation);
  if (path || rotation) pin->kind = HK_PIN_PATH;
  if (hk_lua_field(L, 2, "fastest") == LUA_TNIL) return;
  if (pin->kind == HK_PIN_FIXED) hk_lua_fail(L, HK_BAD_PARAM, "%s: fastest: it has no path that could change", what);
  char text[64];
  snprintf(text, sizeof text, "%s: fastest", what);
  pin->fastest = hk_lua_fastest(L, text);
}

static void hold(lua_State *L, hk_scene *scene, hk_pin_spec *pin, const hk_lua_handle *h) {
  hk_error error = {0};
  pin->count = h->count;
  pin->id = lua_newuserdatauv(L, (h->count + 1) * sizeof *pin->id, 0);
  for (uint32_t k = 0; k < h->count; k++) pin->id[k] = h->first + k;
  pin->where = (char *)(uintptr_t)hk_lua_where(L); /* hk_scene_add_pin copies it */
  hk_limits_take(L, sizeof *pin + h->count * sizeof *pin->id);
  if (hk_scene_add_pin(scene, pin, &error) != HK_OK) hk_lua_raise(L, &error);
}

/* ---- */

static bool is_free(lua_State *L) {
  return hk_lua_field(L, 2, "mass") != LUA_TNIL || hk_lua_field(L, 2, "density") != LUA_TNIL;
}

static hk_lua_handle add_particles(lua_State *L, hk_scene *scene, const char *what, const hk_mesh *m, bool free) {
  double density = NAN, mass = free ? hk_lua_mass(L, 2, what, &density) : 0;
  const double *each = density > 0 ? hk_mesh_push_masses(L, m, what, density) : NULL;
  hk_lua_handle h = {.count = (uint32_t)m->vertices, .nx = (uint32_t)m->vertices, .ny = 1};
  h.first = hk_lua_add(L, scene, what, m->vertices, m->vertex, NULL, each, mass / (double)m->vertices,
                       hk_lua_group(L, scene, 2, what));
  return h;
}

void hk_body_enter(lua_State *L, hk_scene *scene, hk_mesh *m, const char *what) {
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .release = INFINITY};
  hk_lua_field_vector(L, 2, what, "position", pin.center);
  read_motion(L, what, &pin);
  bool free = is_free(L);
  if (free && pin.kind == HK_PIN_PATH)
    hk_lua_fail(L, HK_BAD_PARAM,
                "%s: one with a mass is free and has no path: leave the mass out, or pin some of its "
                "particles with scene:pin",
                what);
  put_in_place(L, m, what, pin.center);
  hk_lua_handle h = add_particles(L, scene, what, m, free);
  if (!free) hold(L, scene, &pin, &h);
  hk_mesh_enter(L, scene, m, h, free);
}

int hk_build_body(lua_State *L) {
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "body", "scene:body { ... }");
  lua_settop(L, 2);
  const struct shape *shape = read_shape(L);
  hk_lua_check_keys(L, 2, "body", shape->keys);
  lua_settop(L, 2);
  hk_mesh *m = hk_mesh_new(L);
  const char *wrong = shape->add(L, m);
  if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "body: %s: %s", shape->name, wrong);
  hk_body_enter(L, scene, m, "body");
  return 1;
}
