/* Triangles of solids, anticlockwise where they are seen. */
#ifndef HK_SOLID_MESH_H
#define HK_SOLID_MESH_H

#include "plugins/common/picture/painter.h"

/* The most that a solid takes. */
size_t hk_solid_vertices(const hk_frame_solid *);
size_t hk_solid_triangles(const hk_frame_solid *);
/* red, green, blue, 255: of a plane, or of other solids, by day or night */
void hk_solid_colour(const hk_view_setup *, bool plane, uint8_t colour[4]);

/* Appends the solid to the painter's vertices and triangles, for which there is room. Nothing of a plane is added that
 * is the floor. HK_NO_MEMORY. */
hk_status hk_solid_mesh_add(hk_painter *, const hk_view_setup *setup, const hk_frame_solid *, const double origin[3]);
/* Appends a mesh without creases: `normal` of its vertices x 3, in its own axes, outwards; NULL: as faces.
 * HK_NO_MEMORY.
 */
hk_status hk_solid_add_liquid(hk_painter *, const hk_frame_solid *, const double *normal, const double origin[3]);
/* Appends faces with creases, for whose 3 corners each there is room among the vertices. HK_NO_MEMORY. */
hk_status hk_solid_add_faces(hk_painter *, const float (*x)[3], size_t vertices, const uint32_t (*face)[3],
                             size_t faces, const uint8_t colour[4]);

#endif
