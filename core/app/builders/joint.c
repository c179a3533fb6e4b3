/* scene:joint{ kind = "ball" | "hinge" | "slider" | "universal" | "fixed" | "distance", a =, b =, at =, axis = }: joins
 * a rigid body to another one, to a particle, or, without b, to the place where it is. A ball is two points of the
 * bodies (riders) that stay together, by the constraint that keeps differences, and so is the middle of every other
 * joint but a slider. What may not turn is kept by distances between further points, each of which forbids turning
 * about one direction, the same in the bodies at any attitude: two for a hinge, three for what is fixed, one for a
 * universal joint, between points on the axes of either body. So no equation follows from others. (Two points kept
 * together on the axis of a hinge are six equations of which one follows from others, another one as the axis turns.) A
 * slider keeps ways (b - a).(d - c)/l: those of its point on a from its point on b along two directions across the
 * axis, of b, and three between directions of a and of b, across each other, as where it is fixed. A distance is one
 * between `at` on a and `to` on b. All places are those of the start, in the scene's coordinates. joint_handle.c has
 * what is returned. */
#include "core/app/builders/rigid_bodies.h"
#include "core/engine/text/text.h"

#include <string.h>

static const char *const kind_name[HK_JOINTS + 1] = {"ball", "hinge", "slider", "universal", "fixed", "distance", NULL};
static const char kinds_in_words[] = "ball, hinge, slider, universal, fixed and distance";

/* Points of a joint are as far apart as this part of the larger body's extent. */
static const double spread = 1, meets = 1e-9;

typedef struct joint {
  lua_State *L;
  hk_scene *scene;
  hk_lua_joint it;
} joint;

static const char *kind_at(const void *context, size_t k) {
  (void)context;
  return kind_name[k];
}

static int read_kind(lua_State *L) {
  if (hk_lua_field(L, 2, "kind") != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "joint: kind: expected %s", kinds_in_words);
  const char *name = lua_tostring(L, -1);
  for (int k = 0; k < HK_JOINTS; k++)
    if (strcmp(name, kind_name[k]) == 0) return k;
  const char *near = hk_nearest_name(name, kind_at, NULL);
  return hk_lua_fail(L, HK_BAD_PARAM, "joint: kind: there is no '%s'; %s%s%s", name,
                     near ? "did you mean '" : "there are ", near ? near : kinds_in_words, near ? "'?" : "");
}

/* ---- points ---- */

static uint32_t on_a(const joint *j, const double at[3]) { return hk_joint_point(j->L, j->scene, &j->it, true, at); }
static uint32_t on_b(const joint *j, const double at[3]) { return hk_joint_point(j->L, j->scene, &j->it, false, at); }

static void keep(const joint *j, uint32_t p, uint32_t q, bool distance) {
  hk_error error = {0};
  const uint32_t pair[1][2] = {{p, q}};
  const char *where = hk_lua_where(j->L);
  hk_limits_take(j->L, 4 * sizeof pair);
  hk_status status = (distance ? hk_scene_add_distances : hk_scene_add_differences)(j->scene, where, 1, pair, &error);
  if (status != HK_OK) hk_lua_raise_for(j->L, "joint", &error);
  lua_pop(j->L, 1);
}

static void keep_way(const joint *j, uint32_t from, uint32_t to, uint32_t c, uint32_t d) {
  hk_error error = {0};
  const uint32_t points[1][4] = {{from, to, c, d}};
  const char *where = hk_lua_where(j->L);
  hk_limits_take(j->L, 4 * sizeof points);
  if (hk_scene_add_ways(j->scene, where, 1, points, &error) != HK_OK) hk_lua_raise_for(j->L, "joint", &error);
  lua_pop(j->L, 1);
}

static void along(const joint *j, const double axis[3], double by, double to[3]) {
  for (int c = 0; c < 3; c++) to[c] = j->it.at[c] + by * j->it.size * axis[c];
}

static uint32_t along_a(const joint *j, const double axis[3], double by) {
  double at[3];
  along(j, axis, by, at);
  return on_a(j, at);
}

static uint32_t along_b(const joint *j, const double axis[3], double by) {
  double at[3];
  along(j, axis, by, at);
  return on_b(j, at);
}

static void join_at(const joint *j, const double at[3]) {
  uint32_t p = on_a(j, at);
  keep(j, p, on_b(j, at), false);
}

/* ---- what a joint says ---- */

static bool read_axis(const joint *j, const char *key, double axis[3]) {
  char what[32];
  if (!hk_lua_field_vector(j->L, 2, "joint", key, axis)) return false;
  double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  strcpy(what, key);
  if (!(length > 0)) hk_lua_fail(j->L, HK_BAD_PARAM, "joint: %s: {0, 0, 0} has no direction", what);
  for (int c = 0; c < 3; c++) axis[c] /= length;
  return true;
}

static void need_axis(const joint *j, double axis[3]) {
  if (!read_axis(j, "axis", axis))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: axis: a %s needs one, {x, y, z}", kind_name[j->it.kind]);
}

static double distance(const double p[3], const double q[3]) {
  return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

/* The body at the top of the stack, of this scene; false: it is none. */
static bool read_body(const joint *j, const char *key, hk_lua_rigid *into) {
  const hk_lua_rigid *r = hk_rigid_to(j->L, -1);
  if (!r) return false;
  lua_getiuservalue(j->L, -1, 1);
  if (hk_lua_scene(j->L, lua_gettop(j->L)) != j->scene)
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: %s: this body is of another scene", key);
  lua_pop(j->L, 1);
  *into = *r;
  return true;
}

static void read_b(joint *j) {
  char known[64];
  int type = hk_lua_field(j->L, 2, "b"), kind = j->it.kind;
  j->it.has_b = read_body(j, "b", &j->it.b);
  if (j->it.has_b && j->it.b.first == j->it.a.first)
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: a and b are the same body");
  if (type == LUA_TNIL || j->it.has_b) return;
  double id = type == LUA_TNUMBER ? lua_tonumber(j->L, -1) : 0;
  if (!(id >= 1 && id <= (double)j->scene->particles.n && floor(id) == id))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: b: expected a rigid body or the id of a particle (%s)",
                hk_known_ids(known, j->scene->particles.n));
  j->it.particle = (uint32_t)id;
  if (kind != HK_JOINT_BALL && kind != HK_JOINT_DISTANCE)
    hk_lua_fail(j->L, HK_BAD_PARAM,
                "joint: b: a particle has no directions: a %s joins bodies; a ball or a distance "
                "would do",
                kind_name[kind]);
}

static const double *place_of_particle(const joint *j) {
  return j->it.particle ? j->scene->particles.position + 3 * (size_t)(j->it.particle - 1) : NULL;
}

static void read_place(joint *j) {
  hk_lua_joint *it = &j->it;
  bool given = hk_lua_field_vector(j->L, 2, "joint", "at", it->at), ball = it->kind == HK_JOINT_BALL;
  const double *there = place_of_particle(j);
  if (!given && !(there && ball))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: at: the place of the joint is required, {x, y, z}");
  if (!given) memcpy(it->at, there, sizeof it->at);
  it->size = spread * fmax(it->a.body.a[0], it->has_b ? it->b.body.a[0] : 0);
  double apart = there ? distance(it->at, there) : 0;
  if (ball && apart > meets * (it->size + fabs(it->at[0]) + fabs(it->at[1]) + fabs(it->at[2])))
    hk_lua_fail(j->L, HK_BAD_PARAM,
                "joint: at: particle %d is %.6g m off {%g, %g, %g}: the two have to meet at the start",
                (int)it->particle, apart, it->at[0], it->at[1], it->at[2]);
}

/* Whether the two bodies meet each other: at a joint their surfaces mostly touch or overlap, and would jam it. */
static bool read_contact(const joint *j) {
  int type = hk_lua_field(j->L, 2, "contact");
  if (type != LUA_TNIL && type != LUA_TBOOLEAN)
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: contact: expected true or false, got %s", hk_lua_kind(j->L, -1));
  if (type != LUA_TNIL && !j->it.has_b && !j->it.particle)
    hk_lua_fail(
        j->L, HK_BAD_PARAM,
        "joint: contact: it is for what is joined to a body or a particle, and there is no b: leave it out; what "
        "is not to touch is named in `leave` of the contact");
  bool meet = lua_toboolean(j->L, -1);
  lua_pop(j->L, 1);
  return meet;
}

/* ---- the kinds ---- */

/* The distance between the point at p (from the joint, in `size`) on a and that at p + u on b: for a small turn w of a
 * it changes by w.(p x u), whatever the attitude of the two. */
static void keep_turn(const joint *j, const double p[3], const double u[3]) {
  double sum[3] = {p[0] + u[0], p[1] + u[1], p[2] + u[2]};
  uint32_t point = along_a(j, p, 1);
  keep(j, point, along_b(j, sum, 1), true);
}

/* Turns about the two directions across the axis are kept. */
static void make_hinge(joint *j) {
  double *axis = j->it.axis, side[3], other[3];
  need_axis(j, axis);
  hk_frame_across(axis, side, other);
  join_at(j, j->it.at);
  keep_turn(j, axis, side);
  keep_turn(j, axis, other);
}

/* The angle between a direction of a and one of b, which start across each other, changes by w.(u x v) for a small turn
 * w of a, as the three pairs of axes do for all turns. */
static void make_slider(joint *j) {
  double *axis = j->it.axis, side[3], other[3];
  need_axis(j, axis);
  hk_frame_across(axis, side, other);
  const double *direction[3] = {axis, side, other};
  uint32_t a[3], b[3], on[2] = {on_a(j, j->it.at), on_b(j, j->it.at)};
  for (int c = 0; c < 3; c++) a[c] = along_a(j, direction[c], 1), b[c] = along_b(j, direction[c], 1);
  for (int c = 1; c < 3; c++) keep_way(j, b[0], on[0], on[1], b[c]);
  for (int c = 0; c < 3; c++) keep_way(j, on[0], a[c], on[1], b[(c + 1) % 3]);
}

static void make_fixed(const joint *j) {
  static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  join_at(j, j->it.at);
  for (int c = 0; c < 3; c++) keep_turn(j, axis[c], axis[(c + 1) % 3]);
}

/* The axis is fixed in a, axis_b, across it where it is not given, in b. */
static void make_universal(const joint *j) {
  double axis[3], other[3], third[3], apart[3];
  need_axis(j, axis);
  hk_frame_across(axis, other, third);
  read_axis(j, "axis_b", other);
  double cosine = axis[0] * other[0] + axis[1] * other[1] + axis[2] * other[2];
  if (!(fabs(cosine) < 0.99))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: axis_b: the axes of a universal joint have different directions");
  join_at(j, j->it.at);
  for (int c = 0; c < 3; c++) apart[c] = other[c] - axis[c];
  keep_turn(j, axis, apart);
}

static void make_distance(const joint *j) {
  double to[3];
  const double *there = place_of_particle(j);
  if (!hk_lua_field_vector(j->L, 2, "joint", "to", to) && !there)
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: to: a distance needs its other end, {x, y, z}");
  if (there) memcpy(to, there, sizeof to);
  if (!(distance(j->it.at, to) > 0))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: to: a distance of 0 m has no direction: use a ball");
  uint32_t point = on_a(j, j->it.at);
  keep(j, point, on_b(j, to), true);
}

static void make(joint *j) {
  switch (j->it.kind) {
  case HK_JOINT_BALL:
    join_at(j, j->it.at);
    break;
  case HK_JOINT_HINGE:
    make_hinge(j);
    break;
  case HK_JOINT_SLIDER:
    make_slider(j);
    break;
  case HK_JOINT_UNIVERSAL:
    make_universal(j);
    break;
  case HK_JOINT_FIXED:
    make_fixed(j);
    break;
  default:
    make_distance(j);
  }
}

/* ---- what its handle knows ---- */

static void note_counts(const hk_scene *scene, size_t count[3]) {
  count[0] = scene->distances.tuples.count;
  count[1] = scene->differences.tuples.count;
  count[2] = scene->ways.tuples.count;
}

int hk_build_joint(lua_State *L) {
  static const char *const keys[] = {"kind", "a", "b", "at", "axis", "axis_b", "to", "contact", NULL};
  joint j = {.L = L, .scene = hk_lua_scene(L, 1)};
  size_t first[3], end[3];
  hk_lua_check_table(L, 2, "joint", "scene:joint { kind = \"ball\", a = body, b = other, at = {x, y, z} }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "joint", keys);
  j.it.kind = read_kind(L);
  hk_lua_field(L, 2, "a");
  if (!read_body(&j, "a", &j.it.a))
    return hk_lua_fail(L, HK_BAD_PARAM, "joint: a: expected a rigid body, of scene:rigid");
  read_b(&j);
  read_place(&j);
  bool meet = read_contact(&j);
  note_counts(j.scene, first);
  size_t before = j.scene->particles.n;
  make(&j);
  note_counts(j.scene, end);
  hk_scene_mark_joint(j.scene, before, meet);
  for (int k = 0; k < 3; k++) j.it.part[k] = (hk_joint_range){first[k], end[k] - first[k]};
  j.it.kind_name = kind_name[j.it.kind];
  hk_joint_push(L, 1, &j.it);
  return 1;
}
