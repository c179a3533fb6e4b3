/* Shapes as scripts describe them: implicit ones (core/scene/meshes/meshes.h), read from a table, their functions
 * called at places; those of rigid bodies, with their moments. */
#ifndef HK_SHAPES_H
#define HK_SHAPES_H

#include "core/app/mesh_files/mesh_files.h"
#include "core/scene/rigid/rigid.h"

/* ---- implicit_shape.c ---- */

typedef struct hk_script_shape {
  lua_State *L;
  hk_implicit_shape shape;
  hk_error error; /* of the first function that failed, with the place; the values that follow are NAN */
  size_t calls;
} hk_script_shape;

enum { HK_SHAPE_KEYS = 10 };
extern const char *const hk_shape_keys[HK_SHAPE_KEYS]; /* of its table */

/* Reads the table at `table`; its memory and its functions stay on the stack, which must not be cut below. */
void hk_script_shape_read(lua_State *L, int table, hk_script_shape *);
/* Values at places; it raises nothing. */
void hk_script_shape_evaluate(const void *shape, const double (*x)[3], size_t count, double *value);

/* ---- rigid_shape.c ---- */

/* Reads shape, sizes, mass, density, inertia, points or parts from the table at 2; `skin`, empty, gets the surface. */
hk_moments hk_rigid_read(lua_State *L, hk_mesh *skin);
/* The rotation at the key "orientation" of the table, by rows: a rotation vector (three numbers, rad), a unit
 * quaternion (four numbers, w first) or a matrix (three rows); 1 where it is absent. */
void hk_rigid_read_orientation(lua_State *L, int table, double R[9]);
/* Refuses particles x of the body so far from the origin that rounding takes more than 1e-6 of its extent. */
void hk_rigid_check_digits(lua_State *L, const hk_rigid_body *, const double position[3], const double *x);

#endif
