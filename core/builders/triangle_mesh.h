/* Meshes of triangles or tetrahedra on their way from a file or a script into a scene. */
#ifndef HK_TRIANGLE_MESH_H
#define HK_TRIANGLE_MESH_H

#include "core/builders/builders.h"

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

/* ---- mesh_handle.c ---- */

/* A third of every triangle's mass to each of its corners, as a block on the stack; `what` begins the error of a vertex
 * without area. density in kg/m^2. */
const double *hk_mesh_push_masses(lua_State *L, const hk_mesh *, const char *what, double density);
/* Adds the triangles of a mesh whose vertices are the particles of h, and their sides as edges of the scene if asked.
 * Pushes the handle; the mesh is cleared. */
void hk_mesh_enter(lua_State *L, hk_scene *, hk_mesh *, hk_lua_handle h, bool edges);

#endif
