/* Impacts of bodies: particles that constraints join (the service "bodies/1") receive the impulses of contact together
 * with the multipliers of their equations. An impulse p on the nearest points of an impact changes the velocities of
 * all particles of its bodies by U p, with the columns of U from hk_body_service.respond, so that the effective mass is
 * 1/(n.G n), G = P U, and the equations hold, to first order, at any time. The law of impact, complementarity and
 * Coulomb's cone, is that of impact.h and gauss_seidel.h with G in the place of the free particles' sum w^2/m, which
 * for them is the same: Gauss-Seidel sweeps over the impacts, each solved for its own impulse (Moreau 1988; Jean 1999),
 * to the solver's tolerance.
 *
 * One-sided equations (cables) are impacts without friction and restitution beside those of contact. Positions come
 * first, then the equations are satisfied exactly at the new place (hk_body_service.settle), then the velocities with
 * the responses of that place. Where an equation takes part that `settle` alone knows, sweeps and `settle` alternate
 * until the impacts hold. */
#ifndef HK_BODY_IMPACTS_H
#define HK_BODY_IMPACTS_H

#include "plugins/common/contact/bodies/body_system.h"

/* In `create`: the service. HK_FAILED: the host has none. */
hk_status hk_body_impacts_open(hk_body_impacts *, const hk_host *);
void hk_body_impacts_topology(hk_body_impacts *); /* in `topology` */
/* Before a step: `count`, which may have changed with the equations. Room for particles is made where there are bodies,
 * or where it is `needed` without. */
hk_status hk_body_impacts_begin(hk_body_impacts *, const hk_view *, bool needed);
/* As hk_gauss_seidel, for a move that ends at the time t, s. Errors are the constraints'. */
hk_status hk_body_gauss_seidel(hk_body_impacts *, hk_contact_solver *, hk_step_move *, hk_gauss_seidel_result *);

#endif
