/* scene:rigid{ shape = "sphere" | "box" | "capsule" | "cylinder" }, { mesh = "file.obj" }, { points =, masses = }, {
 * parts = } or { mass =, inertia = }: a rigid body as two to four particles with its mass, centre and moments
 * (scene/rigid), held at their distances by a constraint. `position` is the place of the origin of its frame,
 * `velocity` that of its centre of mass, `spin` in rad/s along the axes of the scene. */
#include "core/app/builders/rigid.h"

#include <string.h>

static void check_moments(lua_State *L, const hk_moments *m, hk_rigid_body *b) {
  const char *wrong = hk_rigid_body_of(m, b);
  if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "rigid: %s", wrong);
}

static void add_particles(lua_State *L, hk_scene *scene, hk_lua_rigid *r) {
  double position[3] = {0}, velocity[3] = {0}, spin[3] = {0}, R[9], x[12], v[12];
  hk_error error = {0};
  uint32_t pair[6][2];
  size_t pairs = 0;
  hk_lua_field_vector(L, 2, "rigid", "position", position);
  hk_lua_field_vector(L, 2, "rigid", "velocity", velocity);
  hk_lua_field_vector(L, 2, "rigid", "spin", spin);
  hk_rigid_read_orientation(L, 2, R);
  hk_rigid_body_place(&r->body, position, R, velocity, spin, x, v);
  r->first = hk_lua_add(L, scene, "rigid", r->body.count, x, v, NULL, r->body.mass / (double)r->body.count,
                        hk_lua_group(L, scene, 2, "rigid"));
  for (uint32_t i = 0; i < r->body.count; i++)
    for (uint32_t j = i + 1; j < r->body.count; j++, pairs++) pair[pairs][0] = r->first + i, pair[pairs][1] = r->first + j;
  hk_limits_take(L, 4 * pairs * sizeof *pair);
  const char *where = hk_lua_where(L);
  if (hk_scene_add_distances(scene, where, pairs, (const uint32_t(*)[2])pair, &error) != HK_OK)
    hk_lua_raise_for(L, "rigid", &error);
  lua_pop(L, 1);
}

/* The weights of the frame's origin, and of its axes. A flat body has none across it, a rod one axis only. */
static void add_skin(lua_State *L, hk_scene *scene, const hk_lua_rigid *r, const hk_mesh *m) {
  hk_error error = {0};
  hk_body_skin skin = {.carriers = (uint32_t)r->body.count, .vertices = m->vertices, .triangles = m->triangles};
  if (m->triangles == 0 || r->body.dimensions < 3) return;
  hk_rigid_body_weights(&r->body, (const double[3]){0}, skin.origin);
  for (int k = 0; k < 3; k++) {
    double unit[3] = {k == 0, k == 1, k == 2};
    hk_rigid_body_weights(&r->body, unit, skin.axis[k]);
    for (int c = 0; c < HK_CARRIERS; c++) skin.axis[k][c] -= skin.origin[c];
  }
  for (uint32_t c = 0; c < skin.carriers; c++) skin.carrier[c] = r->first + c;
  skin.vertex = m->vertex;
  skin.triangle = (const uint32_t(*)[3])m->triangle;
  hk_limits_take(L, m->vertices * 3 * sizeof(double) + m->triangles * sizeof *m->triangle + sizeof skin);
  if (hk_scene_add_skin(scene, &skin, &error) != HK_OK) hk_lua_raise_for(L, "rigid", &error);
}

int hk_build_rigid(lua_State *L) {
  static const char *const keys[] = {"shape",   "radius",  "length",   "size",        "mesh",     "scale", "points", "masses",
                                     "parts",   "mass",    "density",  "inertia",     "position", "orientation",
                                     "velocity", "spin",   "group",    NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_rigid r = {0};
  hk_lua_check_table(L, 2, "rigid", "scene:rigid { ... }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "rigid", keys);
  hk_mesh *skin = hk_mesh_new(L);
  hk_moments moments = hk_rigid_read(L, skin);
  check_moments(L, &moments, &r.body);
  add_particles(L, scene, &r);
  add_skin(L, scene, &r, skin);
  hk_mesh_clear(skin);
  hk_rigid_push(L, 1, &r);
  return 1;
}
