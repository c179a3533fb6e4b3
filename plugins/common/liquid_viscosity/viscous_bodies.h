/* Rigid bodies in the equations of a liquid's viscosity. A body that the liquid moves covers faces, whose velocities
 * are v + w x r; with its kinetic energy m |v - v*|^2/2 + (w - w*).I (w - w*)/2 in the sum that is made least
 * (liquid_viscosity.h), what the strains beside it take from the liquid the body gets, and its drag is implicit. Batty
 * and Bridson 2008, section 5, couple bodies by the pressure so; here it is the viscosity. */
#ifndef HK_VISCOUS_BODIES_H
#define HK_VISCOUS_BODIES_H

#include "plugins/common/liquid_viscosity/viscous_strain.h"

/* 1/s, of the velocities that the faces have. */
double hk_strain_now(const hk_liquid_grid *, const hk_strain *);
/* What a unit of each of the six motions of the body adds by the covered face k: 1/m, and 1. */
void hk_strain_by_body(const hk_liquid *, const hk_strain *, int k, double by[6]);

typedef struct hk_viscous_bodies {
  size_t count;  /* that are wet and free: six rows each, behind those of the faces */
  size_t first;  /* the number of the first of these rows */
  size_t *row;   /* of all bodies of the liquid: the first of the six */
  double *among; /* 6 count x 6 count: the equations of their motion */
  double *b;     /* 6 count: what the strains ask for */
  size_t most;   /* bodies that there is memory for */
} hk_viscous_bodies;

/* In a step: _open counts the bodies, and with the number of faces known _begin enters their masses; every strain is
 * added once; _close_up puts the rows behind those of the faces, from start[first] on; with the solution _end changes
 * their motion, and that of the faces that they cover. HK_NO_MEMORY, with a message. */
hk_status hk_viscous_bodies_open(hk_viscous_bodies *, const hk_liquid *);
void hk_viscous_bodies_begin(hk_viscous_bodies *, const hk_liquid *, size_t faces);
/* Whether a body is near enough to the lowest corner of cell i to cover a face of its strains. */
bool hk_viscous_bodies_near(const hk_liquid *, size_t i);
void hk_viscous_bodies_add(const hk_liquid *, hk_viscous_bodies *, const hk_strain *, double factor);
void hk_viscous_bodies_close_up(const hk_viscous_bodies *, size_t *start, uint32_t *column, double *value, double *b);
void hk_viscous_bodies_end(const hk_viscous_bodies *, hk_liquid *, const double *x);
void hk_viscous_bodies_close(hk_viscous_bodies *, const hk_host *);

#endif
