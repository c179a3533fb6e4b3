/* scene:rigid{ shape = "sphere" | "box" | "capsule" | "cylinder" }, { mesh = "file.obj" }, { points =, masses = }, {
 * parts = } or { mass =, inertia = }: a rigid body as two to four particles with its mass, centre and moments
 * (scene/rigid), held at their distances by a constraint. `position` is the place of the origin of its frame,
 * `velocity` that of its centre of mass, `spin` in rad/s along the axes of the scene.
 *
 * Its handle: body:spin(state), :attitude(state) and the like are of the state that a measure or on_frame gets, or of
 * run:state(); body:point{x, y, z} makes a rider before the run, body:surface() those that contact takes: the vertices
 * of its triangles, or points that are named, which are balls with a radius, and capsules where they are joined. With a
 * radius triangles are moved inwards by it, so that what is a radius away from them has the faces that the body had,
 * and round edges and corners. */
#include "core/app/builders/mesh_handle.h"
#include "core/app/builders/rigid_bodies.h"

#include <stdlib.h>
#include <string.h>

static const char rigid_type[] = "hooke.rigid";
static const double farthest = 1e6; /* weight of a particle in a point of the body */

hk_lua_rigid *hk_rigid_push(lua_State *L, int scene, const hk_lua_rigid *from) {
  scene = lua_absindex(L, scene);
  hk_lua_rigid *r = lua_newuserdatauv(L, sizeof *r, 1);
  *r = *from;
  lua_pushvalue(L, scene);
  lua_setiuservalue(L, -2, 1);
  luaL_setmetatable(L, rigid_type);
  return r;
}

hk_lua_rigid *hk_rigid_to(lua_State *L, int index) { return luaL_testudata(L, index, rigid_type); }

static hk_lua_rigid *self(lua_State *L) { return hk_lua_self(L, rigid_type, "body:spin(state)"); }

static void push_numbers(lua_State *L, const double *list, int count) {
  lua_createtable(L, count, 0);
  for (int k = 0; k < count; k++) {
    lua_pushnumber(L, list[k]);
    lua_rawseti(L, -2, k + 1);
  }
}

/* ---- of a state ---- */

hk_rigid_motion hk_rigid_motion_at(lua_State *L, const hk_lua_rigid *r, const char *form) {
  double x[12], v[12];
  hk_run *run = hk_lua_state_run(L, 2);
  if (!run) hk_lua_fail(L, HK_BAD_PARAM, "expected a state, as in %s, got %s", form, hk_lua_kind(L, 2));
  for (uint32_t k = 0; k < r->body.count; k++) {
    uint32_t i = 0;
    if (!hk_run_index(run, r->first + k, &i))
      hk_lua_fail(L, HK_BAD_PARAM, "particle %d of the rigid body is no more", (int)(r->first + k));
    memcpy(x + 3 * k, hk_run_view(run)->x + 3 * (size_t)i, 3 * sizeof *x);
    memcpy(v + 3 * k, hk_run_view(run)->v + 3 * (size_t)i, 3 * sizeof *v);
  }
  return hk_rigid_motion_of(&r->body, x, v);
}

void hk_rigid_place_of(const hk_rigid_body *b, const hk_rigid_motion *m, const double y[3], double x[3]) {
  for (int c = 0; c < 3; c++) {
    x[c] = m->center[c];
    for (int d = 0; d < 3; d++) x[c] += m->attitude[3 * c + d] * (y[d] - b->center[d]);
  }
}

int hk_rigid_push_vector(lua_State *L, const double vector[3]) {
  push_numbers(L, vector, 3);
  return 1;
}

static int position(lua_State *L) {
  return hk_rigid_push_vector(L, hk_rigid_motion_at(L, self(L), "body:position(state)").center);
}
static int velocity(lua_State *L) {
  return hk_rigid_push_vector(L, hk_rigid_motion_at(L, self(L), "body:velocity(state)").velocity);
}
static int spin(lua_State *L) {
  return hk_rigid_push_vector(L, hk_rigid_motion_at(L, self(L), "body:spin(state)").spin);
}
static int momentum(lua_State *L) {
  return hk_rigid_push_vector(L, hk_rigid_motion_at(L, self(L), "body:momentum(state)").momentum);
}

static int energy(lua_State *L) {
  lua_pushnumber(L, hk_rigid_motion_at(L, self(L), "body:energy(state)").energy);
  return 1;
}

/* About the centre of mass, or about a place that is given. */
static int angular_momentum(lua_State *L) {
  hk_rigid_motion m = hk_rigid_motion_at(L, self(L), "body:angular_momentum(state)");
  double about[3];
  if (lua_isnoneornil(L, 3)) return hk_rigid_push_vector(L, m.angular_momentum);
  hk_lua_vector(L, 3, "body:angular_momentum(state, {x, y, z})", about);
  for (int c = 0, d = 1, e = 2; c < 3; c++, d = (d + 1) % 3, e = (e + 1) % 3)
    m.angular_momentum[c] += (m.center[d] - about[d]) * m.momentum[e] - (m.center[e] - about[e]) * m.momentum[d];
  return hk_rigid_push_vector(L, m.angular_momentum);
}

/* The quaternion {w, x, y, z}, and the matrix by rows. */
static int attitude(lua_State *L) {
  hk_rigid_motion m = hk_rigid_motion_at(L, self(L), "body:attitude(state)");
  double q[4];
  hk_quaternion_of(m.attitude, q);
  push_numbers(L, q, 4);
  lua_createtable(L, 3, 0);
  for (int r = 0; r < 3; r++) {
    push_numbers(L, m.attitude + 3 * r, 3);
    lua_rawseti(L, -2, r + 1);
  }
  return 2;
}

/* ---- of the body ---- */

static int ids(lua_State *L) {
  const hk_lua_rigid *r = self(L);
  lua_createtable(L, (int)r->body.count, 0);
  for (uint32_t k = 0; k < r->body.count; k++) {
    lua_pushinteger(L, r->first + k);
    lua_rawseti(L, -2, k + 1);
  }
  return 1;
}

/* The weights of the point y, of a body that has points there. */
static void find_weights(lua_State *L, const hk_lua_rigid *r, const double y[3], hk_rider *rider) {
  double off = hk_rigid_body_weights(&r->body, y, rider->weight);
  rider->carriers = (uint32_t)r->body.count;
  if (off > 1e-9 * r->body.a[0])
    hk_lua_fail(L, HK_BAD_PARAM,
                "point: {%g, %g, %g} lies %.4g m off the %s that the body is, which has no points there: give it an "
                "extent across",
                y[0], y[1], y[2], off, r->body.dimensions == 2 ? "plane" : "line");
  for (uint32_t k = 0; k < rider->carriers; k++)
    if (!(fabs(rider->weight[k]) < farthest))
      hk_lua_fail(
          L, HK_BAD_PARAM,
          "point: {%g, %g, %g} lies a million times as far off as the body reaches, %.3g m: no digits would be left",
          y[0], y[1], y[2], r->body.a[0]);
  for (uint32_t k = 0; k < rider->carriers; k++) rider->carrier[k] = r->first + k;
}

static uint32_t add_rider(lua_State *L, hk_scene *scene, const hk_lua_rigid *r, const double y[3], hk_rider rider) {
  hk_error error = {0};
  const double nowhere[3] = {0};
  find_weights(L, r, y, &rider);
  hk_limits_take(L, sizeof rider);
  rider.particle = hk_lua_add(L, scene, "point", 1, nowhere, NULL, NULL, 0, scene->particles.group[r->first - 1]);
  if (hk_scene_add_rider(scene, &rider, &error) != HK_OK) hk_lua_raise_for(L, "point", &error);
  return rider.particle;
}

uint32_t hk_rigid_add_point(lua_State *L, hk_scene *scene, const hk_lua_rigid *r, const double y[3]) {
  return add_rider(L, scene, r, y, (hk_rider){.touches = false});
}

/* radius: m, of what is round; 0: that which contact has for such points. */
static uint32_t add_touching(lua_State *L, hk_scene *scene, const hk_lua_rigid *r, const double y[3], double radius) {
  return add_rider(L, scene, r, y, (hk_rider){.touches = true, .radius = radius});
}

static hk_scene *editable(lua_State *L, const char *what) {
  lua_getiuservalue(L, 1, 1);
  hk_scene *scene = hk_lua_scene(L, -1);
  if (scene->frozen) hk_lua_fail(L, HK_BAD_PARAM, "%s: the scene runs and can no longer be edited", what);
  return scene;
}

static int point(lua_State *L) {
  const hk_lua_rigid *r = self(L);
  double y[3];
  hk_lua_vector(L, 2, "body:point{x, y, z}", y);
  hk_scene *scene = editable(L, "point");
  lua_pushinteger(L, hk_rigid_add_point(L, scene, r, y));
  return 1;
}

/* ---- body:surface() ---- */

static const char points_form[] = "body:surface { {x, y, z}, ... }";

/* m, 0: none is given. */
static double read_radius(lua_State *L, int options) {
  static const char *const keys[] = {"radius", "joined", NULL};
  if (lua_isnoneornil(L, options)) return 0;
  hk_lua_check_table(L, options, "surface", "{ radius = 0.1 }");
  hk_lua_check_keys(L, options, "surface", keys);
  double radius = hk_lua_field_number(L, options, "surface", "radius", 0);
  if (hk_lua_field(L, options, "radius") != LUA_TNIL && !(radius > 0 && isfinite(radius)))
    hk_lua_fail(L, HK_BAD_PARAM, "surface: radius: %g m is not above 0: leave it out, or give a length", radius);
  lua_pop(L, 1);
  return radius;
}

/* Points that follow each other become the ends of edges. */
static void join_points(lua_State *L, hk_scene *scene, uint32_t first, lua_Integer count) {
  hk_error error = {0};
  if (count < 2)
    hk_lua_fail(L, HK_BAD_PARAM, "surface: joined: %d point has nothing to be joined with: give two or more",
                (int)count);
  for (lua_Integer k = 0; k + 1 < count; k++) {
    const uint32_t pair[1][2] = {{first + (uint32_t)k, first + (uint32_t)k + 1}};
    hk_limits_take(L, sizeof pair);
    if (hk_scene_add_edges(scene, 1, pair, &error) != HK_OK) hk_lua_raise_for(L, "surface", &error);
  }
}

/* A list of ids. */
static int add_points(lua_State *L, hk_scene *scene, const hk_lua_rigid *r) {
  lua_Integer count = luaL_len(L, 2);
  double y[3], radius = read_radius(L, 3);
  uint32_t first = 0;
  lua_createtable(L, (int)count, 0);
  for (lua_Integer k = 1; k <= count; k++) {
    lua_geti(L, 2, k);
    hk_lua_vector(L, -1, points_form, y);
    lua_pop(L, 1);
    uint32_t id = add_touching(L, scene, r, y, radius);
    if (k == 1) first = id;
    lua_pushinteger(L, id);
    lua_rawseti(L, -2, k);
  }
  if (lua_istable(L, 3)) {
    hk_lua_field(L, 3, "joined");
    if (lua_toboolean(L, -1)) join_points(L, scene, first, count);
    lua_pop(L, 1);
  }
  return 1;
}

static hk_mesh *copy_skin(lua_State *L, const hk_body_skin *skin) {
  hk_mesh *m = hk_mesh_new(L);
  m->vertex = malloc((3 * skin->vertices + 1) * sizeof *m->vertex);
  m->triangle = malloc((skin->triangles + 1) * sizeof *m->triangle);
  if (!m->vertex || !m->triangle)
    hk_lua_fail(L, HK_NO_MEMORY, "surface: no memory for %d vertices", (int)skin->vertices);
  m->vertices = skin->vertices, m->triangles = skin->triangles;
  memcpy(m->vertex, skin->vertex, 3 * m->vertices * sizeof *m->vertex);
  memcpy(m->triangle, skin->triangle, m->triangles * sizeof *m->triangle);
  return m;
}

/* The vertices of its triangles, as a handle that has these and their sides. */
static int add_triangles(lua_State *L, hk_scene *scene, const hk_lua_rigid *r, double radius) {
  const hk_body_skin *skin = NULL;
  hk_lua_handle h = {.ny = 1};
  for (size_t k = 0; k < scene->particles.skins; k++)
    if (scene->particles.skin[k].carrier[0] == r->first) skin = &scene->particles.skin[k];
  if (!skin || skin->triangles == 0)
    hk_lua_fail(L, HK_BAD_PARAM, "surface: this body has no triangles: name points of it, as in %s", points_form);
  hk_mesh *m = copy_skin(L, skin);
  const char *wrong = radius > 0 ? hk_mesh_move_inwards(m, radius) : NULL;
  if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "surface: radius: %s", wrong);
  for (size_t k = 0; k < m->vertices; k++) {
    uint32_t id = add_touching(L, scene, r, m->vertex + 3 * k, radius);
    if (k == 0) h.first = id;
  }
  h.count = h.nx = (uint32_t)m->vertices;
  hk_mesh_enter(L, scene, m, h, false);
  return 1;
}

/* body:surface(), body:surface { radius = 0.1 }, body:surface({ {x, y, z}, ... }, { radius = 0.1, joined = true }). */
static int surface(lua_State *L) {
  const hk_lua_rigid *r = self(L);
  lua_settop(L, 3);
  hk_scene *scene = editable(L, "surface");
  bool points = lua_istable(L, 2) && luaL_len(L, 2) > 0;
  return points ? add_points(L, scene, r) : add_triangles(L, scene, r, read_radius(L, 2));
}

static const luaL_Reg methods[] = {{"ids", ids},
                                   {"point", point},
                                   {"surface", surface},
                                   {"position", position},
                                   {"velocity", velocity},
                                   {"attitude", attitude},
                                   {"spin", spin},
                                   {"momentum", momentum},
                                   {"angular_momentum", angular_momentum},
                                   {"energy", energy},
                                   {NULL, NULL}};

/* mass, center, inertia and axes, the principal ones as rows; and the methods. */
static int member(lua_State *L) {
  const hk_lua_rigid *r = hk_rigid_to(L, 1);
  const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
  for (const luaL_Reg *m = methods; m->name; m++)
    if (strcmp(m->name, name) == 0) {
      lua_pushcfunction(L, m->func);
      return 1;
    }
  if (strcmp(name, "mass") == 0)
    lua_pushnumber(L, r->body.mass);
  else if (strcmp(name, "center") == 0)
    push_numbers(L, r->body.center, 3);
  else if (strcmp(name, "inertia") == 0) {
    double I[3];
    for (int k = 0; k < 3; k++) I[k] = hk_rigid_body_inertia(&r->body, k);
    push_numbers(L, I, 3);
  } else if (strcmp(name, "axes") == 0) {
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
      push_numbers(L, (const double[3]){r->body.axes[k], r->body.axes[3 + k], r->body.axes[6 + k]}, 3);
      lua_rawseti(L, -2, k + 1);
    }
  } else
    return hk_lua_no_member(L, "a rigid body", hk_lua_method_name, methods,
                            "it has mass, center, inertia and axes, and functions of a state: body:spin(state)");
  return 1;
}

void hk_lua_open_rigid(lua_State *L) {
  luaL_newmetatable(L, rigid_type);
  lua_pushcfunction(L, member);
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
}

/* ---- the builder ---- */

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
  hk_rigid_check_digits(L, &r->body, position, x);
  r->first = hk_lua_add(L, scene, "rigid", r->body.count, x, v, NULL, r->body.mass / (double)r->body.count,
                        hk_lua_group(L, scene, 2, "rigid"));
  for (uint32_t i = 0; i < r->body.count; i++)
    for (uint32_t j = i + 1; j < r->body.count; j++, pairs++)
      pair[pairs][0] = r->first + i, pair[pairs][1] = r->first + j;
  hk_limits_take(L, 4 * pairs * sizeof *pair);
  const char *where = hk_lua_where(L);
  if (hk_scene_add_distances(scene, where, pairs, (const uint32_t(*)[2])pair, &error) != HK_OK)
    hk_lua_raise_for(L, "rigid", &error);
  lua_pop(L, 1);
}

/* The weights of the frame's origin, and of its axes. A flat body has none across it, a rod one axis only: these have
 * no triangles, and their skin says only which particles they are made of. */
static void add_skin(lua_State *L, hk_scene *scene, const hk_lua_rigid *r, const hk_mesh *m) {
  hk_error error = {0};
  hk_body_skin skin = {.carriers = (uint32_t)r->body.count};
  bool solid = m->triangles > 0 && r->body.dimensions == 3;
  if (solid) {
    skin.vertices = m->vertices, skin.triangles = m->triangles;
    hk_rigid_body_weights(&r->body, (const double[3]){0}, skin.origin);
  }
  for (int k = 0; k < 3 && solid; k++) {
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
  static const char *const keys[] = {"shape",    "radius",      "length",   "size", "mesh",    "scale",
                                     "points",   "masses",      "parts",    "mass", "density", "inertia",
                                     "position", "orientation", "velocity", "spin", "group",   NULL};
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
