/* The surface of particles that stand for a liquid or a heap, as closed triangles (common/isosurface). With distances d
 * between a place x and particles x_i within `reach` of it, it lies where a field is 0, positive inside:
 *   Zhu and Bridson 2005 (ACM Trans. Graphics 24, equations 2 to 4): radius - |x - sum w x_i / sum w|, with
 *     w = (1 - d^2/reach^2)^3. One particle by itself is a ball of its radius, and a flat layer is flat;
 *   the density: sum V W - threshold, with V = (2 radius)^3, the volume of a particle of a cubic lattice, and W the
 * cubic spline (Monaghan 1992, Annu. Rev. Astron. Astrophys. 30, section 2.1) of that reach, whose sum in a full
 * lattice is 1. What has too few neighbours to reach the threshold is not seen: one particle by itself has 0.32 at
 * most;
 *   anisotropic kernels (Yu and Turk 2013, particle_kernels.h): the same sum with kernels that are flat along the
 * surface, about centres drawn towards their neighbours, which takes the bumps of single particles away. In a block
 * of 19 x 19 x 8 particles that are up to a quarter of their spacing off a lattice, a face is flat to 0.066 spacings
 * (rms; Zhu and Bridson 0.107, the density 0.139), it is 0.1 spacings within the lattice's (0.1, 0.15), and the volume
 * of the block is 4 % too small (4, 7). 64,000 particles take 7.0 s
 * on one thread (0.9, 0.95), and 13 where walls cut them (3.2, 4.1). The grid has its points at multiples of `cell`,
 * whatever the particles do, so that the surfaces of a sequence do not flicker. The bits do not depend on the number of
 * threads. */
#ifndef HK_PARTICLE_SURFACE_H
#define HK_PARTICLE_SURFACE_H

#include "plugins/common/particle_surface/particle_options.h"

/* Replaces the surface; particles at x, n x 3, m. A call that fails changes nothing: HK_BAD_PARAM (no radius; no
 * particles; too many cells; nothing that reaches the threshold, but where that is allowed), HK_NOT_FINITE (the place
 * of a particle), HK_NO_MEMORY. */
hk_status hk_particle_surface_find(hk_isosurface *, const hk_host *, const double (*x)[3], size_t n,
                                   const hk_particle_surface_options *);

#endif
