/* What forces of grains have in common, soft_spheres and soft_walls: rows of their tables of parameters and of fields.
 * `type` has members spheres (hk_spheres), law (hk_contact_law), restitution, tangential, history (hk_contact_history),
 * torque and spin_then (n x 3). */
#ifndef HK_GRAIN_TABLES_H
#define HK_GRAIN_TABLES_H

#include "plugins/common/contact/contact_history.h"
#include "plugins/common/contact/contact_law.h"
#include "plugins/common/contact/spheres.h"

/* clang-format off */
#define HK_GRAIN_PARAMS(type)                                                                      \
  {"radius", "m", "of every sphere; left out: radii",                                              \
   HK_NUMBER, {0}, 0, INFINITY, offsetof(type, spheres.radius), HK_OPTIONAL | HK_ABOVE_MIN, NULL}, \
  {"radii", "", "name of the channel that has the radii, m",                                       \
   HK_STRING, {0}, 0, 0, offsetof(type, spheres.radii), 0, NULL},                                  \
  {"spin", "", "name of the channel of angular velocities, rad/s; left out: spheres do not turn",  \
   HK_STRING, {0}, 0, 0, offsetof(type, spheres.spin), 0, NULL},                                   \
  {"stiffness", "N/m", "k of the normal spring",                                                   \
   HK_NUMBER, {0}, 0, INFINITY, offsetof(type, law.stiffness), HK_REQUIRED | HK_ABOVE_MIN, NULL},  \
  {"restitution", "", "speed after a head-on collision, as a part of that before",                 \
   HK_NUMBER, {0.8}, 0, 1, offsetof(type, restitution), HK_ABOVE_MIN, NULL},                       \
  {"friction", "", "coefficient of friction",                                                      \
   HK_NUMBER, {0.5}, 0, INFINITY, offsetof(type, law.friction), 0, NULL},                          \
  {"tangential", "", "stiffness of the tangential spring, as a part of the normal one",            \
   HK_NUMBER, {2. / 7}, 0, 1, offsetof(type, tangential), 0, NULL}

#define HK_GRAIN_FIELDS(type)                                                                   \
  {"touches", HK_FIELD_ARRAY, sizeof(hk_touch), offsetof(type, history.touches), 0},            \
  {"next_touches", HK_FIELD_ARRAY, sizeof(hk_touch), offsetof(type, history.next), HK_SCRATCH}, \
  {"count", HK_FIELD_INTEGER, 1, offsetof(type, history.count), 0},                             \
  {"time", HK_FIELD_NUMBER, 1, offsetof(type, history.t), 0},                                   \
  {"torque", HK_FIELD_PER_PARTICLE, 3, offsetof(type, torque), HK_SCRATCH},                     \
  {"spin_then", HK_FIELD_PER_PARTICLE, 3, offsetof(type, spin_then), 0}
/* clang-format on */

#endif
