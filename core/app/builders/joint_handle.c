/* What scene:joint returns: joint:angle(state), :way, :speed of what is free, :force and :torque of what is kept, and
 * joint:frame() before the run, the four points by which forces on joints and stops know it. */
#include "core/app/builders/builders.h"
#include "core/app/builders/rigid_bodies.h"

#include <string.h>

static const char joint_type[] = "hooke.joint";

/* ---- points ---- */

static hk_rigid_motion start_of(const hk_scene *scene, const hk_lua_rigid *r) {
  size_t first = 3 * (size_t)(r->first - 1);
  return hk_rigid_motion_of(&r->body, scene->particles.position + first, scene->particles.velocity + first);
}

/* A vector of the scene in a frame that is turned by R. */
static void turn_back(const double R[9], const double u[3], double y[3]) {
  for (int c = 0; c < 3; c++) y[c] = R[c] * u[0] + R[3 + c] * u[1] + R[6 + c] * u[2];
}

/* The place of a point of the scene in the frame of the body, at the start. */
static void to_body(const hk_scene *scene, const hk_lua_rigid *r, const double at[3], double y[3]) {
  hk_rigid_motion m = start_of(scene, r);
  double from_center[3];
  for (int c = 0; c < 3; c++) from_center[c] = at[c] - m.center[c];
  turn_back(m.attitude, from_center, y);
  for (int c = 0; c < 3; c++) y[c] += r->body.center[c];
}

static uint32_t point_on(lua_State *L, hk_scene *scene, const hk_lua_rigid *r, const double at[3]) {
  double y[3];
  to_body(scene, r, at, y);
  return hk_rigid_add_point(L, scene, r, y);
}

/* A particle that is held where it is. */
static uint32_t point_at_rest(lua_State *L, hk_scene *scene, const hk_lua_joint *j, const double at[3]) {
  hk_error error = {0};
  uint32_t id = hk_lua_add(L, scene, "joint", 1, at, NULL, NULL, 0, scene->particles.group[j->a.first - 1]);
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = 1, .id = &id, .release = INFINITY};
  pin.where = (char *)(uintptr_t)hk_lua_where(L); /* hk_scene_add_pin copies it */
  if (hk_scene_add_pin(scene, &pin, &error) != HK_OK) hk_lua_raise_for(L, "joint", &error);
  lua_pop(L, 1);
  return id;
}

uint32_t hk_joint_point(lua_State *L, hk_scene *scene, const hk_lua_joint *j, bool of_a, const double at[3]) {
  if (of_a) return point_on(L, scene, &j->a, at);
  if (j->has_b) return point_on(L, scene, &j->b, at);
  return j->particle ? j->particle : point_at_rest(L, scene, j, at);
}

/* ---- what it knows ---- */

/* The place in both frames, and how a and the axis are turned in that of b; what stands still has the scene's. */
static void note_frames(const hk_scene *scene, hk_lua_joint *it) {
  hk_rigid_motion a = start_of(scene, &it->a), b = {.attitude = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  to_body(scene, &it->a, it->at, it->in_a);
  memcpy(it->in_b, it->at, sizeof it->in_b);
  if (it->has_b) {
    b = start_of(scene, &it->b);
    to_body(scene, &it->b, it->at, it->in_b);
  }
  turn_back(b.attitude, it->axis, it->axis_b);
  for (int c = 0; c < 3; c++)
    for (int d = 0; d < 3; d++) {
      double sum = 0;
      for (int e = 0; e < 3; e++) sum += b.attitude[3 * e + c] * a.attitude[3 * e + d];
      it->turned[3 * c + d] = sum;
    }
}

void hk_joint_push(lua_State *L, int scene, const hk_lua_joint *from) {
  scene = lua_absindex(L, scene);
  hk_lua_joint *j = lua_newuserdatauv(L, sizeof *j, 1);
  *j = *from;
  note_frames(hk_lua_scene(L, scene), j);
  lua_pushvalue(L, scene);
  lua_setiuservalue(L, -2, 1);
  luaL_setmetatable(L, joint_type);
}

static hk_scene *scene_of(lua_State *L) {
  lua_getiuservalue(L, 1, 1);
  hk_scene *scene = hk_lua_scene(L, lua_gettop(L));
  lua_pop(L, 1);
  return scene;
}

/* The joint at 1, which has to be of the one or the other kind. */
static hk_lua_joint *self(lua_State *L, int kind, int other, const char *what) {
  hk_lua_joint *j = hk_lua_self(L, joint_type, "joint:force(state)");
  const char *needed[2] = {kind == HK_JOINT_HINGE ? "hinge" : "slider", "slider"};
  if (j->kind != kind && j->kind != other)
    hk_lua_fail(L, HK_BAD_PARAM, "a joint of the kind %s has no %s; a %s%s%s has", j->kind_name, what, needed[0],
                other == kind ? "" : " or a ", other == kind ? "" : needed[1]);
  return j;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void turned(const double R[9], const double y[3], double u[3]) {
  for (int c = 0; c < 3; c++) u[c] = dot(R + 3 * c, y);
}

/* ---- what is free ---- */

/* How both move; what stands still has the attitude of the scene. */
typedef struct motions {
  hk_rigid_motion a, b;
  double place[2][3], axis[3]; /* m, of the joint's points on a and b; now */
} motions;

static motions motions_of(lua_State *L, const hk_lua_joint *j, const char *form) {
  motions m = {.a = hk_rigid_motion_at(L, &j->a, form), .b = {.attitude = {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  memcpy(m.place[1], j->at, sizeof m.place[1]);
  hk_rigid_place_of(&j->a.body, &m.a, j->in_a, m.place[0]);
  if (j->has_b) {
    m.b = hk_rigid_motion_at(L, &j->b, form);
    hk_rigid_place_of(&j->b.body, &m.b, j->in_b, m.place[1]);
  }
  turned(m.b.attitude, j->axis_b, m.axis);
  return m;
}

/* How far a has turned in b about the axis: of the rotation Q = (R_b^T R_a) (R_b^T R_a at the start)^T, whose
 * antisymmetric part has the sine, whose trace the cosine. */
static double angle_of(const hk_lua_joint *j, const motions *m) {
  double now[9], Q[9];
  for (int c = 0; c < 9; c++) {
    now[c] = 0;
    for (int e = 0; e < 3; e++) now[c] += m->b.attitude[3 * e + c / 3] * m->a.attitude[3 * e + c % 3];
  }
  for (int c = 0; c < 9; c++) Q[c] = dot(now + c / 3 * 3, j->turned + c % 3 * 3);
  double off[3] = {Q[7] - Q[5], Q[2] - Q[6], Q[3] - Q[1]};
  return atan2(dot(off, j->axis_b), Q[0] + Q[4] + Q[8] - 1);
}

/* rad, from -pi to pi, 0 at the start. */
static int angle(lua_State *L) {
  const hk_lua_joint *j = self(L, HK_JOINT_HINGE, HK_JOINT_HINGE, "angle");
  motions m = motions_of(L, j, "joint:angle(state)");
  lua_pushnumber(L, angle_of(j, &m));
  return 1;
}

/* m, 0 at the start. */
static int way(lua_State *L) {
  const hk_lua_joint *j = self(L, HK_JOINT_SLIDER, HK_JOINT_SLIDER, "way");
  motions m = motions_of(L, j, "joint:way(state)");
  double far[3];
  for (int c = 0; c < 3; c++) far[c] = m.place[0][c] - m.place[1][c];
  lua_pushnumber(L, dot(far, m.axis));
  return 1;
}

static void velocity_at(const hk_rigid_motion *m, const double place[3], double v[3]) {
  double r[3];
  for (int c = 0; c < 3; c++) r[c] = place[c] - m->center[c];
  for (int c = 0, d = 1, e = 2; c < 3; c++, d = (d + 1) % 3, e = (e + 1) % 3)
    v[c] = m->velocity[c] + m->spin[d] * r[e] - m->spin[e] * r[d];
}

/* Of a hinge rad/s, of a slider m/s: of the point of a against the point of b that is there. */
static int speed(lua_State *L) {
  const hk_lua_joint *j = self(L, HK_JOINT_HINGE, HK_JOINT_SLIDER, "speed");
  motions m = motions_of(L, j, "joint:speed(state)");
  double a[3], b[3], off[3];
  velocity_at(&m.a, m.place[0], a);
  velocity_at(&m.b, m.place[0], b);
  for (int c = 0; c < 3; c++) off[c] = j->kind == HK_JOINT_HINGE ? m.a.spin[c] - m.b.spin[c] : a[c] - b[c];
  lua_pushnumber(L, dot(off, m.axis));
  return 1;
}

/* ---- what is kept: forces on the points of a, N ---- */

typedef struct loads {
  lua_State *L;
  hk_run *run;
  const hk_scene *scene;
  const hk_lua_joint *joint;
  double about[3];            /* m */
  double force[3], torque[3]; /* N; N m about that place */
} loads;

static bool is_of_a(const loads *l, uint32_t id) {
  const hk_particles *p = &l->scene->particles;
  size_t low = 0, high = p->riders;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (p->rider[middle].particle < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < p->riders && p->rider[low].particle == id && p->rider[low].carrier[0] == l->joint->a.first;
}

static const double *place_of(const loads *l, uint32_t id) {
  uint32_t i = 0;
  if (!hk_run_index(l->run, id, &i)) hk_lua_fail(l->L, HK_BAD_PARAM, "particle %d of the joint is no more", (int)id);
  return hk_run_view(l->run)->x + 3 * (size_t)i;
}

static void add_load(loads *l, uint32_t id, const double f[3]) {
  if (!is_of_a(l, id)) return;
  const double *x = place_of(l, id);
  for (int c = 0, d = 1, e = 2; c < 3; c++, d = (d + 1) % 3, e = (e + 1) % 3) {
    l->force[c] += f[c];
    l->torque[c] += (x[d] - l->about[d]) * f[e] - (x[e] - l->about[e]) * f[d];
  }
}

/* lambda times (q - p)/by on p, and the opposite on q. */
static void add_pair(loads *l, uint32_t p, uint32_t q, const double f[3]) {
  double opposite[3] = {-f[0], -f[1], -f[2]};
  add_load(l, p, f);
  add_load(l, q, opposite);
}

static double between(const loads *l, uint32_t p, uint32_t q, double by, double f[3]) {
  const double *x = place_of(l, p), *y = place_of(l, q);
  for (int c = 0; c < 3; c++) f[c] = by * (y[c] - x[c]);
  return sqrt(dot(f, f));
}

/* g = L - |q - p|: its gradient at p is along q - p. */
static void add_distance(loads *l, const uint32_t *id, const double *lambda) {
  double f[3], length = between(l, id[0], id[1], 1, f);
  between(l, id[0], id[1], *lambda / length, f);
  add_pair(l, id[0], id[1], f);
}

/* g = q - p. */
static void add_difference(loads *l, const uint32_t *id, const double *lambda) { add_pair(l, id[1], id[0], lambda); }

/* g = (b - a).(d - c)/l. */
static void add_way(loads *l, const uint32_t *id, const double *lambda) {
  double f[3], length = between(l, id[2], id[3], 1, f);
  between(l, id[2], id[3], *lambda / length, f);
  add_pair(l, id[1], id[0], f);
  between(l, id[0], id[1], *lambda / length, f);
  add_pair(l, id[3], id[2], f);
}

/* The tuples of the joint in one list of the scene, each with `equations` multipliers. */
static void add_list(loads *l, const hk_kept_tuples *kept, hk_joint_range part, size_t equations,
                     void add(loads *, const uint32_t *, const double *)) {
  hk_error error = {0};
  size_t count = 0;
  if (part.count == 0) return;
  if (hk_run_equations(l->run, kept->spec->label, &count, &error) != HK_OK) hk_lua_raise(l->L, &error);
  if (count != kept->tuples.count * equations)
    hk_lua_fail(l->L, HK_BAD_PARAM,
                "joint: particles of the constraint '%s' are no more, and so its forces are unknown",
                kept->spec->label);
  double *lambda = lua_newuserdatauv(l->L, (count + 1) * sizeof *lambda, 0);
  if (hk_run_constraint_forces(l->run, kept->spec->label, lambda, &error) != HK_OK) hk_lua_raise(l->L, &error);
  for (size_t k = part.first; k < part.first + part.count; k++) {
    uint32_t id[4];
    for (unsigned c = 0; c < kept->tuples.arity; c++) id[c] = hk_tuple(&kept->tuples, k)[c] + 1;
    add(l, id, lambda + equations * k);
  }
  lua_pop(l->L, 1);
}

static loads loads_of(lua_State *L, const char *form) {
  hk_lua_joint *j = hk_lua_self(L, joint_type, form);
  loads l = {.L = L, .run = hk_lua_state_run(L, 2), .scene = scene_of(L), .joint = j};
  if (!l.run) hk_lua_fail(L, HK_BAD_PARAM, "expected a state, as in %s, got %s", form, hk_lua_kind(L, 2));
  hk_rigid_motion a = hk_rigid_motion_at(L, &j->a, form);
  hk_rigid_place_of(&j->a.body, &a, j->in_a, l.about);
  add_list(&l, &l.scene->distances, j->part[0], 1, add_distance);
  add_list(&l, &l.scene->differences, j->part[1], 3, add_difference);
  add_list(&l, &l.scene->ways, j->part[2], 1, add_way);
  return l;
}

/* N, on a. */
static int force(lua_State *L) {
  loads l = loads_of(L, "joint:force(state)");
  return hk_rigid_push_vector(L, l.force);
}

/* N m, on a, about the joint's point on a. */
static int torque(lua_State *L) {
  loads l = loads_of(L, "joint:torque(state)");
  return hk_rigid_push_vector(L, l.torque);
}

/* ---- the points of what is free ---- */

/* Of a slider b's point, a's point, and two points of b along the axis; of a hinge two points of b on the axis, and one
 * beside it of b and of a, opposite to each other at the start. */
static int frame(lua_State *L) {
  hk_lua_joint *j = self(L, HK_JOINT_HINGE, HK_JOINT_SLIDER, "frame");
  hk_scene *scene = scene_of(L);
  bool hinge = j->kind == HK_JOINT_HINGE;
  double side[3], other[3], place[4][3];
  if (scene->frozen) hk_lua_fail(L, HK_BAD_PARAM, "frame: the scene runs and can no longer be edited");
  hk_frame_across(j->axis, side, other);
  for (int c = 0; c < 3; c++) {
    double along = j->size * j->axis[c], across = j->size * side[c];
    place[0][c] = j->at[c];
    place[1][c] = j->at[c] + (hinge ? along : 0);
    place[2][c] = j->at[c] + (hinge ? across : along);
    place[3][c] = j->at[c] + (hinge ? -across : 2 * along);
  }
  size_t before = scene->particles.n;
  lua_createtable(L, 4, 0);
  for (int k = 0; k < 4; k++) {
    lua_pushinteger(L, hk_joint_point(L, scene, j, k == (hinge ? 3 : 1), place[k]));
    lua_rawseti(L, -2, k + 1);
  }
  if (!j->has_b) hk_scene_mark_joint(scene, before, false); /* places, which nothing is to meet */
  return 1;
}

/* ---- the handle ---- */

static const luaL_Reg methods[] = {{"angle", angle},   {"way", way},     {"speed", speed}, {"force", force},
                                   {"torque", torque}, {"frame", frame}, {NULL, NULL}};

static int member(lua_State *L) {
  const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
  for (const luaL_Reg *m = methods; m->name; m++)
    if (strcmp(m->name, name) == 0) {
      lua_pushcfunction(L, m->func);
      return 1;
    }
  return hk_lua_no_member(L, "a joint", hk_lua_method_name, methods, "it has functions of a state: joint:force(state)");
}

void hk_lua_open_joint(lua_State *L) {
  luaL_newmetatable(L, joint_type);
  lua_pushcfunction(L, member);
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
}
