/* Whether particles start in a heap: n of them nearer to each other than they are thick are n^2/2 pairs that are closed
 * from the beginning, of which no method of contact can make sense, and for some thousand of which there is no memory.
 */
#ifndef HK_SURFACE_CROWD_H
#define HK_SURFACE_CROWD_H

#include "plugins/common/surfaces/surfaces.h"

/* HK_BAD_PARAM, on behalf of the plugin whose view it is: more than a hundred particles are nearer to each other than
 * the least sum of two radii. HK_NO_MEMORY. */
hk_status hk_surface_crowd_check(const hk_surface_mesh *, const hk_view *);

#endif
