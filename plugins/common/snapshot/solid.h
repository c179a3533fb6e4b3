/* Bodies in a scene that are not made of particles: what these move in or bounce off. */
#ifndef HK_SOLID_H
#define HK_SOLID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum hk_solid_kind {
  HK_SOLID_PLANE, /* through the centre; axis[2] is normal to it, the others are not used */
  HK_SOLID_SPHERE,
  HK_SOLID_BOX,
  HK_SOLID_CYLINDER, /* along axis[2] */
  HK_SOLID_CAPSULE,  /* along axis[2], which reaches to the end of the cap; round about it */
  HK_SOLID_MESH      /* the vertices' coordinates are in units of the axes */
} hk_solid_kind;

typedef struct hk_solid {
  hk_solid_kind kind;
  bool hollow; /* only what is seen of its inside is drawn */
  double centre[3];
  double axis[3][3]; /* from the centre to the surface along its own axes */
  /* Of a mesh; the lists are another's. */
  size_t vertices, faces;
  const double *vertex;      /* vertices x 3 */
  const uint32_t (*face)[3]; /* anticlockwise, seen from outside */
} hk_solid;

/* Enlarges the box by the solid, but for planes. */
void hk_solid_box(const hk_solid *, double low[3], double high[3]);

#endif
