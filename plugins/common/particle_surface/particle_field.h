/* The field of particles (particle_surface.h) on the blocks of a grid: each has a list of the particles that reach it,
 * in their order, so that a point has the same sum in every block that holds it. Block b of an axis has the points 8 b
 * - 1 to 8 b + 7 of the grid, as in common/isosurface/grid_blocks.h. */
#ifndef HK_PARTICLE_FIELD_H
#define HK_PARTICLE_FIELD_H

#include "plugins/common/particle_surface/particle_options.h"

typedef struct hk_particle_kernel { /* its value at d from its centre: amplitude P(sqrt(d^T form d)), P(q) = 0 for q >=
                                       2 */
  double form[6];                   /* 1/m^2: xx, yy, zz, yz, xz, xy */
  double amplitude, reach;          /* reach: m, of the ball that holds it */
} hk_particle_kernel;

typedef struct hk_particle_field {
  const hk_host *host;
  const double (*x)[3]; /* n x 3, m: of particles, or of the centres of kernels */
  size_t n;
  const hk_particle_kernel *kernel; /* n; NULL: all are balls of the options' reach */
  hk_particle_surface_options o;    /* what is left out is filled in by hk_particle_field_open */
  hk_isosurface_grid grid;
  size_t blocks[3];
  size_t *start;  /* blocks + 1 */
  uint32_t *list; /* start[blocks]: of block b those from start[b] to start[b + 1] - 1, rising */
} hk_particle_field;

/* Checks the options, chooses the grid and makes the lists. To be closed also after a failure. */
hk_status hk_particle_field_open(hk_particle_field *);
void hk_particle_field_close(hk_particle_field *);
size_t hk_particle_field_block(const hk_particle_field *, const double x[3]); /* the first that holds a place */
/* Functions of an hk_isosurface_field (particle_sums.c). */
void hk_particle_field_lattice(const void *, const double x[9], const double y[9], const double z[9],
                               double value[729]);
void hk_particle_field_evaluate(const void *, const double (*x)[3], size_t count, double *value);

#endif
