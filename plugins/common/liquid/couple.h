/* The liquid and the bodies in it move each other: what stands beside the bodies in the pressure's equation, and what
 * its solution does to them. A step: hk_liquid_walls, ..., hk_liquid_couple, _couple_thin, the pressure,
 * hk_liquid_react, _move_thin. */
#ifndef HK_COUPLE_H
#define HK_COUPLE_H

#include "plugins/common/liquid/liquid.h"

/* The walls of free bodies for the pressure, whose rows are known; bodies get what acts on these beyond the centres of
 * cells, known from the pressure of the last step (size, m^2/s). HK_NO_MEMORY, with a message. */
hk_status hk_liquid_couple(hk_liquid *, const double *last);
/* Bodies and their faces get the velocities that the pressure gives them. */
void hk_liquid_react(hk_liquid *);
/* The faces that wet bodies cover move as they do. */
void hk_liquid_move_bodies(hk_liquid *);

/* After hk_liquid_couple: the points of cloth as bodies of the pressure's matrix, behind those of hk_liquid_bodies, and
 * the sides of the faces that it crosses as their walls. The pressure that acts on cloth is that in the centre of the
 * cell and, beyond it, its slope times the distance, which is known from the pressure of the last step (size, m^2/s)
 * and given to the points before. HK_NO_MEMORY, with a message. */
hk_status hk_liquid_couple_thin(hk_liquid *, const double *last);
/* After hk_liquid_react: points get the velocities that the pressure has given them, and faces those of their points.
 */
void hk_liquid_move_thin(hk_liquid *);
/* The faces that cloth crosses move as its points do. */
void hk_liquid_move_thin_faces(hk_liquid *);

#endif
