/* Strains of a liquid on its grid as sums of the velocities of faces, and the parts of volumes that they stand for
 * (Batty and Bridson 2008). */
#ifndef HK_VISCOUS_STRAIN_H
#define HK_VISCOUS_STRAIN_H

#include "plugins/common/liquid/liquid.h"

/* A strain: a sum of velocities of faces, and what walls add to it, 1/s; `weight` is its part of a cell's volume, and
 * twice that where it is along an axis; without a weight no face counts. */
typedef struct hk_strain {
  int count;
  int axis[4];
  size_t at[4];
  double by[4]; /* 1/m */
  double walls; /* 1/s */
  double weight;
  int covered; /* those of the faces that count for `walls` which bodies cover that the liquid moves */
  uint16_t body[4];
  int covered_axis[4];
  double covered_at[4][3]; /* m, where the wall is */
  double covered_by[4];    /* 1/m */
} hk_strain;

/* Whether the velocity of face i of component a is that of the wall: it is closed, or, where walls hold the liquid
 * back, its centre is in a solid. */
bool hk_viscous_face_held(const hk_liquid *, size_t i, int a, bool slip);
/* That along axis a in cell i; that between the axes a and b at the edge that is the cell's lowest corner of both. */
void hk_strain_along(const hk_liquid *, size_t i, int a, bool slip, hk_strain *);
void hk_strain_between(const hk_liquid *, size_t i, int a, int b, bool slip, hk_strain *);
/* The part of the volume about a face that is liquid, 0 to 1. */
double hk_liquid_part_of_face(const hk_liquid *, size_t i, int a);

#endif
