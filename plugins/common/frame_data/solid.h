/* Bodies in a scene that are not made of particles: what these move in or bounce off. */
#ifndef HK_FRAME_SOLID_H
#define HK_FRAME_SOLID_H

#include "plugins/common/obstacles/shape.h"

/* A plane goes through the centre, axis[2] is normal to it, and the others are not used. A cylinder is along axis[2], a
 * capsule as well, which reaches to the end of the cap and is round about it. The coordinates of a mesh's vertices are
 * in units of the axes. */

enum { HK_SOLID_NUMBERS = 12 }; /* of a place: the centre and three axes */

/* The names of the kinds, as in HK_SHAPE_NAMES. */
extern const char *const hk_solid_names[HK_SHAPE_MESH + 1];

typedef struct hk_frame_solid {
  hk_shape_kind kind;
  bool hollow;       /* only what is seen of its inside is drawn */
  bool body;         /* the surface of a rigid body, which is of the motion; otherwise what that bounces off */
  uint8_t colour[4]; /* red, green, blue, 255; with a 0 at the end that of all bodies */
  uint32_t group;    /* of a rigid body: 1 + its place in the scene's group names; 0: it has none */
  double centre[3];
  double axis[3][3]; /* from the centre to the surface along its own axes */
  /* Of a mesh; the lists are another's. */
  size_t vertices, faces;
  const double *vertex;      /* vertices x 3 */
  const uint32_t (*face)[3]; /* anticlockwise, seen from outside */
} hk_frame_solid;

/* Enlarges the box by the solid, but for planes. */
void hk_solid_box(const hk_frame_solid *, double low[3], double high[3]);

typedef struct hk_solid_list {
  size_t count;
  const hk_frame_solid *solid;
} hk_solid_list;

/* m, of a place from the nearest of an hk_solid_list, below 0 within it (of a hollow one outside); n: the gradient, of
 * length 1. Meshes are left out; INFINITY and n = 0 where there is nothing else. */
double hk_solids_distance(const void *list, const double x[3], double n[3]);

#endif
