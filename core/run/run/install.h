/* What a run takes from core/numerics for its engine, where the scene needs it. The engine has each of these as a
 * pointer, or a table, that is NULL until then. */
#ifndef HK_INSTALL_H
#define HK_INSTALL_H

#include "core/engine/loop/loop.h"

/* The motions of pins with paths, up to `end`, s. */
hk_status hk_install_motions(hk_pins *, double end, hk_error *error);
/* What keeps constraints, and the matrices of implicit methods; of dynamics that are open. */
void hk_install_matrices(hk_dynamics *);
/* Opens what solves the linear systems of multipliers and of implicit steps, never in a step. `chosen`: the solver that
 * was asked for; NULL: one that suits. HK_BAD_PARAM: the method does not take the scene's constraints. */
hk_status hk_install_solvers(hk_dynamics *, const hk_instance *integrator, const hk_plugin_spec *chosen);
/* Lets the first pattern of a matrix decide on the solver; at the start state. */
hk_status hk_install_chosen_solver(hk_dynamics *);
/* The table of "solvers/1": linear systems of plugins that are no methods; `scene` as above. NULL: no memory. */
const void *hk_install_asked_solvers(hk_dynamics *, const hk_plugin_spec *scene);
/* The table of "bodies/1": particles that constraints join. NULL: no memory. */
const void *hk_install_bodies(hk_dynamics *);
/* Births and deaths, in a scene with sources. */
hk_status hk_install_sources(hk_loop *);
/* What has molten or broken at the start or in a checkpoint, before the first frame: it leaves surfaces, and equations.
 */
hk_status hk_install_losses(hk_loop *, bool resumed);
/* Frees all of it; the parts may be zero. */
void hk_install_close(hk_dynamics *, hk_loop *);

#endif
