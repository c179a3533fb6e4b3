/* How a surface of particles is asked for (particle_surface.h). */
#ifndef HK_PARTICLE_OPTIONS_H
#define HK_PARTICLE_OPTIONS_H

#include "plugins/common/isosurface/surface_parts.h"

typedef enum hk_particle_field_kind { HK_ZHU_BRIDSON, HK_PARTICLE_DENSITY, HK_ANISOTROPIC } hk_particle_field_kind;

typedef struct hk_particle_walls { /* what a liquid is outside of */
  /* m, from the nearest wall, below 0 within it; n: its gradient, of length 1, or 0 where there is none. Called from
   * several threads at the same time. */
  double (*distance)(const void *self, const double x[3], double n[3]);
  const void *self;
} hk_particle_walls;

typedef struct hk_particle_surface_options { /* zeroed ones but for the radius are valid */
  hk_particle_field_kind kind;
  double radius;    /* m: half the distance of neighbours in a full liquid */
  double reach;     /* m, from radius; 0: 4 radius, of anisotropic kernels 6 radius */
  double cell;      /* m; 0: radius / 2 */
  double threshold; /* of the density, below 1; 0: 0.6, of anisotropic kernels 0.25 */
  /* Of anisotropic kernels: */
  double position_smoothing; /* lambda, up to 1: the part of the way to the neighbours' mean; 0: 0.9; below 0: none */
  double stretch;            /* k_r, 1 to 100: the largest ratio of a kernel's axes; 0: 4 */
  double lone;               /* k_n, 0.1 to 1: the size of a kernel with few neighbours, parts of reach; 0: 0.5 */
  unsigned few;              /* N_eps: a particle with no more neighbours within reach is a lone one; 0: 25 */
  unsigned smoothing;        /* rounds of smoothing of the mesh (mesh_smoothing.h), at most 1000 */
  const hk_particle_walls *walls; /* cut the surface (wall_cut.h); NULL: there are none */
  hk_isosurface_method method;
  bool without_normals;
  bool may_be_empty; /* nothing that reaches the threshold is a surface without vertices, and no error */
  size_t most_bytes; /* an error before more than this is allocated; 0: no limit */
} hk_particle_surface_options;

/* Fills in what is left out. HK_BAD_PARAM: a number out of its range. */
hk_status hk_particle_options_complete(hk_particle_surface_options *, const hk_host *);

#endif
