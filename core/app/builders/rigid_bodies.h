/* Rigid bodies in scripts: what rigid.c and joint.c share. */
#ifndef HK_RIGID_BODIES_H
#define HK_RIGID_BODIES_H

#include "core/app/builders/builders.h"
#include "core/app/shapes/shapes.h"

/* The userdata that scene:rigid returns; its first user value is the scene. */
typedef struct hk_lua_rigid {
  uint32_t first; /* id of the first of body.count particles */
  hk_rigid_body body;
} hk_lua_rigid;

/* ---- rigid.c ---- */

hk_lua_rigid *hk_rigid_push(lua_State *L, int scene, const hk_lua_rigid *);
hk_lua_rigid *hk_rigid_to(lua_State *L, int index); /* NULL: the value is no rigid body */
/* Adds a rider of the body at the point y of its frame, m, and returns its id. */
uint32_t hk_rigid_add_point(lua_State *L, hk_scene *, const hk_lua_rigid *, const double y[3]);

#endif
