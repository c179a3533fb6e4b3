/* Smoothing of a closed mesh: each vertex moves towards the mean of its neighbours (Laplacian smoothing with equal
 * weights of edges), by a part of its own:
 *
 *   x_v <- x_v + w_v (sum over neighbours x_u / count - x_v), all at the same time.
 *
 * Loeschner, Boettcher, Jeske and Bender 2023 (Vision, Modeling, and Visualization, "Weighted Laplacian smoothing for
 * surface reconstruction of particle-based fluids") take w_v from the number of particles around, so that the bumps of
 * a liquid's face are smoothed while drops and thin threads stay. */
#ifndef HK_MESH_SMOOTHING_H
#define HK_MESH_SMOOTHING_H

#include "plugins/common/particle_surface/particle_options.h"

/* The part of each vertex, from 0 to 1: 3 t^2 - 2 t^3 with t = min(1, N/13), averaged from the particles around it
 * (particle_average.h); N = sum max(0, 1 - (d / 4 radius)^2) over the other particles, 12.5 in a full lattice.
 * Particles at x, n x 3, m; `weight` has a place for each vertex. HK_NO_MEMORY and as hk_particle_average. */
hk_status hk_smoothing_weights(const hk_host *, const double (*x)[3], size_t n, double radius, const hk_isosurface *,
                               double *weight);

/* Moves the vertices `rounds` times, and makes the normals, if there are any, those of the triangles around weighted by
 * their areas. The same bits for any number of threads. HK_NO_MEMORY, with the mesh as it was. */
hk_status hk_mesh_smooth(hk_isosurface *, const hk_host *, const double *weight, unsigned rounds);

#endif
