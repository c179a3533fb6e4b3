/* The constraints of a scene, as the engine and methods see them. */
#include "core/numerics/constraints/constraints.h"

#include <stdlib.h>

static bool may_strike(const hk_dynamics *d) { return d->constraints->one_sided_count > 0; }

static const hk_constraint_calls calls = {.update = hk_constraints_update,
                                          .accelerate = hk_constraints_accelerate,
                                          .impact = hk_constraints_impact,
                                          .project = hk_constraints_project,
                                          .jumped = hk_constraints_jumped,
                                          .may_strike = may_strike,
                                          .forget = hk_constraints_forget,
                                          .topology = hk_constraints_topology};

hk_status hk_constraints_open(hk_dynamics *d) {
  if (d->plugins->kind[HK_CONSTRAINT].count == 0) return HK_OK;
  d->constraints = calloc(1, sizeof *d->constraints);
  if (!d->constraints) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the constraints");
  d->constrain = &calls;
  d->constraints->table = (hk_constraint_table){.takes_constraints = true,
                                                .project = hk_constraints_project_equalities,
                                                .shake = hk_constraints_shake,
                                                .rattle = hk_constraints_rattle,
                                                .shake_from = hk_constraints_shake_from};
  d->system.constraint = &d->constraints->table;
  /* The constraints have a solver instance of their own: the scene's solver keeps the factors of an implicit method
   * between evaluations. */
  hk_linear_system *linear = &d->constraints->linear;
  hk_status status = hk_solver_twins(d, linear);
  return status == HK_OK ? hk_constraint_matrix_build(d) : status;
}

void hk_constraints_install(hk_dynamics *d) { d->queries.project_velocity = hk_constraints_project_velocity; }

void hk_constraints_close(hk_dynamics *d) {
  if (!d->constraints) return;
  hk_constraint_matrix_free(d->constraints);
  hk_instance_destroy(d->constraints->linear.any);
  hk_instance_destroy(d->constraints->linear.special);
  hk_instance_destroy(d->constraints->mixed.any);
  hk_spec_destroy(d->constraints->unsymmetric);
  free(d->constraints);
  d->constraints = NULL;
  d->constrain = NULL;
  d->system.constraint = NULL;
}
