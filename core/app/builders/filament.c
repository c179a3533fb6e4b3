/* What strand{} and hair{} share: reading a section, a material and a curl, the mass of a chain's particles, the wall
 * at its root and the numbers that its handle answers. */
#include "core/app/builders/filament.h"

#include <stdio.h>

bool hk_lua_given(lua_State *L, int table, const char *key) {
  bool is = hk_lua_field(L, table, key) != LUA_TNIL;
  lua_pop(L, 1);
  return is;
}

bool hk_lua_flag(lua_State *L, int table, const char *what, const char *key, bool otherwise) {
  int type = hk_lua_field(L, table, key);
  bool value = type == LUA_TNIL ? otherwise : lua_toboolean(L, -1);
  if (type != LUA_TNIL && type != LUA_TBOOLEAN)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: expected true or false", what, key);
  lua_pop(L, 1);
  return value;
}

double hk_lua_above_zero(lua_State *L, int table, const char *what, const char *key, double otherwise) {
  double value = hk_lua_field_number(L, table, what, key, otherwise);
  if (value <= 0) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: %g must be above 0", what, key, value);
  return value;
}

void hk_lua_unit(lua_State *L, const char *what, const char *key, double v[3]) {
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (!(length > 0 && length < INFINITY)) hk_lua_fail(L, HK_BAD_PARAM, "%s: %s: must not be zero", what, key);
  for (int c = 0; c < 3; c++) v[c] /= length;
}

/* ---- section and material ---- */

/* radius = r, or the half axes { a, b } of an ellipse. */
static void read_radius(lua_State *L, int table, const char *what, double half_axis[2]) {
  char name[64];
  snprintf(name, sizeof name, "%s: radius", what);
  bool two = hk_lua_field(L, table, "radius") == LUA_TTABLE;
  if (two && lua_rawlen(L, -1) != 2)
    hk_lua_fail(L, HK_BAD_PARAM, "%s: expected a number, or the two half axes of an ellipse, { a, b }", name);
  for (int k = 0; k < 2; k++) {
    if (two) lua_rawgeti(L, -1, k + 1);
    half_axis[k] = hk_lua_number(L, -1, name);
    if (two) lua_pop(L, 1);
  }
  lua_pop(L, 1);
}

/* Of a section one expects the mass of its material. */
static void warn_of_mass(lua_State *L, int table, hk_scene *scene, const char *what) {
  if (hk_lua_given(L, table, "mass") || hk_lua_given(L, table, "density")) return;
  hk_lua_warn(L, scene,
              "%s: the section has a radius and no density, so that the mass is 1 kg, which it is where nothing is "
              "given: give density (kg/m^3), or mass (kg)",
              what);
}

hk_lua_material hk_lua_read_material(lua_State *L, int table, hk_scene *scene, const char *what) {
  hk_error error = {0};
  hk_lua_material m = {.there = hk_lua_given(L, table, "radius")};
  static const char *const of_section[] = {"E", "nu", "density", NULL};
  for (const char *const *key = of_section; *key && !m.there; key++)
    if (hk_lua_given(L, table, *key))
      hk_lua_fail(L, HK_BAD_PARAM, "%s: %s says nothing without the radius of the section", what, *key);
  if (hk_lua_given(L, table, "nu") && !hk_lua_given(L, table, "E"))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: nu says nothing without E", what);
  if (hk_lua_given(L, table, "mass") && hk_lua_given(L, table, "density"))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: give mass or density, not both", what);
  m.mass = hk_lua_field_number(L, table, what, "mass", 1);
  if (!m.there) return m;
  warn_of_mass(L, table, scene, what);
  read_radius(L, table, what, m.section.half_axis);
  m.section.E = hk_lua_field_number(L, table, what, "E", NAN);
  m.section.nu = hk_lua_field_number(L, table, what, "nu", NAN);
  m.section.density = hk_lua_field_number(L, table, what, "density", NAN);
  if (hk_section_check(&m.section, &error) != HK_OK) hk_lua_raise_for(L, what, &error);
  m.numbers = hk_section_of(&m.section);
  return m;
}

void hk_lua_share_mass(const hk_lua_material *m, uint32_t n, bool wall, double length, double *mass) {
  uint32_t first = wall ? 1 : 0, segments = n - 1 - first;
  double all = isnan(m->numbers.line_mass) || !m->there ? m->mass : m->numbers.line_mass * length;
  mass[0] = 0;
  for (uint32_t k = first; k < n; k++)
    mass[k] = m->there ? all / segments * (k == first || k == n - 1 ? 0.5 : 1) : all / (n - first);
}

void hk_lua_keep_section(lua_State *L, hk_scene *scene, const hk_lua_material *m, uint32_t first, size_t count) {
  hk_error error = {0};
  hk_limits_take(L, sizeof(hk_strand));
  if (m->there && hk_scene_add_strand(scene, first, count, m->section.half_axis, &error) != HK_OK)
    hk_lua_raise(L, &error);
}

static void set(lua_State *L, const char *key, double value) {
  if (isnan(value)) return;
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

void hk_lua_set_numbers(lua_State *L, int handle, const hk_lua_material *m, double length, double l) {
  handle = lua_absindex(L, handle);
  lua_newtable(L);
  set(L, "length", length);
  set(L, "segment", l);
  if (m->there) {
    const hk_section_numbers *s = &m->numbers;
    set(L, "EA", s->EA);
    set(L, "GJ", s->GJ);
    set(L, "stiffness", s->EA / l);
    set(L, "EI", s->EI[0]);
    set(L, "EI2", s->EI[1]);
  }
  lua_setiuservalue(L, handle, HK_LUA_NUMBERS);
}

/* ---- curls ---- */

hk_lua_curl hk_lua_read_curl(lua_State *L, int table, const char *what) {
  static const char *const keys[] = {"radius", "pitch", "curvature", "torsion", "phase", NULL};
  char name[64];
  hk_lua_curl curl = {.there = false};
  snprintf(name, sizeof name, "%s: curl", what);
  int type = hk_lua_field(L, table, "curl"), at = lua_gettop(L);
  if (type != LUA_TNIL) {
    if (type != LUA_TTABLE)
      hk_lua_fail(L, HK_BAD_PARAM, "%s: expected { radius =, pitch = } or { curvature =, torsion = }", name);
    hk_lua_check_keys(L, at, name, keys);
    curl.there = true;
    curl.winds = hk_lua_given(L, at, "radius");
    bool bends = hk_lua_given(L, at, "curvature");
    if (curl.winds == bends || hk_lua_given(L, at, curl.winds ? "torsion" : "pitch"))
      hk_lua_fail(L, HK_BAD_PARAM, "%s: give radius and pitch, or curvature and torsion", name);
    curl.size = hk_lua_above_zero(L, at, name, curl.winds ? "radius" : "curvature", NAN);
    curl.twist = hk_lua_field_number(L, at, name, curl.winds ? "pitch" : "torsion", 0);
    curl.phased = hk_lua_given(L, at, "phase");
    curl.phase = hk_lua_field_number(L, at, name, "phase", 0);
  }
  lua_settop(L, at - 1);
  return curl;
}

hk_helix hk_lua_curl_helix(const hk_lua_curl *curl, const double from[3], const double direction[3], double phase,
                           double factor) {
  if (!curl->there) return hk_helix_about(from, direction, 0, 0, 0);
  if (curl->winds) return hk_helix_about(from, direction, curl->phase + phase, factor * curl->size, curl->twist);
  return hk_helix_along(from, direction, curl->phase + phase, factor * curl->size, curl->twist);
}

void hk_lua_lay(const hk_helix *helix, uint32_t n, bool wall, double l, double (*x)[3]) {
  double tangent[3];
  for (uint32_t k = 0; k < n; k++) hk_helix_at(helix, l * ((double)k - wall), x[k]);
  if (!wall) return;
  hk_helix_tangent(helix, tangent);
  for (int c = 0; c < 3; c++) x[0][c] = helix->from[c] - l * tangent[c];
}

void hk_lua_pin_roots(lua_State *L, hk_scene *scene, const hk_lua_handle *h, const char *what) {
  hk_error error = {0};
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = (size_t)h->ny * h->roots, .release = INFINITY};
  pin.id = lua_newuserdatauv(L, (pin.count + 1) * sizeof *pin.id, 0);
  for (uint32_t k = 0; k < pin.count; k++) pin.id[k] = hk_lua_root(h, k);
  hk_limits_take(L, sizeof pin + pin.count * sizeof *pin.id);
  pin.where = (char *)(uintptr_t)hk_lua_where(L); /* hk_scene_add_pin copies it */
  if (hk_scene_add_pin(scene, &pin, &error) != HK_OK) hk_lua_raise_for(L, what, &error);
}
