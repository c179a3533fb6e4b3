/* Meshes of triangles or tetrahedra, built from files or scripts and checked before a scene takes them. Functions that
 * return text return NULL on success, otherwise a sentence with the cause; those that add one vertex, face or
 * tetrahedron then change nothing. */
#ifndef HK_MESHES_H
#define HK_MESHES_H

#include "core/engine/base/base.h"

typedef struct hk_mesh {
  size_t vertices, vertex_capacity, triangles, triangle_capacity, tetrahedra, tetrahedron_capacity;
  double *vertex;             /* vertices x 3, m */
  uint32_t (*triangle)[3];    /* from 0 */
  uint32_t (*tetrahedron)[4]; /* from 0; the edges from the first corner are right-handed */
} hk_mesh;

enum { HK_FACE_CORNERS = 256 }; /* of a face, at most */

void hk_mesh_clear(hk_mesh *);
/* Reserves `count` items of `size` bytes in the array whose pointer is at `array`. False: no memory. */
bool hk_mesh_grow(void *array, size_t *capacity, size_t count, size_t size);
/* Faces of more than three corners are triangulated; they may be concave, have to be roughly flat, and must not cross
 * themselves. */
const char *hk_mesh_add_vertex(hk_mesh *, const double x[3]);
const char *hk_mesh_add_face(hk_mesh *, const uint32_t *corner, size_t count);

/* ---- tetra_mesh.c ---- */

/* Corners in any order; they are reordered to be right-handed. */
const char *hk_mesh_add_tetrahedron(hk_mesh *, const uint32_t corner[4]);
double hk_mesh_volume(const hk_mesh *, size_t tetrahedron); /* m^3 */
/* Adds the boundary faces, those of one tetrahedron only, as triangles with outward normals. On failure tetrahedra[0]
 * and [1] are those at the wrong face. */
const char *hk_mesh_add_skin(hk_mesh *, size_t tetrahedra[2]);
/* Removes vertices that belong to no tetrahedron. */
const char *hk_mesh_drop_loose(hk_mesh *);

/* ---- body_shapes.c ---- */

/* Closed shapes about the origin; triangles are counter-clockwise seen from outside. Round shapes have their axis along
 * z and inscribed facets, which deviate from the true surface by at most detail x radius, inwards. Lengths in m. */
const char *hk_mesh_add_sphere(hk_mesh *, double radius, double detail);
const char *hk_mesh_add_capsule(hk_mesh *, double radius, double length,
                                double detail); /* length between the centers */
const char *hk_mesh_add_cylinder(hk_mesh *, double radius, double length, double detail);
const char *hk_mesh_add_box(hk_mesh *, const double size[3]);
const char *hk_mesh_add_square(hk_mesh *, double size); /* in the plane z = 0, seen from above */

#endif
