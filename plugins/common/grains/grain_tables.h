/* What forces of grains have in common, soft_spheres and soft_walls: rows of their tables of parameters and of fields.
 * `type` has members spheres (hk_spheres), law (hk_grain_law), restitution, tangential, history (hk_grain_history),
 * torque and spin_then (n x 3). */
#ifndef HK_GRAIN_TABLES_H
#define HK_GRAIN_TABLES_H

#include "plugins/common/grains/grain_history.h"
#include "plugins/common/grains/grain_law.h"
#include "plugins/common/grains/spheres.h"

/* clang-format off */
#define HK_GRAIN_PARAMS(type)                                                                                          \
  {"radius", "m", "of every sphere; left out: radii", .number = HK_AT(type, spheres.radius),                           \
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},                                                                     \
  {"radii", "", "name of the channel that has the radii, m", .string = HK_AT(type, spheres.radii)},                    \
  {"spin", "", "name of the channel of angular velocities, rad/s; left out: spheres do not turn",                      \
     .string = HK_AT(type, spheres.spin)},                                                                             \
  {"stiffness", "N/m", "k of the normal spring", .number = HK_AT(type, law.stiffness), .limits = HK_ABOVE(0),          \
     .flags = HK_REQUIRED},                                                                                            \
  {"restitution", "", "speed after a head-on collision, as a part of that before",                                     \
     .number = HK_AT(type, restitution), .initial = {0.8}, .limits = HK_ABOVE_TO(0, 1)},                               \
  {"friction", "", "coefficient of friction", .number = HK_AT(type, law.friction), .initial = {0.5},                   \
     .limits = HK_AT_LEAST(0)},                                                                                        \
  {"tangential", "", "stiffness of the tangential spring, as a part of the normal one",                                \
     .number = HK_AT(type, tangential), .initial = {2. / 7}, .limits = HK_WITHIN(0, 1)}

#define HK_GRAIN_FIELDS(type)                                                                                          \
  {"touches", .array = HK_AT(type, history.touches), .width = sizeof(hk_grain_touch)},                                 \
  {"next_touches", .array = HK_AT(type, history.next), .width = sizeof(hk_grain_touch), .flags = HK_SCRATCH},          \
  {"count", .integer = HK_AT(type, history.count)},                                                                    \
  {"time", .number = HK_AT(type, history.t)},                                                                          \
  {"torque", .per_particle = HK_AT(type, torque), .width = 3, .flags = HK_SCRATCH},                                    \
  {"spin_then", .per_particle = HK_AT(type, spin_then), .width = 3}
/* clang-format on */

#endif
