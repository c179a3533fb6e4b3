/* How much of its stiffness what melts has lost, by a channel, a temperature or an enthalpy (Terzopoulos, Platt,
 * Fleischer 1989, Heating and melting deformable models, section 4). */
#ifndef HK_SOFTENING_H
#define HK_SOFTENING_H

#include <math.h>

/* 0 up to `softens`, 1 from there on by `range` > 0, linear between. */
static inline double hk_softened(double channel, double softens, double range) {
  return fmin(1, fmax(0, (channel - softens) / range));
}

#endif
