#ifndef HK_BODY_SHAPES_H
#define HK_BODY_SHAPES_H

#include "core/builders/triangle_mesh.h"

/* Shapes about the origin, triangles with their outer side against the clock. Round ones have their axis along z and
 * are inscribed: no point of a facet is further than detail x radius inside of the true surface, and none outside.
 * NULL, or what is wrong. */
const char *hk_mesh_add_sphere(hk_mesh *, double radius, double detail);
const char *hk_mesh_add_capsule(hk_mesh *, double radius, double length,
                                double detail); /* length between the centers */
const char *hk_mesh_add_cylinder(hk_mesh *, double radius, double length, double detail);
const char *hk_mesh_add_box(hk_mesh *, const double size[3]);
const char *hk_mesh_add_square(hk_mesh *, double size); /* in the plane z = 0, seen from above */

#endif
