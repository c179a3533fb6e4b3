/* What particles are subject to when all move alike, and the turning of their velocities: see common_motion.c. */
#ifndef HK_COMMON_MOTION_H
#define HK_COMMON_MOTION_H

#include "core/plugin.h"

/* column: the responses M^-1/2 D e of the three common motions e along the axes, 3n doubles each, as the pins allow
 * them. Returns the smallest eigenvalue of the symmetric parts of the particles' 3x3 blocks, at least 0. 1/s */
double hk_common_damping(const hk_model *, double *const column[3]);
/* Sets `turn` (n x 3, 1/s) to the axial vectors t of their skew parts, A u = t x u; returns the largest length.
 * NULL: that is all that is wanted. */
double hk_common_turning(const hk_model *, double *const column[3], double *turn);

/* Sets p and q (3n doubles each) to random vectors as pins allow them. */
void hk_turning_pair(hk_system *, double *p, double *q);
/* Whether `turn` is all of D's skew part, from the responses to such a pair. */
bool hk_turning_is_whole(size_t n, const double *turn, const double *p, const double *q, const double *Dp,
                         const double *Dq);

#endif
