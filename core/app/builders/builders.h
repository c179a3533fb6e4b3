/* The builders, methods of a scene that add particles, edges and triangles and return a handle. */
#ifndef HK_BUILDERS_H
#define HK_BUILDERS_H

#include "core/app/script/script.h"

extern const luaL_Reg hk_builders[]; /* list.c: the methods of a scene; a name NULL ends them */

int hk_build_particle(lua_State *L);
int hk_build_particles(lua_State *L);
int hk_build_grid(lua_State *L);
int hk_build_strand(lua_State *L);
int hk_build_hair(lua_State *L);
int hk_build_mesh(lua_State *L);
int hk_build_body(lua_State *L);
int hk_build_rigid(lua_State *L);
int hk_build_joint(lua_State *L);
void hk_lua_open_rigid(lua_State *L); /* the metatables of their handles */
void hk_lua_open_joint(lua_State *L);
int hk_build_membrane(lua_State *L);
int hk_build_block(lua_State *L);
int hk_build_tetrahedra(lua_State *L);
int hk_build_surface(lua_State *L);
int hk_build_implicit(lua_State *L);

/* ---- for builders; errors begin with `what` ---- */

uint32_t hk_lua_group(lua_State *L, hk_scene *scene, int table, const char *what); /* value of the key "group" */
uint32_t hk_lua_count(lua_State *L, int table, const char *what, const char *key, double least); /* up to a million */
/* Values of the keys "mass" (kg, in all; 1 where neither is given) and "density" (kg/m^2; NAN: not given). */
double hk_lua_mass(lua_State *L, int table, const char *what, double *density);
bool hk_lua_field_flag(lua_State *L, int table, const char *what, const char *key); /* false where it is absent */
/* Adds particles; returns the first id. */
uint32_t hk_lua_add(lua_State *L, hk_scene *scene, const char *what, size_t count, const double *x, const double *v,
                    const double *mass, double common, uint32_t group);
void hk_lua_add_edges(lua_State *L, hk_scene *scene); /* those on top of the stack */
void hk_lua_raise_for(lua_State *L, const char *what, const hk_error *error) __attribute__((noreturn));

#endif
