/* The mass of a rigid body from a script: a shape with its sizes, a closed mesh, points with masses, parts of these, or
 * mass and moments of inertia alone. Round shapes are exact, whatever the facets of their pictures. */
#include "core/app/shapes/shapes.h"
#include "core/engine/text/text.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

static const double default_detail = 5e-3; /* of pictures: depth of a facet in radii */
static const double least_digits = 1e-6;   /* of a body's extent, what places may be rounded by */

static double length_of(lua_State *L, int table, const char *key) {
  double value = hk_lua_field_number(L, table, "rigid", key, NAN);
  if (!(value > 0)) hk_lua_fail(L, HK_BAD_PARAM, "rigid: %s: a length in m above 0 has to be given", key);
  return value;
}

static void check_skin(lua_State *L, const char *wrong) {
  if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "rigid: %s", wrong);
}

/* ---- what says the body ---- */

/* Refuses measures that what says the body does not take, as a radius of a box: they would have no effect. `takes`:
 * words between blanks. */
static void refuse_others(lua_State *L, int table, const char *what, const char *takes) {
  static const char *const measures[] = {"radius", "length", "size", "scale", "masses"};
  for (size_t k = 0; k < sizeof measures / sizeof *measures; k++) {
    char word[16];
    snprintf(word, sizeof word, " %s ", measures[k]);
    bool given = hk_lua_field(L, table, measures[k]) != LUA_TNIL;
    lua_pop(L, 1);
    if (given && !strstr(takes, word))
      hk_lua_fail(L, HK_BAD_PARAM, "rigid: %s: a %s has none, so it would have no effect: leave it out", measures[k],
                  what);
  }
}

static void refuse_two(lua_State *L, int table) {
  static const char *const kinds[] = {"shape", "mesh", "points", "parts"};
  const char *first = NULL;
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    bool given = hk_lua_field(L, table, kinds[k]) != LUA_TNIL;
    lua_pop(L, 1);
    if (given && first)
      hk_lua_fail(L, HK_BAD_PARAM, "rigid: %s and %s both say what the body is: leave one of them out", first,
                  kinds[k]);
    if (given) first = kinds[k];
  }
}

/* ---- shapes, of density 1 ---- */

static hk_moments sphere(lua_State *L, int table, hk_mesh *skin) {
  double radius = length_of(L, table, "radius");
  check_skin(L, hk_mesh_add_sphere(skin, radius, default_detail));
  return hk_moments_of_sphere(radius);
}

static hk_moments capsule(lua_State *L, int table, hk_mesh *skin) {
  double radius = length_of(L, table, "radius"), length = length_of(L, table, "length");
  check_skin(L, hk_mesh_add_capsule(skin, radius, length, default_detail));
  return hk_moments_of_capsule(radius, length);
}

static hk_moments cylinder(lua_State *L, int table, hk_mesh *skin) {
  double radius = length_of(L, table, "radius"), length = length_of(L, table, "length");
  check_skin(L, hk_mesh_add_cylinder(skin, radius, length, default_detail));
  return hk_moments_of_cylinder(radius, length);
}

static hk_moments box(lua_State *L, int table, hk_mesh *skin) {
  double size[3];
  if (hk_lua_field(L, table, "size") == LUA_TTABLE)
    hk_lua_vector(L, -1, "rigid: size", size);
  else
    size[0] = size[1] = size[2] = length_of(L, table, "size");
  if (!(size[0] > 0 && size[1] > 0 && size[2] > 0))
    hk_lua_fail(L, HK_BAD_PARAM, "rigid: size: {%g, %g, %g}: lengths have to be above 0", size[0], size[1], size[2]);
  check_skin(L, hk_mesh_add_box(skin, size));
  return hk_moments_of_box(size);
}

static const struct shape {
  const char *name;
  hk_moments (*of)(lua_State *, int table, hk_mesh *);
  const char *takes;
} shapes[] = {{"sphere", sphere, " radius "},
              {"box", box, " size "},
              {"capsule", capsule, " radius length "},
              {"cylinder", cylinder, " radius length "}};

enum { SHAPES = sizeof shapes / sizeof *shapes };

static const char *shape_at(const void *context, size_t k) {
  (void)context;
  return k < SHAPES ? shapes[k].name : NULL;
}

static hk_moments read_shape(lua_State *L, int table, hk_mesh *skin) {
  if (lua_type(L, -1) != LUA_TSTRING) hk_lua_fail(L, HK_BAD_PARAM, "rigid: shape: expected a name");
  const char *name = lua_tostring(L, -1);
  for (size_t k = 0; k < SHAPES; k++)
    if (strcmp(name, shapes[k].name) == 0) {
      refuse_others(L, table, name, shapes[k].takes);
      return shapes[k].of(L, table, skin);
    }
  const char *near = hk_nearest_name(name, shape_at, NULL);
  hk_lua_fail(L, HK_BAD_PARAM, "rigid: shape: there is no '%s'; %s%s%s", name, near ? "did you mean '" : "",
              near ? near : "there are sphere, box, capsule and cylinder", near ? "'?" : "");
}

static hk_moments read_mesh(lua_State *L, int table, hk_mesh *skin) {
  hk_moments m;
  char text[HK_RIGID_TEXT];
  if (lua_type(L, -1) != LUA_TSTRING) hk_lua_fail(L, HK_BAD_PARAM, "rigid: mesh: expected an OBJ file");
  const char *name = lua_tostring(L, -1);
  refuse_others(L, table, "mesh", " scale ");
  hk_mesh_load(L, skin, "rigid", name);
  double scale = hk_lua_field_number(L, table, "rigid", "scale", 1);
  if (!(scale > 0)) hk_lua_fail(L, HK_BAD_PARAM, "rigid: scale: %g is not above 0", scale);
  for (size_t k = 0; k < 3 * skin->vertices; k++) skin->vertex[k] *= scale;
  const char *wrong = hk_moments_of_mesh(skin, &m, text);
  if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "rigid: %s: %s", name, wrong);
  return m;
}

/* ---- points ---- */

static hk_moments read_points(lua_State *L, int table) {
  int list = lua_gettop(L);
  size_t count = lua_istable(L, list) ? lua_rawlen(L, list) : 0, masses = 0;
  if (count == 0) hk_lua_fail(L, HK_BAD_PARAM, "rigid: points: expected a list of {x, y, z}");
  refuse_others(L, table, "body of points", " masses ");
  double *x = lua_newuserdatauv(L, 3 * count * sizeof *x, 0);
  for (size_t k = 0; k < count; k++) {
    char what[48];
    snprintf(what, sizeof what, "rigid: points[%zu]", k + 1);
    lua_rawgeti(L, list, (lua_Integer)k + 1);
    hk_lua_vector(L, -1, what, x + 3 * k);
    lua_pop(L, 1);
  }
  const double *mass = hk_lua_field(L, table, "masses") == LUA_TTABLE ? hk_lua_to_ids(L, -1, &masses) : NULL;
  if (!mass || masses != count)
    hk_lua_fail(L, HK_BAD_PARAM, "rigid: masses: expected %d numbers, kg, one for each point", (int)count);
  for (size_t k = 0; k < count; k++)
    if (!(mass[k] > 0 && isfinite(mass[k])))
      hk_lua_fail(L, HK_BAD_PARAM, "rigid: masses[%d]: %g kg is not above 0", (int)k + 1, mass[k]);
  return hk_moments_of_points(count, x, mass);
}

/* ---- mass and inertia ---- */

/* The value at the key, above 0, or NAN. */
static double positive(lua_State *L, int table, const char *key, const char *unit) {
  double value = hk_lua_field_number(L, table, "rigid", key, NAN);
  if (value <= 0) hk_lua_fail(L, HK_BAD_PARAM, "rigid: %s: %g %s has to be above 0", key, value, unit);
  return value;
}

/* What has density 1 becomes what the table says. True: it says nothing. */
static bool weigh(lua_State *L, int table, hk_moments *m) {
  double mass = positive(L, table, "mass", "kg"), density = positive(L, table, "density", "kg/m^3");
  if (!isnan(mass) && !isnan(density)) hk_lua_fail(L, HK_BAD_PARAM, "rigid: give mass or density, not both");
  if (!isnan(mass)) hk_moments_scale(m, mass / m->mass);
  if (!isnan(density)) hk_moments_scale(m, density);
  return isnan(mass) && isnan(density);
}

static void read_rows(lua_State *L, const char *what, double into[9]) {
  int list = lua_gettop(L);
  for (int r = 0; r < 3; r++) {
    lua_rawgeti(L, list, r + 1);
    hk_lua_vector(L, -1, what, into + 3 * r);
    lua_pop(L, 1);
  }
}

static bool holds_tables(lua_State *L) {
  bool rows = lua_rawgeti(L, -1, 1) == LUA_TTABLE;
  lua_pop(L, 1);
  return rows;
}

static void read_inertia(lua_State *L, hk_moments *m) {
  double I[9] = {0}, diagonal[3];
  char text[HK_RIGID_TEXT];
  if (!lua_istable(L, -1) || lua_rawlen(L, -1) != 3)
    hk_lua_fail(L, HK_BAD_PARAM, "rigid: inertia: expected three moments, kg m^2, or the three rows of a matrix");
  if (holds_tables(L))
    read_rows(L, "rigid: inertia", I);
  else {
    hk_lua_vector(L, -1, "rigid: inertia", diagonal);
    for (int c = 0; c < 3; c++) I[4 * c] = diagonal[c];
  }
  const char *wrong = hk_moments_set_inertia(m, I, text);
  if (wrong) hk_lua_fail(L, HK_BAD_PARAM, "rigid: inertia: %s", wrong);
}

/* One shape, mesh or set of points, of density 1 but for points; false: the table has none. */
static bool read_one(lua_State *L, int table, hk_mesh *skin, hk_moments *m) {
  refuse_two(L, table);
  if (hk_lua_field(L, table, "shape") != LUA_TNIL)
    *m = read_shape(L, table, skin);
  else if (hk_lua_field(L, table, "mesh") != LUA_TNIL)
    *m = read_mesh(L, table, skin);
  else if (hk_lua_field(L, table, "points") != LUA_TNIL) {
    *m = read_points(L, table);
    if (hk_lua_field(L, table, "mass") != LUA_TNIL || hk_lua_field(L, table, "density") != LUA_TNIL)
      hk_lua_fail(L, HK_BAD_PARAM, "rigid: points have their masses in `masses`; leave mass and density out");
  } else
    return false;
  return true;
}

/* ---- parts ---- */

static void add_skin(lua_State *L, hk_mesh *all, const hk_mesh *part, const double x[3], const double R[9]) {
  uint32_t first = (uint32_t)all->vertices;
  const char *wrong = NULL;
  for (size_t i = 0; i < part->vertices && !wrong; i++) {
    const double *y = part->vertex + 3 * i;
    double at[3];
    for (int c = 0; c < 3; c++) at[c] = x[c] + R[3 * c] * y[0] + R[3 * c + 1] * y[1] + R[3 * c + 2] * y[2];
    wrong = hk_mesh_add_vertex(all, at);
  }
  for (size_t t = 0; t < part->triangles && !wrong; t++) {
    const uint32_t *c = part->triangle[t];
    wrong = hk_mesh_add_face(all, (const uint32_t[3]){first + c[0], first + c[1], first + c[2]}, 3);
  }
  check_skin(L, wrong);
}

/* The parts at the top of the stack. True: none says its mass, which the body has to. */
static bool read_parts(lua_State *L, hk_mesh *skin, hk_moments *sum) {
  static const char *const keys[] = {"shape",  "radius", "length",   "size",    "mesh",        "scale", "points",
                                     "masses", "mass",   "position", "density", "orientation", NULL};
  int list = lua_gettop(L);
  size_t open = 0, count = lua_istable(L, list) ? lua_rawlen(L, list) : 0;
  if (count == 0) hk_lua_fail(L, HK_BAD_PARAM, "rigid: parts: expected a list of shapes, { { shape = ... }, ... }");
  for (size_t k = 0; k < count; k++, lua_settop(L, list)) {
    double x[3] = {0}, R[9];
    hk_moments m;
    lua_rawgeti(L, list, (lua_Integer)k + 1);
    int table = lua_gettop(L);
    hk_lua_check_table(L, table, "rigid: parts", "{ { shape = ... }, ... }");
    hk_lua_check_keys(L, table, "rigid: parts", keys);
    hk_lua_field_vector(L, table, "rigid: parts", "position", x);
    hk_rigid_read_orientation(L, table, R);
    hk_mesh *own = hk_mesh_new(L);
    if (!read_one(L, table, own, &m))
      hk_lua_fail(L, HK_BAD_PARAM, "rigid: parts[%d]: it has no shape, mesh or points", (int)k + 1);
    open += hk_lua_field(L, table, "points") == LUA_TNIL && weigh(L, table, &m);
    hk_moments_add(sum, &m, x, R);
    add_skin(L, skin, own, x, R);
    hk_mesh_clear(own);
  }
  if (open > 0 && open < count)
    hk_lua_fail(L, HK_BAD_PARAM, "rigid: parts: %d of %d have neither mass nor density: give it to all, or to the body",
                (int)open, (int)count);
  return open > 0;
}

hk_moments hk_rigid_read(lua_State *L, hk_mesh *skin) {
  hk_moments m = {0};
  bool open = true, parts = hk_lua_field(L, 2, "parts") != LUA_TNIL;
  if (parts) {
    refuse_two(L, 2);
    refuse_others(L, 2, "body of parts", "");
    open = read_parts(L, skin, &m);
  } else if (read_one(L, 2, skin, &m))
    open = hk_lua_field(L, 2, "points") == LUA_TNIL;
  else if (hk_lua_field(L, 2, "inertia") == LUA_TNIL)
    hk_lua_fail(L, HK_BAD_PARAM, "rigid: expected a shape, a mesh, points, parts, or mass and inertia");
  else
    refuse_others(L, 2, "body by its inertia alone", "");
  if (m.mass == 0) m.mass = 1;
  if (open && weigh(L, 2, &m)) hk_lua_fail(L, HK_BAD_PARAM, "rigid: mass, kg, or density, kg/m^3, is required");
  if (!open && parts && !weigh(L, 2, &m))
    hk_lua_fail(L, HK_BAD_PARAM, "rigid: the parts have their masses; leave those of the body out");
  if (hk_lua_field(L, 2, "inertia") != LUA_TNIL) read_inertia(L, &m);
  return m;
}

/* ---- orientation ---- */

static const double normalised = 1e-6; /* of quaternions and matrices, whose numbers may be rounded */

static void read_quaternion(lua_State *L, double R[9]) {
  size_t count;
  const double *q = hk_lua_to_ids(L, -1, &count); /* a list of numbers */
  if (!q) hk_lua_fail(L, HK_BAD_PARAM, "rigid: orientation: a quaternion has four numbers, {w, x, y, z}");
  double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(fabs(length - 1) <= normalised))
    hk_lua_fail(L, HK_BAD_PARAM,
                "rigid: orientation: the quaternion {%g, %g, %g, %g} has the length %.7g: divide it by that", q[0],
                q[1], q[2], q[3], length);
  hk_rotation_of_quaternion((const double[4]){q[0] / length, q[1] / length, q[2] / length, q[3] / length}, R);
}

static void read_matrix(lua_State *L, double R[9]) {
  double q[4];
  read_rows(L, "rigid: orientation", R);
  double error = hk_rotation_error(R);
  if (error == 2) hk_lua_fail(L, HK_BAD_PARAM, "rigid: orientation: the matrix is a reflection: change a sign");
  if (!(error <= normalised))
    hk_lua_fail(L, HK_BAD_PARAM,
                "rigid: orientation: the rows of the matrix are no unit vectors across each other, by %.3g", error);
  hk_quaternion_of(R, q);
  hk_rotation_of_quaternion(q, R); /* to rounding */
}

void hk_rigid_read_orientation(lua_State *L, int table, double R[9]) {
  double turn[3] = {0};
  if (hk_lua_field(L, table, "orientation") == LUA_TNIL)
    hk_rotation(turn, R);
  else if (lua_istable(L, -1) && lua_rawlen(L, -1) == 4)
    read_quaternion(L, R);
  else if (lua_istable(L, -1) && holds_tables(L) && lua_rawlen(L, -1) == 3)
    read_matrix(L, R);
  else {
    if (!lua_istable(L, -1) || lua_rawlen(L, -1) != 3)
      hk_lua_fail(L, HK_BAD_PARAM,
                  "rigid: orientation: expected a rotation vector {x, y, z}, rad, a quaternion {w, x, y, z}, or the "
                  "three rows of a matrix");
    hk_lua_vector(L, -1, "rigid: orientation", turn);
    hk_rotation(turn, R);
  }
  lua_pop(L, 1);
}

/* ---- place ---- */

/* A place is known to its last digit, and so are the distances of particles: far from the origin a small body has none.
 */
void hk_rigid_check_digits(lua_State *L, const hk_rigid_body *b, const double position[3], const double *x) {
  double farthest_off = 0;
  for (size_t k = 0; k < 3 * b->count; k++) farthest_off = fmax(farthest_off, fabs(x[k]));
  if (!(farthest_off * DBL_EPSILON <= least_digits * b->a[0]))
    hk_lua_fail(L, HK_BAD_PARAM,
                "rigid: position: {%g, %g, %g} m: numbers there are %.2g m apart, too coarse for a body that reaches "
                "%.3g m: place the scene nearer to the origin",
                position[0], position[1], position[2], farthest_off * DBL_EPSILON, b->a[0]);
}
