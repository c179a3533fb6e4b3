#ifndef HK_OBJ_FILE_H
#define HK_OBJ_FILE_H

#include "core/builders/triangle_mesh.h"
#include "core/storage/storage.h"

/* Reads a file beside the script, record by record, by a function that returns NULL or what is wrong with the record;
 * errors begin with `what`. */
void hk_mesh_read(lua_State *L, hk_mesh *, const char *what, const char *name,
                  const char *(*read)(hk_records *, hk_mesh *));
/* The same for an OBJ file, and for the tetrahedra of Gmsh's format MSH 2.2. */
void hk_mesh_load(lua_State *L, hk_mesh *, const char *what, const char *name);
void hk_mesh_load_msh(lua_State *L, hk_mesh *, const char *what, const char *name);

#endif
