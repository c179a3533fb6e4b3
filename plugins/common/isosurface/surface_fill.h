/* Tetrahedra that fill an implicit surface, by isosurface stuffing (Labelle and Shewchuk 2007, ACM Trans. Graphics 26,
 * article 57) on a lattice of body-centred cubes: the corners and the centres of the grid's cells, with the tetrahedra
 * between two neighbouring centres and a side of the square between them. These are the Kuhn subdivision's, drawn
 * together along its diagonal so far that all are alike and as round as can be: dihedral angles of 60 and 90 degrees
 * where Kuhn's are of 45. Points of the lattice next to the surface are moved onto it; what is left of the others'
 * tetrahedra is cut off at the surface. In cubes the paper has all dihedral angles between 10.7 and 164.8 degrees, for
 * any field. All vertices of the skin lie where f = level to the steps that are asked for. */
#ifndef HK_SURFACE_FILL_H
#define HK_SURFACE_FILL_H

#include "plugins/common/isosurface/surface_parts.h"

/* Replaces the filling. Of the options level, steps and most_bytes count, and the field is evaluated at all corners and
 * centres of cells. A call that fails changes nothing: HK_BAD_PARAM (nothing is inside; a surface that leaves the box,
 * or comes nearer to its faces than half a cell), HK_NOT_FINITE, HK_NO_MEMORY. The field is a function. */
hk_status hk_surface_fill(hk_filling *, const hk_host *, const hk_isosurface_grid *, const hk_isosurface_field *,
                          const hk_isosurface_options *);
void hk_filling_free(hk_filling *, const hk_host *);

#endif
