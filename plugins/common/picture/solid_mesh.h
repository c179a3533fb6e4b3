/* Triangles of solids. */
#ifndef HK_SOLID_MESH_H
#define HK_SOLID_MESH_H

#include "plugins/common/picture/painter.h"

/* The most that one solid takes. */
enum { HK_SOLID_VERTICES = 33 * 65, HK_SOLID_TRIANGLES = 2 * 32 * 64 };

/* Appends the solid to the painter's vertices and triangles, for which there is room. Nothing of a plane is added that
 * is the floor. */
void hk_solid_mesh_add(hk_painter *, const hk_view_setup *setup, const hk_solid *, const double origin[3]);
/* Enlarges the box by the solid, but for planes. */
void hk_solid_box(const hk_solid *, double low[3], double high[3]);

#endif
