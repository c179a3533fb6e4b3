/* scene:membrane(cloth, { stiffness =, nu =, damping = }): numbers for the edges of a cloth whose material is given by
 * area, { edges =, k =, damping = }, to be handed to a force along edges. Y is the membrane's stiffness E h, N/m: a
 * strip of width b is pulled to the strain e by Y b e. Poisson's ratio nu is how much it narrows meanwhile. An edge of
 * stiffness k and rest length L along the unit vector d adds k L^2 d_i d_j d_k d_l/(area) to the elasticity C_ijkl,
 * which is symmetric in all its indices: what acts along edges alone has C_xxyy = C_xyxy whatever the mesh, and is
 * isotropic for nu = 1/3 only.
 *
 * Grids of cells a x b have edges along their sides and both diagonals. With C11 = C22 = Y/(1 - nu^2), C12 = nu C11,
 *     k_d = C12 (a^2 + b^2)/(2 a b),  k_x = (b/a) (C11 - C12 a^2/b^2),  k_y = (a/b) (C11 - C12 b^2/a^2);
 * squares: k = Y/(1 + nu) and k_d = nu C11. These are exact, along the sides, for any nu from 0 to 1 and cells with
 * nu a^2/b^2 <= 1; the shear stiffness is C66 = C12, that of an isotropic sheet for nu = 1/3 alone. Edges on the border
 * have half of k: they have a cell on one side only. Without that the error under refinement is of order 1.
 *
 * Meshes have edges along the sides of their triangles. Every triangle at a side adds to it
 *     k = 3/8 Y (1 + cot b cot c)/(cot b + cot c),
 * b, c its angles at the two ends: exact for equilateral triangles, as Y area/|e|^2 of Van Gelder (J. Graphics Tools 3
 * (1998)) is, and also for squares of alternating diagonals, which that makes 0.75 to 1.2 times as stiff as Y. Both
 * have nu = 1/3, which is the only one that meshes take; others get Y and nu the more nearly, the more even they are. A
 * side of triangles so oblique that k would be below 0 (two angles differ by more than 90 degrees) has none. */
#include "core/app/builders/builders.h"

#include <stdlib.h>

typedef struct material {
  double Y, nu, damping; /* N/m, 1, N s/m or NAN */
} material;

static material read_material(lua_State *L) {
  static const char *const keys[] = {"stiffness", "nu", "damping", NULL};
  hk_lua_check_keys(L, 3, "membrane", keys);
  material m = {hk_lua_field_number(L, 3, "membrane", "stiffness", NAN),
                hk_lua_field_number(L, 3, "membrane", "nu", 1.0 / 3),
                hk_lua_field_number(L, 3, "membrane", "damping", NAN)};
  if (!(m.Y > 0)) hk_lua_fail(L, HK_BAD_PARAM, "membrane: stiffness: a number of N/m above 0 has to be given");
  if (!(m.nu >= 0 && m.nu < 1)) hk_lua_fail(L, HK_BAD_PARAM, "membrane: nu: %g is not from 0 to below 1", m.nu);
  if (m.damping < 0) hk_lua_fail(L, HK_BAD_PARAM, "membrane: damping: %g is below the minimum 0", m.damping);
  return m;
}

static const double *place(const hk_scene *scene, uint32_t id) {
  return scene->particles.position + 3 * (size_t)(id - 1);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void side(const hk_scene *scene, uint32_t from, uint32_t to, double d[3]) {
  for (int c = 0; c < 3; c++) d[c] = place(scene, to)[c] - place(scene, from)[c];
}

/* ---- grids ---- */

typedef struct cell {
  double x, y, diagonal; /* N/m, of edges inside */
} cell;

static cell stiffness_of(lua_State *L, const hk_scene *scene, const hk_lua_handle *h, const material *m) {
  double u[3], v[3], C11 = m->Y / (1 - m->nu * m->nu), C12 = m->nu * C11;
  if (h->nx < 2 || h->ny < 2) hk_lua_fail(L, HK_BAD_PARAM, "membrane: a grid of one row has no area");
  side(scene, h->first, h->first + 1, u);
  side(scene, h->first, h->first + h->nx, v);
  double aa = dot(u, u), bb = dot(v, v), a = sqrt(aa), b = sqrt(bb);
  if (!(a > 0 && b > 0 && fabs(dot(u, v)) <= 1e-9 * a * b)) /* 1e-9: the sides are given to ten digits or so */
    hk_lua_fail(L, HK_BAD_PARAM, "membrane: the sides u and v of the grid's cells are not at a right angle");
  if (m->nu * fmax(aa / bb, bb / aa) > 1 + 1e-12)
    hk_lua_fail(L, HK_BAD_PARAM,
                "membrane: cells of %g m x %g m can have a Poisson's ratio of %.3g at most: take squarer cells", a, b,
                fmin(aa / bb, bb / aa));
  return (cell){fmax(0, b / a * (C11 - C12 * aa / bb)), fmax(0, a / b * (C11 - C12 * bb / aa)),
                C12 * (aa + bb) / (2 * a * b)};
}

/* Adds the edges of one offset, those of border rows and columns with half of k; `along`: 0 the x sides, 1 the y
 * sides, 2 diagonals. */
static void add_edges(const hk_lua_handle *h, int along, int di, double k, hk_lua_edges *edges, double *list) {
  uint32_t dj = along > 0, i0 = di < 0, i1 = h->nx - (di > 0);
  for (uint32_t j = 0; j + dj < h->ny; j++)
    for (uint32_t i = i0; i < i1; i++) {
      bool border = along == 0 ? j == 0 || j + 1 == h->ny : along == 1 && (i == 0 || i + 1 == h->nx);
      uint32_t *pair = edges->pair[edges->count];
      pair[0] = h->first + j * h->nx + i;
      pair[1] = pair[0] + dj * h->nx + (uint32_t)di;
      list[edges->count++] = border ? k / 2 : k;
    }
}

static hk_lua_edges *grid_edges(lua_State *L, const hk_scene *scene, const hk_lua_handle *h, const material *m,
                                double **k) {
  cell s = stiffness_of(L, scene, h, m);
  size_t nx = h->nx, ny = h->ny, most = (nx - 1) * ny + nx * (ny - 1) + 2 * (nx - 1) * (ny - 1);
  *k = lua_newuserdatauv(L, most * sizeof **k, 0);
  hk_lua_edges *edges = hk_lua_new_edges(L, most);
  edges->count = 0;
  add_edges(h, 0, 1, s.x, edges, *k);
  add_edges(h, 1, 0, s.y, edges, *k);
  if (s.diagonal > 0) add_edges(h, 2, 1, s.diagonal, edges, *k);
  if (s.diagonal > 0) add_edges(h, 2, -1, s.diagonal, edges, *k);
  return edges;
}

/* ---- meshes ---- */

/* The position of a pair in the edges of a mesh, which are sorted, with the lower id first; edges->count: none. */
static size_t find_edge(const hk_lua_edges *edges, uint32_t a, uint32_t b) {
  uint32_t low = a < b ? a : b, high = a < b ? b : a;
  size_t from = 0, to = edges->count;
  while (from < to) {
    size_t middle = (from + to) / 2;
    const uint32_t *pair = edges->pair[middle];
    if (pair[0] < low || (pair[0] == low && pair[1] < high))
      from = middle + 1;
    else
      to = middle;
  }
  bool found = from < edges->count && edges->pair[from][0] == low && edges->pair[from][1] == high;
  return found ? from : edges->count;
}

/* k/Y of the side from b to c of the triangle a b c: with F twice its area and p, q the products of e with the sides
 * from b and from c to a, both seen from their end, cot b = p/F, cot c = q/F and p + q = e^2. */
static double side_stiffness(const hk_scene *scene, uint32_t b, uint32_t c, uint32_t a) {
  double e[3], u[3];
  side(scene, b, c, e);
  side(scene, b, a, u);
  double ee = dot(e, e), before = dot(u, e), twice = sqrt(fmax(0, dot(u, u) * ee - before * before));
  return twice > 0 ? 3.0 / 8 * (twice * twice + before * (ee - before)) / (twice * ee) : 0;
}

/* Adds to the three sides of a triangle; false: one is none of the edges. */
static bool add_triangle(const hk_scene *scene, const uint32_t corner[3], double Y, const hk_lua_edges *edges,
                         double *k) {
  for (int c = 0; c < 3; c++) {
    uint32_t a = corner[c], b = corner[(c + 1) % 3];
    size_t e = find_edge(edges, a, b);
    if (e == edges->count) return false;
    k[e] += Y * side_stiffness(scene, a, b, corner[(c + 2) % 3]);
  }
  return true;
}

static const hk_lua_edges *mesh_edges(lua_State *L, const hk_scene *scene, const material *m, double **k) {
  if (fabs(m->nu - 1.0 / 3) > 1e-9)
    hk_lua_fail(L, HK_BAD_PARAM,
                "membrane: nu: edges of triangles alone have a Poisson's ratio of 1/3, not %g; a grid takes "
                "others",
                m->nu);
  if (lua_getiuservalue(L, 2, 1) != LUA_TUSERDATA || lua_getiuservalue(L, 2, 2) != LUA_TTABLE)
    hk_lua_fail(L, HK_BAD_PARAM, "membrane: expected a grid or a mesh: others have no area");
  int triangles = lua_gettop(L);
  const hk_lua_edges *edges = hk_lua_to_edges(L, triangles - 1);
  *k = lua_newuserdatauv(L, (edges->count + 1) * sizeof **k, 0);
  for (size_t e = 0; e < edges->count; e++) (*k)[e] = 0;
  for (lua_Integer t = 1; lua_rawgeti(L, triangles, t) == LUA_TTABLE; t++, lua_pop(L, 1)) {
    uint32_t corner[3] = {0};
    for (int c = 0; c < 3; c++, lua_pop(L, 1)) {
      lua_rawgeti(L, -1, c + 1);
      double id = lua_tonumber(L, -1);
      corner[c] = id >= 1 && id <= (double)scene->particles.n ? (uint32_t)id : 0;
    }
    bool whole = corner[0] && corner[1] && corner[2];
    if (!whole || !add_triangle(scene, corner, m->Y, edges, *k)) /* the script has changed the list */
      hk_lua_fail(L, HK_BAD_PARAM, "membrane: triangle %d is none of the mesh", (int)t);
  }
  for (size_t e = 0; e < edges->count; e++) (*k)[e] = fmax(0, (*k)[e]);
  lua_pushvalue(L, triangles - 1);
  return edges;
}

/* ---- */

static void push_numbers(lua_State *L, const double *list, size_t count, double factor) {
  lua_createtable(L, (int)count, 0);
  for (size_t e = 0; e < count; e++) {
    lua_pushnumber(L, factor * list[e]);
    lua_rawseti(L, -2, (lua_Integer)e + 1);
  }
}

int hk_build_membrane(lua_State *L) {
  const hk_scene *scene = hk_lua_scene(L, 1);
  const hk_lua_handle *h = hk_lua_to_handle(L, 2);
  if (!h) return hk_lua_fail(L, HK_BAD_PARAM, "membrane: expected scene:membrane(cloth, { stiffness = })");
  hk_lua_check_table(L, 3, "membrane", "scene:membrane(handle, { ... })");
  lua_settop(L, 3);
  if (scene->spent) return hk_lua_fail(L, HK_BAD_PARAM, "membrane: the scene runs and can no longer be asked");
  if (h->first < 1 || h->first - 1 + (size_t)h->count > scene->particles.n)
    return hk_lua_fail(L, HK_BAD_PARAM, "membrane: the particles belong to another scene");
  material m = read_material(L);
  double *k;
  const hk_lua_edges *edges = h->grid ? grid_edges(L, scene, h, &m, &k) : mesh_edges(L, scene, &m, &k);
  int list = lua_gettop(L);
  lua_createtable(L, 0, 3);
  lua_pushvalue(L, list);
  lua_setfield(L, -2, "edges");
  push_numbers(L, k, edges->count, 1);
  lua_setfield(L, -2, "k");
  if (!isnan(m.damping)) {
    push_numbers(L, k, edges->count, m.damping / m.Y);
    lua_setfield(L, -2, "damping");
  }
  return 1;
}
