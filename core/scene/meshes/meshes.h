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

/* ---- inwards.c ---- */

/* Moves all faces of a closed mesh inwards by a distance, m, with the edges and corners between them. The sentence of
 * an error ends a line that begins with the name of the distance. */
const char *hk_mesh_move_inwards(hk_mesh *, double distance);

/* ---- implicit_shapes.c ---- */

/* A shape by a function of places that is not below 0 inside, made of parts:
 *   a function f, with its level: f - level, or level - f where the inside is below;
 *   blobs, that is metaballs: sum of weight w(r / (2 radius)) - 1/2 over their distances r, with
 *       w(s) = 1 - 22/9 s^2 + 17/9 s^4 - 4/9 s^6 for s < 1, else 0
 *     (Wyvill, McPheeters and Wyvill 1986, The Visual Computer 2, equation 1): w(1/2) = 1/2, so that a blob by itself
 * is a ball of its radius; the union, the largest value of the parts; the intersection, the smallest; the difference,
 * the first without the others. Where two values differ by less than `blend` the larger one is raised by (blend -
 * difference)^2 / (4 blend), in an intersection or difference the smaller one lowered: the edge between them is
 * rounded. */
typedef enum hk_implicit_kind {
  HK_IMPLICIT_FUNCTION,
  HK_IMPLICIT_BLOBS,
  HK_IMPLICIT_UNION,
  HK_IMPLICIT_INTERSECTION,
  HK_IMPLICIT_DIFFERENCE
} hk_implicit_kind;

typedef struct hk_blob {
  double centre[3], radius, weight; /* m, m; weight 1: a ball by itself; below 0: takes away */
} hk_blob;

typedef struct hk_implicit_shape {
  hk_implicit_kind kind;
  bool below;          /* of a function: inside where f <= level */
  double level, blend; /* in the unit of f */
  void (*evaluate)(void *context, int function, const double (*x)[3], size_t count, double *value);
  void *context;
  int function;
  size_t count; /* of blobs or parts */
  hk_blob *blob;
  struct hk_implicit_shape *part;
} hk_implicit_shape;

void hk_implicit_evaluate(const hk_implicit_shape *, const double (*x)[3], size_t count, double *value);
bool hk_implicit_has_function(const hk_implicit_shape *); /* of which no bounds are known */
/* Of a shape without functions, in the whole box from low to high. */
void hk_implicit_bounds(const hk_implicit_shape *, const double low[3], const double high[3], double range[2]);
/* A box outside of which the shape has no inside; false: there is none, as a function may be inside anywhere. */
bool hk_implicit_box(const hk_implicit_shape *, double low[3], double high[3]);

/* ---- boxed_shape.c ---- */

/* A shape closed along the faces of a box: what of it is in the box, by the smaller of its value and the distance from
 * the faces, m. The shape is asked for within the box only. */
typedef struct hk_boxed_shape {
  const hk_implicit_shape *shape;
  double low[3], high[3]; /* m */
} hk_boxed_shape;

void hk_boxed_shape_evaluate(const void *boxed, const double (*x)[3], size_t count, double *value);
/* Of one whose shape has no function. */
void hk_boxed_shape_bounds(const void *boxed, const double low[3], const double high[3], double range[2]);

#endif
