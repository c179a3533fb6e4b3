/* The spectrum of a scene in which no two particles are coupled: see uncoupled.c. */
#ifndef HK_UNCOUPLED_H
#define HK_UNCOUPLED_H

#include "core/numerics/stability/stability.h"

/* False: there are forces between particles, or what else keeps it from being found in this way, or the blocks that
 * forces give are not those of their F; *spectrum does then not change. */
bool hk_uncoupled_spectrum(hk_system *, hk_spectrum *);

#endif
