/* What a scene says of an obstacle, for the corrector and the force alike. */
#ifndef HK_OBSTACLE_PARAMS_H
#define HK_OBSTACLE_PARAMS_H

#include "plugins/common/contact/geometry/body_around.h"
#include "plugins/common/obstacles/obstacle.h"

typedef struct hk_obstacle_params {
  int shape; /* hk_shape_kind */
  bool hollow;
  double position[3], rotation[3], normal[3], size[3];
  double friction, radius;
  const char *radius_channel, *file;
  hk_numbers vertices, faces;
  size_t channel; /* position of the channel, or the number of channels */
} hk_obstacle_params;

/* Rows of a parameter table, for a plugin whose instance has the member `params` of this type: the shape and its pose
 * alone, and these with what a contact has beside. */
/* clang-format off */
#define HK_OBSTACLE_SHAPE_ROWS(instance)                                                                               \
  {"shape", "", "of the obstacle", .choice = HK_AT(instance, params.shape), .choices = HK_SHAPE_NAMES},                \
  {"position", "m", "of its centre; of a point of the plane", .vector = HK_AT(instance, params.position),              \
     .flags = HK_TIMED},                                                                                               \
  {"rotation", "rad", "axis times angle, about the position", .vector = HK_AT(instance, params.rotation),              \
     .flags = HK_TIMED},                                                                                               \
  {"normal", "", "of the plane, of any length, to the side of the particles",                                          \
     .vector = HK_AT(instance, params.normal), .initial = {0, 0, 1}},                                                  \
  {"size", "m",                                                                                                        \
     "extents along its own x, y, z: a sphere's diameter three times; of a cylinder and a capsule, whose "             \
     "axis is z, the diameter twice and the length", .vector = HK_AT(instance, params.size),                           \
     .initial = {1, 1, 1}, .limits = HK_WITHIN(0, 1e9)},                                                               \
  {"vertices", "m", "of a mesh: x1, y1, z1, x2, ...", .numbers = HK_AT(instance, params.vertices),                     \
     .flags = HK_OPTIONAL},                                                                                            \
  {"faces", "", "of a mesh: three vertices a triangle, from 1; closed, all outward or all inward",                     \
     .numbers = HK_AT(instance, params.faces), .flags = HK_OPTIONAL},                                                  \
  {"file", "", "where the mesh comes from, for messages", .string = HK_AT(instance, params.file),                      \
     .text = "the mesh"}
#define HK_OBSTACLE_PARAM_ROWS(instance)                                                                               \
  HK_OBSTACLE_SHAPE_ROWS(instance),                                                                                    \
  {"hollow", "", "keeps particles inside", .boolean = HK_AT(instance, params.hollow)},                                 \
  {"friction", "", "Coulomb's coefficient mu", .number = HK_AT(instance, params.friction),                             \
     .limits = HK_WITHIN(0, 1e9)},                                                                                     \
  {"radius", "m", "of the particles", .number = HK_AT(instance, params.radius), .limits = HK_WITHIN(0, 1e9)},          \
  {"radius_channel", "", "a channel with the radius of each particle, m, instead of `radius`",                         \
     .string = HK_AT(instance, params.radius_channel)}
/* clang-format on */

/* Checks them and fills the obstacle, but for its motion and its law; the surface is filled where it is a mesh.
 * HK_BAD_PARAM. */
hk_status hk_obstacle_open(hk_obstacle *, hk_surface *, hk_obstacle_params *, const hk_host *, const hk_view *);
/* The pose and the particles' radii of this moment. */
hk_pose hk_obstacle_pose(const hk_obstacle_params *, double t);
hk_body_frame hk_obstacle_frame(const hk_obstacle_params *, double t); /* at rest in that pose */
void hk_obstacle_take_radii(hk_obstacle *, const hk_obstacle_params *, const hk_view *);

/* How many particles are inside, and how deep; of those that are not held by pins. */
typedef struct hk_inside {
  size_t count, deepest; /* index */
  double depth;          /* m */
} hk_inside;

hk_inside hk_obstacle_inside(const hk_obstacle *, const hk_view *);

/* A point of a solid obstacle and the rigid body that it is inside of: where the whole obstacle is, none of the body's
 * points is inside the obstacle. Those of what is in a plane or a hollow obstacle are. */
typedef struct hk_enclosed_obstacle {
  double point[3]; /* m, its centre; a mesh's first vertex */
  hk_body_around body;
} hk_enclosed_obstacle;

/* HK_NO_MEMORY. */
hk_status hk_obstacle_enclosed(const hk_obstacle *, const hk_host *, const hk_view *, hk_enclosed_obstacle *out);

#endif
