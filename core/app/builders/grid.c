/* scene:grid{ nx, ny, width, height }: rows of particles in a plane, with the edges between neighbours and two
 * triangles in every cell. Their diagonals all run the same way, or, with `alternating`, from cell to cell the other
 * way, so that neither way is preferred. With `density`, kg/m^2, a particle has the mass of a cell, those at the border
 * half and at the corners a quarter of it, so that refinement does not move mass to the border; with `mass` all have
 * the same. */
#include "core/app/builders/builders.h"

static void add_surface(lua_State *L, hk_scene *scene, const hk_lua_handle *h) {
  hk_error error = {0};
  size_t count = 2 * (size_t)(h->nx - 1) * (h->ny - 1);
  uint32_t(*triangle)[3] = lua_newuserdatauv(L, (count + 1) * sizeof *triangle, 0);
  hk_limits_take(L, count * sizeof *triangle);
  for (size_t t = 0; t < count; t++) hk_lua_grid_triangle(h, t, triangle[t]);
  if (hk_scene_add_triangles(scene, count, (const uint32_t(*)[3])triangle, &error) != HK_OK) hk_lua_raise(L, &error);
}

typedef struct frame {
  double origin[3], u[3], v[3]; /* the sides, m, with their lengths */
} frame;

static frame read_frame(lua_State *L) {
  frame f = {.u = {1, 0, 0}, .v = {0, 1, 0}};
  double width = hk_lua_field_number(L, 2, "grid", "width", 1), height = hk_lua_field_number(L, 2, "grid", "height", 1);
  hk_lua_field_vector(L, 2, "grid", "origin", f.origin);
  hk_lua_field_vector(L, 2, "grid", "u", f.u);
  hk_lua_field_vector(L, 2, "grid", "v", f.v);
  for (int c = 0; c < 3; c++) f.u[c] *= width, f.v[c] *= height;
  return f;
}

static const double *push_places(lua_State *L, const hk_lua_handle *h, const frame *f) {
  size_t n = (size_t)h->nx * h->ny;
  double *x = lua_newuserdatauv(L, 3 * n * sizeof *x, 0);
  for (size_t k = 0; k < n; k++) {
    size_t row = k / h->nx, column = k % h->nx;
    double s = h->nx > 1 ? (double)column / (h->nx - 1) : 0, t = h->ny > 1 ? (double)row / (h->ny - 1) : 0;
    for (int c = 0; c < 3; c++) x[3 * k + (size_t)c] = f->origin[c] + s * f->u[c] + t * f->v[c];
  }
  return x;
}

/* Half at either end of a row of n. */
static double share(size_t k, uint32_t n) { return k == 0 || k + 1 == n ? 0.5 : 1; }

static const double *push_masses(lua_State *L, const hk_lua_handle *h, const frame *f, double density) {
  double uu = 0, vv = 0, uv = 0;
  if (h->nx < 2 || h->ny < 2) hk_lua_fail(L, HK_BAD_PARAM, "grid: density: one row has no area; give its mass");
  for (int c = 0; c < 3; c++) uu += f->u[c] * f->u[c], vv += f->v[c] * f->v[c], uv += f->u[c] * f->v[c];
  double cell = sqrt(fmax(0, uu * vv - uv * uv)) / ((double)(h->nx - 1) * (h->ny - 1));
  size_t n = (size_t)h->nx * h->ny;
  double *mass = lua_newuserdatauv(L, n * sizeof *mass, 0);
  for (size_t k = 0; k < n; k++) mass[k] = density * cell * share(k % h->nx, h->nx) * share(k / h->nx, h->ny);
  return mass;
}

int hk_build_grid(lua_State *L) {
  static const char *const keys[] = {"nx", "ny", "width", "height",      "mass",     "density", "origin",
                                     "u",  "v",  "group", "alternating", "material", NULL};
  hk_scene *scene = hk_lua_scene(L, 1);
  hk_lua_check_table(L, 2, "grid", "scene:grid { ... }");
  lua_settop(L, 2);
  hk_lua_take_material(L, scene, 2, "grid");
  hk_lua_check_keys(L, 2, "grid", keys);
  hk_lua_handle h = {.nx = hk_lua_count(L, 2, "grid", "nx", 1),
                     .ny = hk_lua_count(L, 2, "grid", "ny", 1),
                     .grid = true,
                     .alternating = hk_lua_field_flag(L, 2, "grid", "alternating")};
  double density, mass = hk_lua_mass(L, 2, "grid", &density);
  frame f = read_frame(L);
  size_t n = (size_t)h.nx * h.ny;
  h.count = (uint32_t)n; /* a scene has no more */
  const double *x = push_places(L, &h, &f), *each = density > 0 ? push_masses(L, &h, &f, density) : NULL;
  h.first = hk_lua_add(L, scene, "grid", n, x, NULL, each, mass / (double)n, hk_lua_group(L, scene, 2, "grid"));
  lua_settop(L, 2);
  hk_lua_push_structural(L, &h);
  hk_lua_add_edges(L, scene);
  if (h.nx > 1 && h.ny > 1) add_surface(L, scene, &h);
  lua_settop(L, 2);
  hk_lua_push_handle(L, h);
  return 1;
}
