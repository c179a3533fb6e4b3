/* The scene's solver. Where the scene names none, it is chosen by the flags of the installed solvers, the kind of the
 * forces and the number of unknowns. Times are not measured, so runs are reproducible. It is opened before the first
 * step. */
#include "core/dynamics/dynamics.h"

enum { LARGE = 300000 }; /* unknowns; the factors of a surface of this size take gigabytes */

static bool needs_unsymmetric_solver(const hk_dynamics *d) {
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++) {
    const hk_force *force = d->plugins->kind[HK_FORCE].item[k]->plugin->force;
    if (force->jacobian && !(force->flags & (HK_SYMMETRIC_JACOBIAN | HK_OFFERS_SYMMETRIC))) return true;
  }
  return false;
}

static bool suits(const hk_plugin *plugin, const void *context) {
  const hk_dynamics *d = context;
  unsigned flags = plugin->solver->flags;
  if (d->plugins->kind[HK_CONSTRAINT].count)
    return needs_unsymmetric_solver(d) ? flags & HK_SOLVES_UNSYMMETRIC : !(flags & HK_ITERATIVE);
  if (needs_unsymmetric_solver(d)) return flags & HK_SOLVES_UNSYMMETRIC;
  return 3 * d->state->model.n > LARGE ? flags & HK_ITERATIVE : !(flags & HK_ITERATIVE);
}

static hk_status start(hk_dynamics *d, hk_instance *solver) {
  hk_view view = hk_instance_view(solver, &d->state->view);
  hk_status status = hk_instance_set_time(solver, d->state->t, d->error);
  return status == HK_OK ? hk_instance_start(solver, &view, d->state->size, d->error) : status;
}

hk_status hk_solver_open(hk_dynamics *d, const hk_plugin_spec *named) {
  const hk_plugin *plugin;
  hk_status status = HK_OK;
  if (d->solver) return HK_OK;
  if (!named) {
    status = hk_registry_prefer(d->scene->registry, HK_SOLVER, suits, d, &plugin, d->error);
    if (status != HK_OK) return status;
    named = d->solver_spec = hk_spec_create(plugin, plugin->name, "", d->error);
    if (!named) return HK_NO_MEMORY;
  }
  status = hk_plugins_add(d->plugins, named, d->shared, &d->solver, d->error);
  return status == HK_OK ? start(d, d->solver) : status;
}

static bool takes_saddle_points(const hk_plugin *plugin, const void *context) {
  const unsigned needed = HK_SOLVES_INDEFINITE | HK_SOLVES_UNSYMMETRIC;
  (void)context;
  return (plugin->solver->flags & (needed | HK_ITERATIVE)) == needed;
}

static hk_status make(hk_dynamics *d, const hk_plugin_spec *spec, hk_instance **solver) {
  hk_instance *twin = hk_instance_create(spec, d->shared, d->error);
  if (!twin) return HK_NO_MEMORY;
  hk_status status = start(d, twin);
  if (status == HK_OK)
    *solver = twin;
  else
    hk_instance_destroy(twin);
  return status;
}

hk_status hk_solver_twin(hk_dynamics *d, hk_instance **solver) { return make(d, d->solver->spec, solver); }

hk_status hk_solver_indefinite(hk_dynamics *d, hk_instance **solver, hk_plugin_spec **spec) {
  const hk_plugin *plugin;
  *spec = NULL;
  if (takes_saddle_points(d->solver->plugin, NULL)) return make(d, d->solver->spec, solver);
  hk_status status = hk_registry_prefer(d->scene->registry, HK_SOLVER, takes_saddle_points, NULL, &plugin, d->error);
  if (status != HK_OK) return status;
  *spec = hk_spec_create(plugin, plugin->name, "", d->error);
  return *spec ? make(d, *spec, solver) : HK_NO_MEMORY;
}
