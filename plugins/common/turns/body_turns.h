/* The rigid rotation of bodies in a field of velocities or accelerations, as far as their pins allow it. A body is a
 * set of free particles that edges connect; pinned particles connect nothing. */
#ifndef HK_BODY_TURNS_H
#define HK_BODY_TURNS_H

#include "plugins/common/springs/element_edges.h"

#define HK_NO_BODY UINT32_MAX

typedef struct hk_turning_body {
  double mass, centre[3], drift[3], inertia[6], torque[3], turn[3]; /* inertia: xx, xy, xz, yy, yz, zz; turn: A */
  double radius2, far2; /* m^2, largest squared distance from the centre, of particles and of pins */
  uint32_t pin, far;    /* the first of its pinned particles and the one farthest from it; HK_NO_BODY: none */
  bool fixed;           /* its pins are not on one line */
} hk_turning_body;

typedef struct hk_body_turns {
  size_t n, bodies;
  hk_turning_body *body;
  uint32_t *label; /* n: the particle's body; HK_NO_BODY: pinned */
  size_t anchors;
  uint32_t (*anchor)[2]; /* a body and a pinned particle that an edge joins to it */
} hk_body_turns;

/* Allocates for n particles and at most that many edges: HK_NO_MEMORY without a message. */
hk_status hk_body_turns_reserve(hk_body_turns *, const hk_host *, size_t n, size_t edges);
/* Which particles are one body; not more edges than reserved. */
void hk_body_turns_arrange(hk_body_turns *, const hk_element_edges *);
/* Sets every body's turn, 1/s or 1/s^2: that of the field a (n x 3) of particles of these masses (kg) at x. */
void hk_body_turns_find(hk_body_turns *, const double *mass, const double *x, const double *a);
/* Finds it and takes it out of the field. */
void hk_body_turns_remove(hk_body_turns *, const double *mass, const double *x, double *a);

#endif
