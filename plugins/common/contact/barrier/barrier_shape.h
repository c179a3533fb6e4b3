/* What a barrier needs to know of the particles of surfaces: the area that each stands for, and the length of the edges
 * at it. */
#ifndef HK_BARRIER_SHAPE_H
#define HK_BARRIER_SHAPE_H

#include "plugins/common/contact/barrier/barrier_pair.h"

typedef struct hk_barrier_shape {
  double area;   /* m^2; 0: not known yet */
  double square; /* m^2, mean squared length of its edges */
} hk_barrier_shape;

/* Fills the shapes of the particles whose area is 0, from the positions x: a third of the triangles at a particle; of
 * strands half the length of their edges times 2 radius + distance; of an isolated particle the circle of that
 * diameter. */
void hk_barrier_shapes(const hk_surface_mesh *, const double *x, size_t n, double distance, hk_barrier_shape *shape);
/* Sets area and limit of a pair: the smaller area of the two features, and, of edges that have a length, 1e-3 of the
 * product of their squared lengths (Li and others 2020, section 5). `smooth`: whether the pair has a mollifier. */
void hk_barrier_measure(hk_barrier_pair *, const hk_barrier_shape *shape);

#endif
