/* Rigid bodies and joints in scripts: what rigid.c, joint.c and joint_handle.c share. */
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
int hk_rigid_push_vector(lua_State *, const double vector[3]); /* {x, y, z}; returns 1 */
/* Its motion in the state at index 2; an error shows the form of the call. */
hk_rigid_motion hk_rigid_motion_at(lua_State *L, const hk_lua_rigid *, const char *form);
/* The place, m, of the point y of its frame. */
void hk_rigid_place_of(const hk_rigid_body *, const hk_rigid_motion *, const double y[3], double x[3]);

/* ---- joints ---- */

enum {
  HK_JOINT_BALL,
  HK_JOINT_HINGE,
  HK_JOINT_SLIDER,
  HK_JOINT_UNIVERSAL,
  HK_JOINT_FIXED,
  HK_JOINT_DISTANCE,
  HK_JOINTS
};

/* The tuples of a joint in the lists of the scene: distances, differences, ways. */
typedef struct hk_joint_range {
  size_t first, count;
} hk_joint_range;

/* The userdata that scene:joint returns; its first user value is the scene. */
typedef struct hk_lua_joint {
  int kind;
  const char *kind_name;
  hk_lua_rigid a, b;                  /* b: where has_b */
  bool has_b;                         /* another body, not a particle or what stands still */
  uint32_t particle;                  /* in the place of b; 0: none */
  double at[3], size;                 /* m, at the start; points of the joint are this far apart */
  double axis[3];                     /* at the start; of a hinge and a slider */
  double turned[9];                   /* the attitude of a in the frame of b at the start, by rows */
  double in_a[3], in_b[3], axis_b[3]; /* `at` in both frames, the axis in that of b */
  hk_joint_range part[3];
} hk_lua_joint;

/* ---- joint_handle.c ---- */

/* Adds a point at the place of the start, of a or of b: a rider, or a particle that stands still. */
uint32_t hk_joint_point(lua_State *L, hk_scene *, const hk_lua_joint *, bool of_a, const double at[3]);
/* Pushes its handle, which finds the frames of the joint's place and axis. */
void hk_joint_push(lua_State *L, int scene, const hk_lua_joint *);

#endif
