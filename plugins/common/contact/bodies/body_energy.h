/* Impacts that would give energy to what bounces and rubs. */
#ifndef HK_BODY_ENERGY_H
#define HK_BODY_ENERGY_H

#include "plugins/common/contact/bodies/body_system.h"

/* Whether the velocities after impacts, v, have more kinetic energy than those `before`, where restitution is at
 * work and nothing may add to it. */
bool hk_body_energy_grew(const hk_body_impacts *, const hk_contact_solver *, const hk_step_move *);
/* Takes the speeds back to those before, with targets without restitution. */
void hk_body_energy_restart(hk_body_impacts *, hk_contact_solver *, hk_step_move *);
/* After that solution: the mixture of both that has the kinetic energy from before. */
void hk_body_energy_blend(hk_body_impacts *, hk_step_move *);

#endif
