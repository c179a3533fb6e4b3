/* Rigid bodies in scripts: what rigid.c, rigid_shape.c and joint.c share. */
#ifndef HK_RIGID_BODIES_H
#define HK_RIGID_BODIES_H

#include "core/app/builders/builders.h"
#include "core/app/mesh_files/mesh_files.h"
#include "core/scene/rigid/rigid.h"

/* The userdata that scene:rigid returns; its first user value is the scene. */
typedef struct hk_lua_rigid {
  uint32_t first; /* id of the first of body.count particles */
  hk_rigid_body body;
} hk_lua_rigid;

/* ---- rigid_shape.c ---- */

/* Reads shape, sizes, mass, density, inertia, points or parts from the table at 2; `skin`, empty, gets the surface. */
hk_moments hk_rigid_read(lua_State *L, hk_mesh *skin);
/* The rotation at the key "orientation" of the table, by rows: a rotation vector (three numbers, rad), a unit
 * quaternion (four numbers, w first) or a matrix (three rows); 1 where it is absent. */
void hk_rigid_read_orientation(lua_State *L, int table, double R[9]);

/* ---- rigid.c ---- */

hk_lua_rigid *hk_rigid_push(lua_State *L, int scene, const hk_lua_rigid *);
hk_lua_rigid *hk_rigid_to(lua_State *L, int index); /* NULL: the value is no rigid body */
/* Adds a rider of the body at the point y of its frame, m, and returns its id. */
uint32_t hk_rigid_add_point(lua_State *L, hk_scene *, const hk_lua_rigid *, const double y[3]);

#endif
