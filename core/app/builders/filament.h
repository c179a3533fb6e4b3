/* What strand{} and hair{} share. Errors begin with `what`, the name of the builder; `table` is the stack index of its
 * argument. */
#ifndef HK_FILAMENT_H
#define HK_FILAMENT_H

#include "core/app/builders/builders.h"

bool hk_lua_given(lua_State *L, int table, const char *key);
bool hk_lua_flag(lua_State *L, int table, const char *what, const char *key, bool otherwise);
double hk_lua_above_zero(lua_State *L, int table, const char *what, const char *key, double otherwise);
void hk_lua_unit(lua_State *L, const char *what, const char *key, double v[3]); /* makes it a unit vector */

/* The keys radius, E, nu, density and mass. */
typedef struct hk_lua_material {
  bool there; /* a section is given */
  hk_section section;
  hk_section_numbers numbers; /* NAN: what was not given */
  double mass;                /* kg, of the whole chain, where there is no density */
} hk_lua_material;

/* It may leave a warning with the scene. */
hk_lua_material hk_lua_read_material(lua_State *L, int table, hk_scene *scene, const char *what);
/* The masses of n particles of a chain `length` long. With a section the ends carry half of what the others do; a first
 * segment in a wall has none. */
void hk_lua_share_mass(const hk_lua_material *, uint32_t n, bool wall, double length, double *mass);
/* Keeps the section, if one is given, of the particles that were added last. */
void hk_lua_keep_section(lua_State *L, hk_scene *scene, const hk_lua_material *, uint32_t first, size_t count);
/* What handle.EA, .EI, .EI2, .GJ, .stiffness, .length and .segment are, for chains with segments of l, m. */
void hk_lua_set_numbers(lua_State *L, int handle, const hk_lua_material *, double length, double l);
void hk_lua_pin_roots(lua_State *L, hk_scene *scene, const hk_lua_handle *, const char *what); /* fixed */

/* The key curl: { radius, pitch } or { curvature, torsion }, and phase. */
typedef struct hk_lua_curl {
  bool there, winds, phased; /* winds: radius and pitch; phased: a phase is given */
  double size, twist, phase; /* radius and pitch, m, or curvature and torsion, 1/m; rad */
} hk_lua_curl;

hk_lua_curl hk_lua_read_curl(lua_State *L, int table, const char *what);
/* A chain that starts at `from`: straight, or with the curl's size times `factor`, turned by `phase`. */
hk_helix hk_lua_curl_helix(const hk_lua_curl *, const double from[3], const double direction[3], double phase,
                           double factor);
/* The places of n particles along it, l apart; wall: of the first segment, straight, before its start. */
void hk_lua_lay(const hk_helix *, uint32_t n, bool wall, double l, double (*x)[3]);

#endif
