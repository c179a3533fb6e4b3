/* scene:joint{ kind = "ball" | "hinge" | "universal" | "fixed" | "distance", a =, b =, at =, axis = }: joins a rigid
 * body to another one, to a particle, or, without b, to the place where it is. A ball is two points of the bodies
 * (riders) that stay together, by the constraint that keeps differences, and so is the middle of every other joint.
 * What may not turn is kept by distances between further points, each of which forbids turning about one direction, the
 * same in the bodies at any attitude: two for a hinge, three for what is fixed, one for a universal joint, between
 * points on the axes of either body. So no equation follows from others. (Two points kept together on the axis of a
 * hinge are six equations of which one follows from others, another one as the axis turns.) A distance is one between
 * `at` on a and `to` on b. All places are those of the start, in the scene's coordinates. */
#include "core/app/builders/rigid_bodies.h"
#include "core/engine/text/text.h"

#include <string.h>

enum { BALL, HINGE, UNIVERSAL, FIXED, DISTANCE, KINDS };
static const char *const kind_name[KINDS + 1] = {"ball", "hinge", "universal", "fixed", "distance", NULL};

/* Points of a joint are as far apart as this part of the larger body's extent. */
static const double spread = 1, meets = 1e-9;

typedef struct joint {
  lua_State *L;
  hk_scene *scene;
  int kind;
  const hk_lua_rigid *a, *b; /* b NULL: a particle, or what stands still */
  uint32_t particle;         /* of b; 0: none */
  double at[3], size;        /* m */
} joint;

static const char *kind_at(const void *context, size_t k) {
  (void)context;
  return kind_name[k];
}

static int read_kind(lua_State *L) {
  if (hk_lua_field(L, 2, "kind") != LUA_TSTRING)
    hk_lua_fail(L, HK_BAD_PARAM, "joint: kind: expected ball, hinge, universal, fixed or distance");
  const char *name = lua_tostring(L, -1);
  for (int k = 0; k < KINDS; k++)
    if (strcmp(name, kind_name[k]) == 0) return k;
  const char *near = hk_nearest_name(name, kind_at, NULL);
  return hk_lua_fail(L, HK_BAD_PARAM, "joint: kind: there is no '%s'; %s%s%s", name, near ? "did you mean '" : "",
                     near ? near : "there are ball, hinge, universal, fixed and distance", near ? "'?" : "");
}

/* ---- points ---- */

/* The place of a point of the scene in the frame of the body, at the start. */
static void to_body(const joint *j, const hk_lua_rigid *r, const double at[3], double y[3]) {
  const hk_particles *p = &j->scene->particles;
  size_t first = 3 * (size_t)(r->first - 1);
  hk_rigid_motion m = hk_rigid_motion_of(&r->body, p->position + first, p->velocity + first);
  for (int c = 0; c < 3; c++) {
    y[c] = r->body.center[c];
    for (int d = 0; d < 3; d++) y[c] += m.attitude[3 * d + c] * (at[d] - m.center[d]);
  }
}

static uint32_t point_on(const joint *j, const hk_lua_rigid *r, const double at[3]) {
  double y[3];
  to_body(j, r, at, y);
  return hk_rigid_add_point(j->L, j->scene, r, y);
}

/* A particle that is held where it is. */
static uint32_t point_at_rest(const joint *j, const double at[3]) {
  hk_error error = {0};
  uint32_t id = hk_lua_add(j->L, j->scene, "joint", 1, at, NULL, NULL, 0, j->scene->particles.group[j->a->first - 1]);
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = 1, .id = &id, .release = INFINITY};
  pin.where = (char *)(uintptr_t)hk_lua_where(j->L); /* hk_scene_add_pin copies it */
  if (hk_scene_add_pin(j->scene, &pin, &error) != HK_OK) hk_lua_raise_for(j->L, "joint", &error);
  lua_pop(j->L, 1);
  return id;
}

static uint32_t point_of_b(const joint *j, const double at[3]) {
  return j->b ? point_on(j, j->b, at) : j->particle ? j->particle : point_at_rest(j, at);
}

static void keep(const joint *j, uint32_t p, uint32_t q, bool distance) {
  hk_error error = {0};
  const uint32_t pair[1][2] = {{p, q}};
  const char *where = hk_lua_where(j->L);
  hk_limits_take(j->L, 4 * sizeof pair);
  hk_status status = (distance ? hk_scene_add_distances : hk_scene_add_differences)(j->scene, where, 1, pair, &error);
  if (status != HK_OK) hk_lua_raise_for(j->L, "joint", &error);
  lua_pop(j->L, 1);
}

static void along(const joint *j, const double axis[3], double by, double to[3]) {
  for (int c = 0; c < 3; c++) to[c] = j->at[c] + by * j->size * axis[c];
}

static void join_at(const joint *j, const double at[3]) { keep(j, point_on(j, j->a, at), point_of_b(j, at), false); }

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
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: axis: a %s needs one, {x, y, z}", kind_name[j->kind]);
}

static double distance(const double p[3], const double q[3]) {
  return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

static void read_b(joint *j) {
  char known[64];
  int type = hk_lua_field(j->L, 2, "b");
  j->b = hk_rigid_to(j->L, -1);
  if (type == LUA_TNIL || j->b) return;
  double id = type == LUA_TNUMBER ? lua_tonumber(j->L, -1) : 0;
  if (!(id >= 1 && id <= (double)j->scene->particles.n && floor(id) == id))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: b: expected a rigid body or the id of a particle (%s)",
                hk_known_ids(known, j->scene->particles.n));
  j->particle = (uint32_t)id;
  if (j->kind != BALL && j->kind != DISTANCE)
    hk_lua_fail(j->L, HK_BAD_PARAM,
                "joint: b: a particle has no directions: a %s joins bodies; a ball or a distance "
                "would do",
                kind_name[j->kind]);
}

static void read_place(joint *j) {
  bool given = hk_lua_field_vector(j->L, 2, "joint", "at", j->at);
  const double *there = j->particle ? j->scene->particles.position + 3 * (size_t)(j->particle - 1) : NULL;
  if (!given && !(there && j->kind == BALL))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: at: the place of the joint is required, {x, y, z}");
  if (!given) memcpy(j->at, there, sizeof j->at);
  j->size = spread * fmax(j->a->body.a[0], j->b ? j->b->body.a[0] : 0);
  double apart = there ? distance(j->at, there) : 0;
  if (j->kind == BALL && apart > meets * (j->size + fabs(j->at[0]) + fabs(j->at[1]) + fabs(j->at[2])))
    hk_lua_fail(j->L, HK_BAD_PARAM,
                "joint: at: particle %d is %.6g m off {%g, %g, %g}: the two have to meet at the start",
                (int)j->particle, apart, j->at[0], j->at[1], j->at[2]);
}

/* ---- the kinds ---- */

/* The distance between the point at p (from the joint, in `size`) on a and that at p + u on b: for a small turn w of a
 * it changes by w.(p x u), whatever the attitude of the two. */
static void keep_turn(const joint *j, const double p[3], const double u[3]) {
  double on_a[3], on_b[3], sum[3] = {p[0] + u[0], p[1] + u[1], p[2] + u[2]};
  along(j, p, 1, on_a);
  along(j, sum, 1, on_b);
  keep(j, point_on(j, j->a, on_a), point_of_b(j, on_b), true);
}

/* Turns about the two directions across the axis are kept. */
static void make_hinge(const joint *j) {
  double axis[3], side[3], other[3];
  need_axis(j, axis);
  hk_frame_across(axis, side, other);
  join_at(j, j->at);
  keep_turn(j, axis, side);
  keep_turn(j, axis, other);
}

static void make_fixed(const joint *j) {
  static const double axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  join_at(j, j->at);
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
  join_at(j, j->at);
  for (int c = 0; c < 3; c++) apart[c] = other[c] - axis[c];
  keep_turn(j, axis, apart);
}

static void make_distance(const joint *j) {
  double to[3];
  if (!hk_lua_field_vector(j->L, 2, "joint", "to", to) && !j->particle)
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: to: a distance needs its other end, {x, y, z}");
  if (j->particle) memcpy(to, j->scene->particles.position + 3 * (size_t)(j->particle - 1), sizeof to);
  if (!(distance(j->at, to) > 0))
    hk_lua_fail(j->L, HK_BAD_PARAM, "joint: to: a distance of 0 m has no direction: use a ball");
  keep(j, point_on(j, j->a, j->at), point_of_b(j, to), true);
}

int hk_build_joint(lua_State *L) {
  static const char *const keys[] = {"kind", "a", "b", "at", "axis", "axis_b", "to", NULL};
  joint j = {.L = L, .scene = hk_lua_scene(L, 1)};
  hk_lua_check_table(L, 2, "joint", "scene:joint { kind = \"ball\", a = body, b = other, at = {x, y, z} }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "joint", keys);
  j.kind = read_kind(L);
  hk_lua_field(L, 2, "a");
  j.a = hk_rigid_to(L, -1);
  if (!j.a) return hk_lua_fail(L, HK_BAD_PARAM, "joint: a: expected a rigid body, of scene:rigid");
  read_b(&j);
  if (j.a == j.b) return hk_lua_fail(L, HK_BAD_PARAM, "joint: a and b are the same body");
  read_place(&j);
  if (j.kind == BALL) join_at(&j, j.at);
  if (j.kind == HINGE) make_hinge(&j);
  if (j.kind == FIXED) make_fixed(&j);
  if (j.kind == UNIVERSAL) make_universal(&j);
  if (j.kind == DISTANCE) make_distance(&j);
  return 0;
}
