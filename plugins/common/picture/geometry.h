/* From a shot to what OpenGL draws. */
#ifndef HK_GEOMETRY_H
#define HK_GEOMETRY_H

#include "plugins/common/picture/painter.h"

/* Fills vertex (with smooth normals), triangle, tube and bead. What touches a particle without a place, or one beyond
 * fifty times the size of the stage, is left out. */
hk_status hk_geometry_fill(hk_painter *, const hk_view_setup *stage, const hk_snapshot3d *shot, uint8_t (*colour)[4]);

#endif
