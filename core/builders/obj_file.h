#ifndef HK_OBJ_FILE_H
#define HK_OBJ_FILE_H

#include "core/builders/triangle_mesh.h"

/* Reads an OBJ file beside the script; errors begin with `what`. */
void hk_mesh_load(lua_State *L, hk_mesh *, const char *what, const char *name);

#endif
