/* scene:block{ nx, ny, nz, size }: a block of nx x ny x nz particles, every cell of which five tetrahedra fill, those
 * of neighbours in mirror image, so that the diagonals of their faces meet. scene:tetrahedra{ file = "name.msh" }, or
 * { vertices =, tetrahedra = } by hand. The faces of one tetrahedron are the skin, triangles of the scene. With
 * `density`, kg/m^3, a particle has a quarter of the mass of every tetrahedron around it; with `mass` all have the
 * same.
 *
 * With `E`, Young's modulus, the handle has a `stiffness` for each edge, to be handed to a force along edges: one of
 * stiffness k and length L along d adds k L^2 d_i d_j d_k d_l per volume to the elasticity C_ijkl, which is then
 * symmetric in all its indices: what acts along edges alone has Poisson's ratio 1/4 whatever the mesh, and where it is
 * isotropic E = 5/2 C_xxyy. Blocks of cells a x b x c are isotropic with
 *     k_x = 2/5 E (b c/a) (3 - a^2/b^2 - a^2/c^2),
 *     k_xy = 2/5 E c (a^2 + b^2)/(a b),
 * a part of it for each cell around an edge. Other meshes have k = E V/L^2 of every tetrahedron of volume V at the
 * edge, which has the right trace (Van Gelder, J. Graphics Tools 3 (1998), in three dimensions) and is isotropic on
 * average only: blocks would be 1.2 times as stiff along their sides. Free faces give way more, by a part of order 1.
 */
#include "core/app/builders/mesh_handle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The lattice of a block; sides 0: of no block. */
typedef struct lattice {
  uint32_t n[3];
  double origin[3], side[3]; /* m: of a cell */
  double axis[3][3];         /* unit vectors */
} lattice;

static void fail_for(lua_State *L, const char *what, const char *wrong) __attribute__((noreturn));
static void fail_for(lua_State *L, const char *what, const char *wrong) {
  hk_lua_fail(L, HK_BAD_PARAM, "%s: %s", what, wrong);
}

/* ---- edges and their stiffness ----------------------------------------------------------------------------------- */

typedef struct side {
  uint32_t a, b; /* vertices, a < b */
  double k;      /* N/m */
} side;

static int by_ends(const void *left, const void *right) {
  const side *s = left, *t = right;
  if (s->a != t->a) return s->a < t->a ? -1 : 1;
  return (s->b > t->b) - (s->b < t->b);
}

/* k of an edge of a block's tetrahedron: each cell has four of them at its sides and three at every diagonal, and there
 * are up to four cells around a side and two at a diagonal. */
static double block_stiffness(const lattice *l, double E, const double d[3]) {
  double along[3], square[3], k = 0.4 * E;
  int axes = 0, axis = 0, missing = 0;
  for (int c = 0; c < 3; c++) {
    along[c] = d[0] * l->axis[c][0] + d[1] * l->axis[c][1] + d[2] * l->axis[c][2];
    square[c] = l->side[c] * l->side[c];
    if (fabs(along[c]) > l->side[c] / 2)
      axes++, axis = c;
    else
      missing = c;
  }
  int p = (axis + 1) % 3, q = (axis + 2) % 3;
  if (axes == 1)
    return k / 4 * l->side[p] * l->side[q] / l->side[axis] * (3 - square[axis] / square[p] - square[axis] / square[q]);
  p = (missing + 1) % 3, q = (missing + 2) % 3;
  return k / 6 * l->side[missing] * (square[p] + square[q]) / (l->side[p] * l->side[q]);
}

static double stiffness_of(const hk_mesh *m, const lattice *l, double E, size_t t, uint32_t a, uint32_t b) {
  double d[3], square = 0;
  for (size_t c = 0; c < 3; c++) {
    d[c] = m->vertex[3 * (size_t)b + c] - m->vertex[3 * (size_t)a + c];
    square += d[c] * d[c];
  }
  return l->side[0] > 0 ? block_stiffness(l, E, d) : E * hk_mesh_volume(m, t) / square;
}

/* The edges of all tetrahedra, each once with the sum of its stiffness, as a block on the stack. */
static side *push_sides(lua_State *L, const hk_mesh *m, const lattice *l, double E, size_t *count) {
  side *list = lua_newuserdatauv(L, (6 * m->tetrahedra + 1) * sizeof *list, 0);
  size_t at = 0, kept = 0;
  for (size_t t = 0; t < m->tetrahedra; t++)
    for (int q = 1; q < 4; q++)
      for (int p = 0; p < q; p++) {
        uint32_t a = m->tetrahedron[t][p], b = m->tetrahedron[t][q];
        list[at++] = (side){a < b ? a : b, a < b ? b : a, stiffness_of(m, l, E, t, a, b)};
      }
  qsort(list, at, sizeof *list, by_ends);
  for (size_t k = 0; k < at; k++) {
    if (kept > 0 && by_ends(&list[k], &list[kept - 1]) == 0)
      list[kept - 1].k += list[k].k;
    else
      list[kept++] = list[k];
  }
  *count = kept;
  return list;
}

/* ---- into the scene ---------------------------------------------------------------------------------------------- */

static const double *push_masses(lua_State *L, const char *what, const hk_mesh *m, double density) {
  double *mass = lua_newuserdatauv(L, (m->vertices + 1) * sizeof *mass, 0);
  for (size_t i = 0; i < m->vertices; i++) mass[i] = 0;
  for (size_t k = 0; k < 4 * m->tetrahedra; k++)
    mass[m->tetrahedron[k / 4][k % 4]] += density * hk_mesh_volume(m, k / 4) / 4;
  for (size_t i = 0; i < m->vertices; i++)
    if (!(mass[i] > 0))
      hk_lua_fail(L, HK_BAD_PARAM, "%s: density: vertex %d is part of no tetrahedron, and has no mass", what,
                  (int)i + 1);
  return mass;
}

/* A list of tuples of ids; the members of `list` are vertices from 0. */
static void push_tuples(lua_State *L, const uint32_t *list, size_t count, size_t arity, uint32_t first) {
  lua_createtable(L, (int)count, 0);
  for (size_t t = 0; t < count; t++) {
    lua_createtable(L, (int)arity, 0);
    for (size_t c = 0; c < arity; c++) {
      lua_pushinteger(L, (lua_Integer)first + list[arity * t + c]);
      lua_rawseti(L, -2, (lua_Integer)c + 1);
    }
    lua_rawseti(L, -2, (lua_Integer)t + 1);
  }
}

/* The edges, and with E their stiffness, of the handle. */
static void keep_edges(lua_State *L, int handle, const hk_mesh *m, const lattice *l, double E, uint32_t first) {
  size_t count;
  const side *list = push_sides(L, m, l, isnan(E) ? 0 : E, &count);
  hk_lua_edges *edges = hk_lua_new_edges(L, count);
  for (size_t k = 0; k < count; k++) edges->pair[k][0] = first + list[k].a, edges->pair[k][1] = first + list[k].b;
  lua_setiuservalue(L, handle, 1);
  if (!isnan(E)) {
    lua_createtable(L, 0, 1);
    lua_createtable(L, (int)count, 0);
    for (size_t k = 0; k < count; k++) {
      lua_pushnumber(L, list[k].k);
      lua_rawseti(L, -2, (lua_Integer)k + 1);
    }
    lua_setfield(L, -2, "stiffness");
    lua_setiuservalue(L, handle, HK_LUA_NUMBERS);
  }
  lua_settop(L, handle);
}

static void add_skin(lua_State *L, hk_scene *scene, const char *what, hk_mesh *m, uint32_t first) {
  size_t pair[2];
  hk_error error = {0};
  const char *wrong = hk_mesh_add_skin(m, pair);
  if (wrong)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: tetrahedra %d and %d: %s", what, (int)pair[0] + 1, (int)pair[1] + 1, wrong);
  uint32_t(*triangle)[3] = lua_newuserdatauv(L, (m->triangles + 1) * sizeof *triangle, 0);
  hk_limits_take(L, m->triangles * sizeof *triangle);
  for (size_t k = 0; k < 3 * m->triangles; k++) triangle[k / 3][k % 3] = first + m->triangle[k / 3][k % 3];
  if (hk_scene_add_triangles(scene, m->triangles, (const uint32_t(*)[3])triangle, &error) != HK_OK)
    hk_lua_raise_for(L, what, &error);
  lua_pop(L, 1);
}

static double read_modulus(lua_State *L, const char *what, const lattice *l) {
  double E = hk_lua_field_number(L, 2, what, "E", NAN);
  if (E <= 0) hk_lua_fail(L, HK_BAD_PARAM, "%s: E: %g Pa has to be above 0", what, E);
  for (int c = 0; c < 3 && !isnan(E) && l->side[0] > 0; c++) {
    double p = l->side[c] / l->side[(c + 1) % 3], q = l->side[c] / l->side[(c + 2) % 3];
    if (p * p + q * q > 3 * (1 + 1e-12)) /* equal to rounding */
      hk_lua_fail(L, HK_BAD_PARAM,
                  "%s: E: cells of %g m x %g m x %g m are too oblong for a stiffness of edges: take more even ones",
                  what, l->side[0], l->side[1], l->side[2]);
  }
  return E;
}

/* The handle of a mesh that has its vertices and tetrahedra. */
static int add_solid(lua_State *L, hk_scene *scene, const char *what, hk_mesh *m, const lattice *l, hk_lua_handle h) {
  double density, mass = hk_lua_mass(L, 2, what, &density), E = read_modulus(L, what, l);
  uint32_t group = hk_lua_group(L, scene, 2, what);
  const double *each = density > 0 ? push_masses(L, what, m, density) : NULL;
  h.count = (uint32_t)m->vertices;
  h.first = hk_lua_add(L, scene, what, m->vertices, m->vertex, NULL, each, mass / (double)m->vertices, group);
  add_skin(L, scene, what, m, h.first);
  hk_lua_push_handle(L, h);
  int handle = lua_gettop(L);
  keep_edges(L, handle, m, l, E, h.first);
  push_tuples(L, m->triangle ? m->triangle[0] : NULL, m->triangles, 3, h.first);
  lua_setiuservalue(L, handle, 2);
  push_tuples(L, m->tetrahedron ? m->tetrahedron[0] : NULL, m->tetrahedra, 4, h.first);
  lua_setiuservalue(L, handle, HK_LUA_TETRAHEDRA);
  hk_mesh_clear(m);
  return 1;
}

void hk_solid_enter(lua_State *L, hk_scene *scene, hk_mesh *m, const char *what) {
  const lattice none = {.side = {0}};
  add_solid(L, scene, what, m, &none, (hk_lua_handle){.nx = (uint32_t)m->vertices, .ny = 1});
}

/* ---- blocks ------------------------------------------------------------------------------------------------------ */

static lattice read_lattice(lua_State *L) {
  static const char *const counts[] = {"nx", "ny", "nz"};
  lattice l = {.axis = {{1, 0, 0}, {0, 1, 0}}};
  double size[3] = {1, 1, 1}, uv = 0;
  hk_lua_field_vector(L, 2, "block", "size", size);
  hk_lua_field_vector(L, 2, "block", "origin", l.origin);
  hk_lua_field_vector(L, 2, "block", "u", l.axis[0]);
  hk_lua_field_vector(L, 2, "block", "v", l.axis[1]);
  for (int k = 0; k < 2; k++) {
    double *u = l.axis[k], length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    if (!(length > 0)) fail_for(L, "block", "u and v are directions: they must not be 0");
    for (int c = 0; c < 3; c++) u[c] /= length;
  }
  for (int c = 0; c < 3; c++) uv += l.axis[0][c] * l.axis[1][c];
  if (fabs(uv) > 1e-9) fail_for(L, "block", "u and v are not at a right angle"); /* given to ten digits or so */
  for (int c = 0; c < 3; c++)
    l.axis[2][c] = l.axis[0][(c + 1) % 3] * l.axis[1][(c + 2) % 3] - l.axis[0][(c + 2) % 3] * l.axis[1][(c + 1) % 3];
  for (int c = 0; c < 3; c++) {
    l.n[c] = hk_lua_count(L, 2, "block", counts[c], 2);
    if (!(size[c] > 0)) fail_for(L, "block", "size: all three have to be above 0 m");
    l.side[c] = size[c] / (l.n[c] - 1);
  }
  return l;
}

static const char *add_places(hk_mesh *m, const lattice *l) {
  const char *wrong = NULL;
  for (uint32_t k = 0; k < l->n[2]; k++)
    for (uint32_t j = 0; j < l->n[1]; j++)
      for (uint32_t i = 0; i < l->n[0] && !wrong; i++) {
        double x[3], s = i * l->side[0], t = j * l->side[1], u = k * l->side[2];
        for (int c = 0; c < 3; c++) x[c] = l->origin[c] + s * l->axis[0][c] + t * l->axis[1][c] + u * l->axis[2][c];
        wrong = hk_mesh_add_vertex(m, x);
      }
  return wrong;
}

/* Corner 0 to 7 of a cell is at (bit 0, bit 1, bit 2). Four tetrahedra cut off the corners 0, 3, 5 and 6, and the fifth
 * is between them; in every other cell the x axis is turned round. */
static const char *add_cell(hk_mesh *m, const lattice *l, const uint32_t at[3]) {
  static const uint32_t FIVE[5][4] = {{0, 1, 2, 4}, {3, 1, 2, 7}, {5, 1, 4, 7}, {6, 2, 4, 7}, {1, 2, 4, 7}};
  uint32_t other = (at[0] + at[1] + at[2]) % 2, corner[4];
  const char *wrong = NULL;
  for (int t = 0; t < 5 && !wrong; t++) {
    for (int c = 0; c < 4; c++) {
      uint32_t bits = FIVE[t][c] ^ other;
      corner[c] = at[0] + (bits & 1) + l->n[0] * (at[1] + (bits >> 1 & 1) + l->n[1] * (at[2] + (bits >> 2)));
    }
    wrong = hk_mesh_add_tetrahedron(m, corner);
  }
  return wrong;
}

int hk_build_block(lua_State *L) {
  static const char *const keys[] = {"nx", "ny",   "nz",      "size", "origin", "u",
                                     "v",  "mass", "density", "E",    "group",  NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "block", "scene:block { ... }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "block", keys);
  lattice l = read_lattice(L);
  double particles = (double)l.n[0] * l.n[1] * l.n[2];
  if (particles > 1e6) hk_lua_fail(L, HK_BAD_PARAM, "block: %.0f particles are more than a million", particles);
  hk_limits_take(L, (size_t)particles * (5 * sizeof(uint32_t[4]) + 3 * sizeof(double)));
  hk_mesh *m = hk_mesh_new(L);
  const char *wrong = add_places(m, &l);
  for (uint32_t k = 0; k + 1 < l.n[2]; k++)
    for (uint32_t j = 0; j + 1 < l.n[1]; j++)
      for (uint32_t i = 0; i + 1 < l.n[0] && !wrong; i++) wrong = add_cell(m, &l, (uint32_t[]){i, j, k});
  if (wrong) fail_for(L, "block", wrong);
  return add_solid(L, scene, "block", m, &l, (hk_lua_handle){.nx = l.n[0], .ny = l.n[1], .nz = l.n[2]});
}

/* ---- by hand and of files ---------------------------------------------------------------------------------------- */

static void take_vertices(lua_State *L, hk_mesh *m) {
  char what[64];
  int list = lua_gettop(L);
  for (lua_Integer k = 1; lua_rawgeti(L, list, k) != LUA_TNIL; k++, lua_pop(L, 1)) {
    double x[3];
    snprintf(what, sizeof what, "tetrahedra: vertices[%lld]", (long long)k);
    hk_lua_vector(L, -1, what, x);
    const char *wrong = hk_mesh_add_vertex(m, x);
    if (wrong) fail_for(L, what, wrong);
  }
}

static void take_tetrahedra(lua_State *L, hk_mesh *m) {
  char what[64];
  int list = lua_gettop(L);
  for (lua_Integer k = 1; lua_rawgeti(L, list, k) != LUA_TNIL; k++, lua_pop(L, 1)) {
    uint32_t corner[4];
    snprintf(what, sizeof what, "tetrahedra: tetrahedra[%lld]", (long long)k);
    if (!lua_istable(L, -1) || lua_rawlen(L, -1) != 4) fail_for(L, what, "expected four vertices, { 1, 2, 3, 4 }");
    for (int c = 0; c < 4; c++, lua_pop(L, 1)) {
      double index = lua_rawgeti(L, -1, c + 1) == LUA_TNUMBER ? lua_tonumber(L, -1) : NAN;
      if (!(index >= 1 && index <= (double)m->vertices && floor(index) == index))
        hk_lua_fail(L, HK_BAD_PARAM, "%s: corner %d is none of the vertices 1 to %d", what, c + 1, (int)m->vertices);
      corner[c] = (uint32_t)index - 1;
    }
    const char *wrong = hk_mesh_add_tetrahedron(m, corner);
    if (wrong) fail_for(L, what, wrong);
  }
}

static void read_solid(lua_State *L, hk_mesh *m) {
  if (hk_lua_field(L, 2, "file") == LUA_TSTRING) {
    hk_mesh_load_msh(L, m, "tetrahedra", lua_tostring(L, -1));
    return;
  }
  if (hk_lua_field(L, 2, "vertices") != LUA_TTABLE)
    fail_for(L, "tetrahedra", "file is required, of Gmsh's format MSH 2.2, or vertices and tetrahedra");
  take_vertices(L, m);
  if (hk_lua_field(L, 2, "tetrahedra") == LUA_TTABLE) take_tetrahedra(L, m);
  if (m->tetrahedra == 0) fail_for(L, "tetrahedra", "tetrahedra: there are none");
}

int hk_build_tetrahedra(lua_State *L) {
  static const char *const keys[] = {"file",   "vertices", "tetrahedra", "mass",  "density",
                                     "origin", "scale",    "E",          "group", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "tetrahedra", "scene:tetrahedra { ... }");
  lua_settop(L, 2);
  hk_lua_check_keys(L, 2, "tetrahedra", keys);
  hk_mesh *m = hk_mesh_new(L);
  read_solid(L, m);
  lua_settop(L, 3);
  double scale = hk_lua_field_number(L, 2, "tetrahedra", "scale", 1), origin[3] = {0};
  if (!(scale > 0)) hk_lua_fail(L, HK_BAD_PARAM, "tetrahedra: scale: %g has to be above 0", scale);
  hk_lua_field_vector(L, 2, "tetrahedra", "origin", origin);
  for (size_t k = 0; k < 3 * m->vertices; k++) m->vertex[k] = origin[k % 3] + scale * m->vertex[k];
  hk_solid_enter(L, scene, m, "tetrahedra");
  return 1;
}
