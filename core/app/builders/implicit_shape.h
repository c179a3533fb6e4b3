/* An implicit shape of a script (core/scene/meshes/meshes.h): read from a table, its functions called at places. */
#ifndef HK_IMPLICIT_SHAPE_H
#define HK_IMPLICIT_SHAPE_H

#include "core/app/builders/mesh_handle.h"

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

#endif
