/* A camera that goes along with the particles: at each frame it looks at the middle of their box from one direction, at
 * the distance from which this is as large as hk_fit_begin has it. Both are means over the frames around, weighted as a
 * triangle, so that the picture does not shake; what goes at a constant speed stays in the middle. */
#ifndef HK_FOLLOW_H
#define HK_FOLLOW_H

#include "plugins/common/camera/framing.h"

/* Finds the way of the viewport's camera, a place for each frame of the spool, in a setup that hk_framing_motion has
 * made. A camera that is given keeps its way from what it looks at. HK_NO_MEMORY. */
hk_status hk_follow(const hk_viewport *, const hk_frame_spool *, const double origin[3], double fps,
                    const hk_view_setup *, hk_camera_place *way);

#endif
