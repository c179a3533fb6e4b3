/* scene:strand{}: a chain of particles, straight, curled or along any curve, with its edges. Where its section and
 * material are given (radius, E, nu, density), so are its mass and its stiffnesses, whose formulas are in
 * scene/section.c: a force that takes EA, EI and GJ then bends the same strand however fine it is.
 *
 *     n particles, n - 1 segments of the length l = length/(n - 1); clamped: l = length/(n - 2), see below
 *     mass of a particle = density A (half the segments on both sides): the ends carry half cells
 *     handle.EA (N), .EI and .EI2 (N m^2, against bending towards either half axis), .GJ (N m^2),
 *     .stiffness = EA/l (N/m, of each edge)
 *
 * Where `mass` alone is given all particles share it equally. The errors of a chain with half cells are of order l^2,
 * those of one without of order l.
 *
 * clamped: the strand starts inside a wall. Its first segment lies in it, straight before the start, without mass; the
 * start is the place of the second particle. Both are pinned (pin = false leaves that to the script), and what bends is
 * `length`.
 */
#include "core/app/builders/filament.h"

#include <string.h>

typedef struct strand {
  uint32_t n;
  bool wall;
  double length, l; /* m; of a segment */
  hk_lua_material material;
  double (*x)[3], *mass; /* of n particles, on the Lua stack */
} strand;

/* ---- a curve of the script ---- */

/* Points of a function: per particle, and at least. The polygon of one turn is short by 4e-7, of ten turns by 4e-5. */
enum { FINER = 8, AT_LEAST = 4096 };

/* The curve's point at s in 0 to 1. */
static void point_of_function(lua_State *L, int function, double s, double into[3]) {
  int top = lua_gettop(L);
  lua_pushvalue(L, function);
  lua_pushnumber(L, s);
  lua_call(L, 1, LUA_MULTRET);
  if (lua_istable(L, top + 1))
    hk_lua_vector(L, top + 1, "strand: curve", into);
  else
    for (int c = 0; c < 3; c++)
      into[c] = lua_gettop(L) >= top + 3 ? hk_lua_number(L, top + 1 + c, "strand: curve") : NAN;
  lua_settop(L, top);
  if (!isfinite(into[0] + into[1] + into[2]))
    hk_lua_fail(L, HK_BAD_PARAM, "strand: curve: the function gave no point x, y, z at s = %g", s);
}

/* The points of the key curve, on the stack: its list, or many of its function. */
static double (*curve_points(lua_State *L, int curve, uint32_t n, size_t *points))[3] {
  bool function = lua_isfunction(L, curve);
  if (!function && !lua_istable(L, curve))
    hk_lua_fail(L, HK_BAD_PARAM, "strand: curve: expected a list of points { x, y, z }, or a function of s in 0 to 1");
  *points = function ? (size_t)FINER * n + AT_LEAST : lua_rawlen(L, curve);
  if (*points < 2) hk_lua_fail(L, HK_BAD_PARAM, "strand: curve: needs two points or more");
  double(*point)[3] = lua_newuserdatauv(L, *points * sizeof *point, 0);
  for (size_t k = 0; k < *points; k++) {
    if (function) {
      point_of_function(L, curve, (double)k / (double)(*points - 1), point[k]);
      continue;
    }
    lua_rawgeti(L, curve, (lua_Integer)k + 1);
    hk_lua_vector(L, -1, "strand: curve", point[k]);
    lua_pop(L, 1);
  }
  return point;
}

/* Between two points: on the function itself, or on the straight line. */
static void point_between(lua_State *L, int curve, const double (*point)[3], size_t points, double place,
                          double into[3]) {
  size_t k = (size_t)place < points - 1 ? (size_t)place : points - 2;
  double part = place - (double)k;
  if (lua_isfunction(L, curve)) {
    point_of_function(L, curve, place / (double)(points - 1), into);
    return;
  }
  for (int c = 0; c < 3; c++) into[c] = point[k][c] + part * (point[k + 1][c] - point[k][c]);
}

static void lay_on_curve(lua_State *L, strand *s, int curve) {
  size_t points, wall = s->wall, laid = s->n - wall;
  const double(*point)[3] = (const double(*)[3])curve_points(L, curve, s->n, &points);
  s->length = hk_polygon_length(point, points);
  if (!(s->length > 0)) hk_lua_fail(L, HK_BAD_PARAM, "strand: curve: all its points are one");
  s->l = s->length / (double)(laid - 1);
  double *place = lua_newuserdatauv(L, laid * sizeof *place, 0), size = 0;
  hk_polygon_divide(point, points, laid, place);
  for (size_t k = 0; k < laid; k++) point_between(L, curve, point, points, place[k], s->x[k + wall]);
  for (size_t k = 0; wall && size == 0 && k + 1 < points; k++) { /* the wall goes on the way the curve starts */
    size = hk_polygon_length(point + k, 2);
    for (int c = 0; c < 3 && size > 0; c++) s->x[0][c] = point[0][c] - s->l / size * (point[k + 1][c] - point[k][c]);
  }
}

/* ---- a line or a curl ---- */

static void direction_of(lua_State *L, const double from[3], double direction[3], double *length) {
  double to[3];
  if (!hk_lua_field_vector(L, 2, "strand", "to", to)) {
    hk_lua_field_vector(L, 2, "strand", "direction", direction);
    hk_lua_unit(L, "strand", "direction", direction);
    *length = hk_lua_above_zero(L, 2, "strand", "length", 1);
    return;
  }
  for (int c = 0; c < 3; c++) direction[c] = to[c] - from[c];
  *length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  if (!(*length > 0)) hk_lua_fail(L, HK_BAD_PARAM, "strand: to is where it starts: a strand needs a length");
  for (int c = 0; c < 3; c++) direction[c] /= *length;
  *length = hk_lua_above_zero(L, 2, "strand", "length", *length);
}

static void lay_straight_or_curled(lua_State *L, strand *s) {
  double from[3] = {0, 0, 0}, direction[3] = {0, 0, -1};
  hk_lua_field_vector(L, 2, "strand", "from", from);
  direction_of(L, from, direction, &s->length);
  hk_lua_curl curl = hk_lua_read_curl(L, 2, "strand");
  s->l = s->length / (s->n - 1 - s->wall);
  hk_helix helix = hk_lua_curl_helix(&curl, from, direction, 0, 1);
  hk_lua_lay(&helix, s->n, s->wall, s->l, s->x);
}

/* ---- */

static void refuse_two_shapes(lua_State *L) {
  static const char *const beside[] = {"from", "to", "length", "direction", "curl", NULL};
  for (const char *const *key = beside; *key; key++)
    if (hk_lua_given(L, 2, *key))
      hk_lua_fail(L, HK_BAD_PARAM, "strand: a curve has a %s of its own: leave it out", *key);
}

int hk_build_strand(lua_State *L) {
  static const char *const keys[] = {"n",      "from", "to", "length",  "direction", "curve", "curl",  "mass",
                                     "radius", "E",    "nu", "density", "clamped",   "pin",   "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "strand", "scene:strand { ... }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "strand", keys);
  strand s = {.wall = hk_lua_flag(L, 2, "strand", "clamped", false)};
  s.n = hk_lua_count(L, 2, "strand", "n", s.wall ? 3 : 2);
  s.x = lua_newuserdatauv(L, s.n * sizeof *s.x, 0);
  s.mass = lua_newuserdatauv(L, s.n * sizeof *s.mass, 0);
  s.material = hk_lua_read_material(L, 2, scene, "strand");
  if (hk_lua_field(L, 2, "curve") != LUA_TNIL) {
    refuse_two_shapes(L);
    lay_on_curve(L, &s, lua_gettop(L));
  } else
    lay_straight_or_curled(L, &s);
  hk_lua_share_mass(&s.material, s.n, s.wall, s.length, s.mass);
  hk_lua_handle h = {.count = s.n, .nx = s.n, .ny = 1, .chain = true, .roots = s.wall ? 2 : 1};
  h.first = hk_lua_add(L, scene, "strand", s.n, &s.x[0][0], NULL, s.mass, 0, hk_lua_group(L, scene, 2, "strand"));
  hk_lua_keep_section(L, scene, &s.material, h.first, s.n);
  hk_lua_push_structural(L, &h);
  hk_lua_add_edges(L, scene);
  if (s.wall && hk_lua_flag(L, 2, "strand", "pin", true)) hk_lua_pin_roots(L, scene, &h, "strand");
  hk_lua_push_handle(L, h);
  hk_lua_set_numbers(L, -1, &s.material, s.length, s.l);
  return 1;
}
