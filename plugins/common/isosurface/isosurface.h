/* Implicit surfaces as triangles: the surface where a field f(x, y, z) falls through a level, on a regular grid, by
 * marching tetrahedra (Doi and Koide 1991) on the Kuhn subdivision, six tetrahedra a cube along its main diagonal, or
 * by marching cubes (Lorensen and Cline 1987). A point with f >= level is inside, so a value that equals the level is
 * no special case. There is one vertex on each edge of the grid that the surface crosses, shared by all triangles
 * there; every edge of a triangle belongs to exactly two triangles, and around every vertex they form one ring: the
 * surface is closed and manifold for any values. Triangles are counterclockwise as seen from outside, where f is below
 * the level.
 *
 * The grid is worked on in blocks of 8 x 8 x 8 cells, and only blocks that the surface crosses take memory beyond four
 * bytes a block, and a bit for each value of an array. Numbers of vertices and triangles follow from the grid alone:
 * the result has the same bits for any number of threads. */
#ifndef HK_ISOSURFACE_H
#define HK_ISOSURFACE_H

#include "plugins/common/isosurface/surface_parts.h"

/* Replaces the surface. A call that fails changes nothing: HK_BAD_PARAM (the grid, an option; no surface in the box,
 * with the range of the values; one that leaves the box), HK_NOT_FINITE (a value of the field; where), HK_FAILED (a
 * field that contradicts its bounds or itself), HK_NO_MEMORY. */
hk_status hk_isosurface_find(hk_isosurface *, const hk_host *, const hk_isosurface_grid *, const hk_isosurface_field *,
                             const hk_isosurface_options *);
void hk_isosurface_free(hk_isosurface *, const hk_host *);

#endif
