/* The spectrum of a scene in which every particle stands alone: see lone_particles.c. */
#ifndef HK_LONE_PARTICLES_H
#define HK_LONE_PARTICLES_H

#include "core/stability/stability.h"

/* False: there are forces between particles, or what else keeps it from being found in this way, or the blocks that
 * forces give are not those of their F; *spectrum does then not change. */
bool hk_lone_spectrum(hk_system *, hk_spectrum *);

#endif
