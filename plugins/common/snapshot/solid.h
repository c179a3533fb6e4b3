/* Bodies in a scene that are not made of particles: what these move in or bounce off. */
#ifndef HK_SOLID_H
#define HK_SOLID_H

typedef enum hk_solid_kind {
  HK_SOLID_PLANE, /* through the centre; axis[2] is normal to it, the others are not used */
  HK_SOLID_SPHERE,
  HK_SOLID_BOX,
  HK_SOLID_CYLINDER /* along axis[2] */
} hk_solid_kind;

typedef struct hk_solid {
  hk_solid_kind kind;
  double centre[3];
  double axis[3][3]; /* from the centre to the surface along its own axes */
} hk_solid;

#endif
