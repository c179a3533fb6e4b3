/* Obstacles that are too thin for a grid's cells: a wall is seen where a corner of a cell is in it, and between both
 * sides of one that is thinner than two cells there need not be a cell that is closed. */
#ifndef HK_THIN_SOLIDS_H
#define HK_THIN_SOLIDS_H

#include "plugins/common/mac_grid/liquid_grid.h"
#include "plugins/common/obstacles/obstacle.h"

/* m, between the sides of a wall of a shape where it is thinnest in the box, and the place in the scene; INFINITY: it
 * has one side, or none that is thinner than `most`. Of boxes, cylinders, balls and capsules it is the least extent,
 * but along the axis across a plane; of a mesh the shortest way inwards from one of its triangles to a side that is
 * within 30 degrees of parallel to it: wedges that are wider are edges, not walls. */
double hk_thickness(const hk_liquid_grid *, const hk_obstacle *, double most, double place[3]);
/* Warns of each obstacle that is thinner than two cells; what: that may leak through it, "gas". */
void hk_warn_of_thin(const hk_host *, const hk_liquid_grid *, const hk_obstacle_set *, const char *what);

#endif
