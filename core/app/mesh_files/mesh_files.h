/* Files of meshes, read for a script. */
#ifndef HK_MESH_FILES_H
#define HK_MESH_FILES_H

#include "core/app/script/script.h"
#include "core/scene/meshes/meshes.h"

/* An empty mesh as a userdata on the stack: an error that is raised while it is filled frees it. */
hk_mesh *hk_mesh_new(lua_State *L);

/* Reads a file beside the script, record by record, by a function that returns NULL or what is wrong with the record;
 * errors begin with `what`. */
void hk_mesh_read(lua_State *L, hk_mesh *, const char *what, const char *name,
                  const char *(*read)(hk_records *, hk_mesh *));
/* The same for an OBJ file, and for the tetrahedra of Gmsh's format MSH 2.2. */
void hk_mesh_load(lua_State *L, hk_mesh *, const char *what, const char *name);
void hk_mesh_load_msh(lua_State *L, hk_mesh *, const char *what, const char *name);

#endif
