/* Cells that a wall cuts, by the distances at their corners: how much of the kernels about centres it leaves open. */
#ifndef HK_CUT_CELLS_H
#define HK_CUT_CELLS_H

#include "plugins/common/mac_grid/liquid_grid.h"

/* m, of the cell to the nearest solid, the mean of its corners. */
double hk_cut_cell_distance(const hk_liquid_grid *, size_t i);
/* A wall leaves the near side of a cell open, and not a part of all of it: as if it did, a kernel beside it seemed to
 * have up to 6 % less room, and what is in it to be denser. This adds to the room of the 27 cells about cell i of the
 * row what is open of each of its parts beyond `mean`, the part of the whole that has been counted. So room is that of
 * a wall, and of a corner of walls, to half a percent. centre: m, the distance of the cell's centre to the nearest
 * solid; by how much it is more than the corners say, the wall is curved, alike along all axes: without, a sphere of
 * ten cells had 2 % less room. */
void hk_cut_cell_add(hk_liquid_grid *, const hk_liquid_row *, size_t i, double mean, double centre);

#endif
