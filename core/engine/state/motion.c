/* The motion of the particles of a pin: what started at p is at x = c + o + d with d = R (p - c), and
 *
 *     x' = o' + w x d,     x'' = o'' + w' x d + w x (w x d). */
#include "core/engine/state/state.h"

#include <string.h>

/* to += a x b */
static void add_cross(double to[3], const double a[3], const double b[3]) {
  to[0] += a[1] * b[2] - a[2] * b[1];
  to[1] += a[2] * b[0] - a[0] * b[2];
  to[2] += a[0] * b[1] - a[1] * b[0];
}

/* d = R (origin - center) */
static void arm_of(const hk_pin_motion *m, const double origin[3], double d[3]) {
  double p[3];
  for (int c = 0; c < 3; c++) p[c] = origin[c] - m->center[c];
  for (int c = 0; c < 3; c++) d[c] = m->turn[3 * c] * p[0] + m->turn[3 * c + 1] * p[1] + m->turn[3 * c + 2] * p[2];
}

void hk_pin_motion_place(const hk_pin_motion *m, const double origin[3], double x[3], double v[3]) {
  double d[3];
  for (int c = 0; c < 3; c++) x[c] = origin[c] + m->offset[c];
  memcpy(v, m->velocity, sizeof m->velocity);
  if (!m->turns) return;
  arm_of(m, origin, d);
  for (int c = 0; c < 3; c++) x[c] = m->center[c] + m->offset[c] + d[c];
  add_cross(v, m->spin, d);
}

void hk_pin_motion_acceleration(const hk_pin_motion *m, const double origin[3], double a[3]) {
  double d[3], around[3] = {0, 0, 0};
  memcpy(a, m->push, sizeof m->push);
  if (!m->turns) return;
  arm_of(m, origin, d);
  add_cross(around, m->spin, d);
  add_cross(a, m->twist, d);
  add_cross(a, m->spin, around);
}
