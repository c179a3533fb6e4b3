/* Hands the engine what a scene needs of core/numerics: motions of pins, constraints, matrices with their solvers,
 * births and deaths. A scene without one of them leaves the engine's pointer NULL, and pays nothing. */
#include "core/engine/contract/contract.h"
#include "core/numerics/functions/functions.h"
#include "core/numerics/implicit/implicit.h"
#include "core/numerics/population/population.h"
#include "core/run/run/install.h"

hk_status hk_install_motions(hk_pins *pins, double end, hk_error *error) { return hk_motions_open(pins, end, error); }

void hk_install_matrices(hk_dynamics *d) {
  hk_constraints_install(d);
  hk_implicit_install(d);
}

static const hk_instance *find_one_sided(const hk_instances *constraints) {
  for (size_t k = 0; k < constraints->count; k++)
    if (constraints->item[k]->plugin->constraint->flags & HK_ONE_SIDED) return constraints->item[k];
  return NULL;
}

/* Between the line of the script and what is said of it; of what the command line adds there is none. */
static const char *before_text(const hk_instance *instance) { return *instance->where ? ": " : ""; }

static hk_status check_constraints(const hk_dynamics *d, const hk_plugin *method) {
  const hk_instances *constraints = &d->plugins->kind[HK_CONSTRAINT];
  const char *refused = hk_integrator_of(method)->constrained.refused;
  if (constraints->count > 0 && refused)
    return hk_error_set(d->error, HK_BAD_PARAM, "%s%s%s takes no constraints ('%s'): %s", constraints->item[0]->where,
                        before_text(constraints->item[0]), method->name, constraints->item[0]->label, refused);
  const hk_instance *one_sided = find_one_sided(constraints);
  if (one_sided && method->integrator->flags & HK_SPLITS_FORCES)
    return hk_error_set(
        d->error, HK_BAD_PARAM,
        "%s%s%s takes no one-sided constraints ('%s'): it splits the forces, and which constraints push is a "
        "matter of their sum; choose another implicit method",
        one_sided->where, before_text(one_sided), method->name, one_sided->label);
  return HK_OK;
}

hk_status hk_install_solvers(hk_dynamics *d, const hk_instance *integrator, const hk_plugin_spec *chosen) {
  bool constrained = d->plugins->kind[HK_CONSTRAINT].count > 0;
  bool implicit = integrator->plugin->integrator->flags & (HK_NEEDS_JACOBIAN | HK_NEEDS_SOLVER);
  hk_status status = check_constraints(d, integrator->plugin);
  if (status == HK_OK && (constrained || implicit)) status = hk_solver_open(d, chosen);
  if (status == HK_OK && constrained) status = hk_constraints_open(d);
  return status == HK_OK && constrained && implicit ? hk_saddle_point_open(d) : status;
}

hk_status hk_install_chosen_solver(hk_dynamics *d) { return hk_solver_choose(d); }

const void *hk_install_asked_solvers(hk_dynamics *d, const hk_plugin_spec *scene) { return hk_asked_solvers(d, scene); }

const void *hk_install_bodies(hk_dynamics *d) { return hk_bodies_table(d); }

hk_status hk_install_sources(hk_loop *loop) {
  const bool tears = hk_surfaces_may_tear(loop);
  if (loop->plugins->kind[HK_SOURCE].count == 0 && !tears) return HK_OK;
  loop->population = hk_population_open(loop->state);
  loop->emit = tears ? hk_emit_and_tear : hk_sources_emit;
  return loop->population ? HK_OK : hk_error_set(loop->error, HK_NO_MEMORY, "no memory for births and deaths");
}

hk_status hk_install_losses(hk_loop *loop, bool resumed) {
  hk_dynamics *d = loop->dynamics;
  bool any;
  hk_status status = HK_OK;
  if (loop->emit == hk_emit_and_tear) status = resumed ? hk_surfaces_resume(loop) : hk_surfaces_tear(loop, &any);
  return status == HK_OK && resumed && d->constrain ? d->constrain->update(d) : status;
}

void hk_install_close(hk_dynamics *d, hk_loop *loop) {
  hk_asked_solvers_close(d);
  hk_bodies_close(d);
  hk_saddle_point_close(d);
  hk_constraints_close(d);
  hk_jacobian_close(d);
  hk_population_close(loop->population);
}
