/* Meshes of triangles or tetrahedra on their way from a file or a script into a scene. */
#ifndef HK_MESHES_H
#define HK_MESHES_H

#include "core/script/script.h"
#include "core/storage/storage.h"

typedef struct hk_mesh {
  size_t vertices, vertex_capacity, triangles, triangle_capacity, tetrahedra, tetrahedron_capacity;
  double *vertex;             /* vertices x 3, m */
  uint32_t (*triangle)[3];    /* from 0 */
  uint32_t (*tetrahedron)[4]; /* from 0; the edges from the first corner are right-handed */
} hk_mesh;

enum { HK_FACE_CORNERS = 256 }; /* most corners of a face */

/* An empty mesh as a userdata on the stack: an error that is raised while it is filled frees it. */
hk_mesh *hk_mesh_new(lua_State *L);
void hk_mesh_clear(hk_mesh *);
/* `array` is the address of a pointer: makes room for `count` items; false: no memory. */
bool hk_mesh_grow(void *array, size_t *capacity, size_t count, size_t size);
/* Both return NULL or what is wrong, and change nothing then. A face of more than three corners is cut into triangles;
 * it may be concave, but has to be flat, roughly, and must not cross itself. */
const char *hk_mesh_add_vertex(hk_mesh *, const double x[3]);
const char *hk_mesh_add_face(hk_mesh *, const uint32_t *corner, size_t count);

/* ---- tetra_mesh.c ---- */

/* Corners in any order. Returns NULL or what is wrong, and changes nothing then. */
const char *hk_mesh_add_tetrahedron(hk_mesh *, const uint32_t corner[4]);
double hk_mesh_volume(const hk_mesh *, size_t tetrahedron); /* m^3 */
/* Adds the faces that one tetrahedron alone has as triangles, outwards. Returns NULL or what is wrong with the face of
 * tetrahedra[0] and [1]. */
const char *hk_mesh_add_skin(hk_mesh *, size_t tetrahedra[2]);
/* Leaves out the vertices that no tetrahedron has. Returns NULL or what is wrong. */
const char *hk_mesh_drop_loose(hk_mesh *);

/* ---- body_shapes.c ---- */

/* Shapes about the origin, triangles with their outer side against the clock. Round ones have their axis along z and
 * are inscribed: no point of a facet is further than detail x radius inside of the true surface, and none outside.
 * NULL, or what is wrong. */
const char *hk_mesh_add_sphere(hk_mesh *, double radius, double detail);
const char *hk_mesh_add_capsule(hk_mesh *, double radius, double length,
                                double detail); /* length between the centers */
const char *hk_mesh_add_cylinder(hk_mesh *, double radius, double length, double detail);
const char *hk_mesh_add_box(hk_mesh *, const double size[3]);
const char *hk_mesh_add_square(hk_mesh *, double size); /* in the plane z = 0, seen from above */

/* ---- obj_file.c, msh_file.c ---- */

/* Reads a file beside the script, record by record, by a function that returns NULL or what is wrong with the record;
 * errors begin with `what`. */
void hk_mesh_read(lua_State *L, hk_mesh *, const char *what, const char *name,
                  const char *(*read)(hk_records *, hk_mesh *));
/* The same for an OBJ file, and for the tetrahedra of Gmsh's format MSH 2.2. */
void hk_mesh_load(lua_State *L, hk_mesh *, const char *what, const char *name);
void hk_mesh_load_msh(lua_State *L, hk_mesh *, const char *what, const char *name);

#endif
