/* Gaps between obstacles, and between them and the closed sides of a grid's box, that are too narrow for its cells. */
#ifndef HK_NARROW_GAPS_H
#define HK_NARROW_GAPS_H

#include "plugins/common/mac_grid/liquid_grid.h"
#include "plugins/common/obstacles/obstacle.h"

/* m, between two obstacles as they are at the end of the last step, by projections from one to the other in turn
 * (von Neumann; Cheney and Goldstein 1959, Proc. Am. Math. Soc. 10), which find the least distance of convex shapes and
 * one nearby of others; 0: they touch, or did not come to rest. middle: of the gap. */
double hk_gap_between(const hk_obstacle *, const hk_obstacle *, double middle[3]);
/* The same to the plane x_axis = at, m, from the side `inside` (1 or -1) of it. */
double hk_gap_to_side(const hk_obstacle *, int axis, double at, double inside, double middle[3]);
typedef struct hk_narrow_gap {
  double width, cell;   /* m; of the box's cells. width INFINITY: there is none below two cells */
  size_t first, second; /* obstacles; second: HK_OBSTACLES, a side */
  int axis;             /* of the side, and where it is, m */
  double at;
} hk_narrow_gap;

/* Warns once of the narrowest gap below two cells that is in the box, if there is one; `open`: sides without a wall;
 * what: that passes through gaps, "gas". Things that touch leave none. Returns it. */
hk_narrow_gap hk_warn_of_gaps(const hk_host *, const hk_liquid_grid *, const hk_obstacle_set *, const bool open[3][2],
                              const char *what);
/* Whether x is in the gap: outside both that it is between, and nearer than a cell to either. */
bool hk_gap_holds(const hk_narrow_gap *, const hk_obstacle_set *, const double x[3]);

#endif
