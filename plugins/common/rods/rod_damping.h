/* The damping of bending and twist, by Kelvin and Voigt. */
#ifndef HK_ROD_DAMPING_H
#define HK_ROD_DAMPING_H

#include "plugins/common/rods/rod_joint.h"

/* Adds to the forces on the rows, which are those of an evaluation at `view`; returns the power, W. */
double hk_rod_damping_add(hk_rods *, const hk_view *view);
/* F += what the last call of it found on the particles that are angles. */
void hk_rod_damping_turn(const hk_rods *, double *F);
/* Makes the joint at a row one whose second derivatives, of squares alone, are those of the damping, J s. */
void hk_rod_damping_joint(const hk_rods *, size_t row, hk_rod_joint *);

#endif
