/* The obstacles of a run as solids to draw. */
#ifndef HK_OBSTACLE_SOLIDS_H
#define HK_OBSTACLE_SOLIDS_H

#include "plugins/common/obstacles/obstacle.h"
#include "plugins/common/frame_data/solid.h"

/* Fills one solid for each obstacle of the set, where it is at the end of the last step. Lists of meshes stay the
 * obstacles'. */
void hk_obstacle_solids(const hk_obstacle_set *, bool y_up, hk_frame_solid *solid);

#endif
