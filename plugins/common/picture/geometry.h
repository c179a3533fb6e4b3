/* Conversion of a snapshot to the primitives that OpenGL draws. */
#ifndef HK_GEOMETRY_H
#define HK_GEOMETRY_H

#include "plugins/common/picture/painter.h"

/* Fills vertex (with smooth normals), triangle, tube and point; solids become triangles. Objects with a particle
 * without a finite position, or beyond fifty times the size of the setup, are omitted. */
hk_status hk_geometry_fill(hk_painter *, const hk_view_setup *setup, const hk_snapshot3d *snapshot,
                           uint8_t (*colour)[4]);

#endif
