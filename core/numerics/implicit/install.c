/* What of a system needs a Jacobian, as methods see it. */
#include "core/numerics/implicit/implicit.h"

static void blocks_changed(hk_dynamics *d, bool particles) {
  if (particles)
    hk_jacobian_topology(d);
  else if (d->matrix)
    d->matrix->stale = true;
}

void hk_implicit_install(hk_dynamics *d) {
  d->blocks_changed = blocks_changed;
  d->linear = (hk_linear_table){.jacobian = hk_jacobian_assemble,
                                .product = hk_implicit_product,
                                .combine = hk_implicit_combine,
                                .solver_flags = hk_implicit_solver_flags,
                                .factorize = hk_implicit_factorize,
                                .solve = hk_implicit_solve,
                                .solve_along = hk_implicit_solve_along,
                                .potential = hk_forces_potential,
                                .solve_columns = hk_implicit_solve_columns};
  d->system.linear = &d->linear;
}
