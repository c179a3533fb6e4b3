/* "spins/1": which force has the energy of rotation of a particle. Several may turn the same particles, grains among
 * each other and on walls, and 1/2 I w^2 belongs into the balance of energy once. */
#ifndef HK_SPINS_H
#define HK_SPINS_H

#include "core/plugin.h"

#define HK_SPINS_INTERFACE "spins/1"

typedef struct hk_spins {
  void *self;
  double (*join)(void *self); /* in `create`: the number of a force, 1, 2, ... */
  /* In `topology`: the force with that number has the energy of those that it acts on and that no other has. */
  void (*claim)(void *self, const hk_view *view, double number);
  const double *(*owner)(const void *self); /* n: the number of the force that has it; 0: none */
} hk_spins;

#endif
