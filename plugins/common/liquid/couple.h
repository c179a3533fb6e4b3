/* The liquid and the bodies in it move each other: what stands beside the bodies in the pressure's equation, and what
 * its solution does to them. A step: hk_liquid_walls, ..., hk_liquid_couple, the pressure, hk_liquid_react. */
#ifndef HK_COUPLE_H
#define HK_COUPLE_H

#include "plugins/common/liquid/liquid.h"

/* The walls of free bodies for the pressure, whose rows are known. HK_NO_MEMORY, with a message. */
hk_status hk_liquid_couple(hk_liquid *);
/* Bodies and their faces get the velocities that the pressure gives them. */
void hk_liquid_react(hk_liquid *);

#endif
