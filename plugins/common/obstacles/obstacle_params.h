/* What a scene says of an obstacle, for the corrector and the force alike. */
#ifndef HK_OBSTACLE_PARAMS_H
#define HK_OBSTACLE_PARAMS_H

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

/* Rows of a parameter table, for a plugin whose instance has the member `params` of this type. */
/* clang-format off */
#define HK_OBSTACLE_PARAM_ROWS(instance)                                                                               \
  {"shape", "", "of the obstacle", HK_CHOICE, {0}, 0, 0,                                                                \
   offsetof(instance, params.shape), 0, HK_SHAPE_NAMES},                                                                \
  {"position", "m", "of its centre; of a point of the plane",                                                           \
   HK_VECTOR, {0}, 0, 0, offsetof(instance, params.position), HK_TIMED, NULL},                                          \
  {"rotation", "rad", "axis times angle, about the position",                                                           \
   HK_VECTOR, {0}, 0, 0, offsetof(instance, params.rotation), HK_TIMED, NULL},                                          \
  {"normal", "", "of the plane, of any length, to the side of the particles",                                           \
   HK_VECTOR, {0, 0, 1}, 0, 0, offsetof(instance, params.normal), 0, NULL},                                             \
  {"size", "m", "extents along its own x, y, z: a sphere's diameter three times; of a cylinder and a capsule, whose "   \
   "axis is z, the diameter twice and the length", HK_VECTOR, {1, 1, 1}, 0, 1e9, offsetof(instance, params.size), 0,    \
   NULL},                                                                                                               \
  {"hollow", "", "keeps particles inside", HK_BOOLEAN, {0}, 0, 0, offsetof(instance, params.hollow), 0, NULL},          \
  {"friction", "", "Coulomb's coefficient mu", HK_NUMBER, {0}, 0, 1e9, offsetof(instance, params.friction), 0, NULL},   \
  {"radius", "m", "of the particles", HK_NUMBER, {0}, 0, 1e9, offsetof(instance, params.radius), 0, NULL},              \
  {"radius_channel", "", "a channel with the radius of each particle, m, instead of `radius`",                          \
   HK_STRING, {0}, 0, 0, offsetof(instance, params.radius_channel), 0, NULL},                                            \
  {"vertices", "m", "of a mesh: x1, y1, z1, x2, ...",                                                                   \
   HK_NUMBERS, {0}, 0, 0, offsetof(instance, params.vertices), HK_OPTIONAL, NULL},                                      \
  {"faces", "", "of a mesh: three vertices a triangle, from 1; closed, all outward or all inward",                       \
   HK_NUMBERS, {0}, 0, 0, offsetof(instance, params.faces), HK_OPTIONAL, NULL},                                         \
  {"file", "", "where the mesh comes from, for messages",                                                               \
   HK_STRING, {0}, 0, 0, offsetof(instance, params.file), 0, "the mesh"}
/* clang-format on */

/* Checks them and fills the obstacle, but for its motion and its law; the surface is filled where it is a mesh.
 * HK_BAD_PARAM. */
hk_status hk_obstacle_open(hk_obstacle *, hk_surface *, hk_obstacle_params *, const hk_host *, const hk_view *);
/* The pose and the particles' radii of this moment. */
hk_pose hk_obstacle_pose(const hk_obstacle_params *, double t);
void hk_obstacle_look(hk_obstacle *, const hk_obstacle_params *, const hk_view *);

/* How many particles are inside, and how deep; of those that are not held by pins. */
typedef struct hk_inside {
  size_t count, deepest; /* index */
  double depth;          /* m */
} hk_inside;

hk_inside hk_obstacle_inside(const hk_obstacle *, const hk_view *);

#endif
