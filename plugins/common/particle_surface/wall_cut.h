/* The field of particles (particle_field.h) cut by walls, with s the distance from them, above 0 where the liquid may
 * be: the smaller of s and the field in units of a tenth of a radius. Where a liquid is at a wall its surface is then
 * the wall's own, without the bumps of single particles; a plane is met to rounding, as s is linear along an edge of
 * the grid.
 *
 * Within two radii of a wall the field is no less than at that distance straight off it, so that a liquid whose
 * outermost particles are at the wall, or a radius from it, reaches it. A liquid nearer than a particle's spacing to a
 * wall is drawn as touching it. */
#ifndef HK_WALL_CUT_H
#define HK_WALL_CUT_H

#include "plugins/common/particle_surface/particle_field.h"

/* Functions of an hk_isosurface_field, of a field with walls. */
void hk_walled_lattice(const void *, const double x[9], const double y[9], const double z[9], double value[729]);
void hk_walled_evaluate(const void *, const double (*x)[3], size_t count, double *value);
/* m, from the nearest wall; INFINITY: there is none. */
double hk_wall_distance(const hk_particle_walls *, const double x[3]);

#endif
