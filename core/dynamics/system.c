/* Assembly of the hk_system that integrators see: its functions, its list of forces, and the updates after births and
 * deaths. */
#include "core/dynamics/constraints.h"

#include <stdlib.h>
#include <string.h>

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

static hk_status rates(hk_system *s, double t, double *X, double *dX) {
  size_t n = s->n;
  double *x = X, *v = X + 3 * n;
  hk_status status = s->accelerations(s, t, x, v, X + 6 * n, dX + 3 * n, dX + 6 * n);
  memcpy(dX, v, 3 * n * sizeof *dX);
  return status;
}

static hk_status energy(hk_system *s, double t, const double *X, double *kinetic, double *potential) {
  *kinetic = hk_state_kinetic(dynamics_of(s)->state, X);
  *potential = hk_probe_potential(dynamics_of(s), t, X);
  return HK_OK;
}

static void impose(hk_system *s, double t, double *x, double *v) { hk_dynamics_impose(dynamics_of(s), t, x, v); }

static void filter(hk_system *s, double *vector) { hk_pins_filter(dynamics_of(s)->pins, vector); }

static void exchange(hk_system *s) {
  hk_state *state = dynamics_of(s)->state;
  hk_state_exchange(state);
  s->X = state->X;
  s->spare = state->spare;
}

static void set_functions(hk_system *s) {
  s->accelerations = hk_evaluate_accelerations;
  s->rates = rates;
  s->energy = energy;
  s->impose = impose;
  s->filter = filter;
  s->jacobian = hk_jacobian_assemble;
  s->factorize = hk_implicit_factorize;
  s->solve = hk_implicit_solve;
  s->combine = hk_implicit_combine;
  s->solver_flags = hk_implicit_solver_flags;
  s->solve_columns = hk_implicit_solve_columns;
  s->solve_along = hk_implicit_solve_along;
  s->tangent = hk_constraints_tangent;
  s->project = hk_constraints_project_equalities;
  s->update = hk_sweep_update;
  s->step_limit = hk_sweep_limit;
  s->potential = hk_sweep_potential;
  s->product = hk_sweep_product;
  s->stiffness_bound = hk_sweep_stiffness;
  s->alone = hk_probe_alone;
  s->pass = hk_evaluate_pass;
  s->wave = hk_evaluate_wave;
  s->exchange = exchange;
  s->hold_positions = hk_constraints_hold_positions;
  s->hold_velocities = hk_constraints_hold_velocities;
}

static size_t count_element_lists(const hk_instances *forces) {
  size_t count = 0;
  for (size_t k = 0; k < forces->count; k++) count += hk_force_element_lists(forces->item[k]->plugin->force);
  return count;
}

static hk_status list_forces(hk_dynamics *d) {
  hk_system *s = &d->system;
  size_t count = d->plugins->kind[HK_FORCE].count;
  s->forces = count;
  d->force_view = calloc(count + 1, sizeof *d->force_view);
  d->force_acts = calloc(count + 1, sizeof *d->force_acts);
  d->takes = calloc(count + 1, sizeof *d->takes);
  d->takes_kept = calloc(count + 1, sizeof *d->takes_kept);
  d->force_info = calloc(count + 1, sizeof *d->force_info);
  size_t lists = count_element_lists(&d->plugins->kind[HK_FORCE]);
  d->element_list = calloc(lists + 1, sizeof *d->element_list);
  d->offered = calloc(lists + 1, sizeof *d->offered);
  if (!d->force_view || !d->force_acts || !d->takes || !d->takes_kept || !d->force_info || !d->element_list ||
      !d->offered)
    return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu forces", count);
  for (size_t k = 0; k < count; k++) {
    const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    const hk_force *functions = force->plugin->force;
    d->force_info[k] = (hk_force_info){.label = force->label,
                                       .flags = functions->flags,
                                       .jacobian = functions->jacobian != NULL,
                                       .elements = functions->elements != NULL,
                                       .gradient = functions->energy && !(functions->flags & HK_POWER)};
  }
  s->force = d->force_info;
  s->takes = d->takes;
  hk_dynamics_take_all(d);
  return HK_OK;
}

static void set_flags(hk_dynamics *d) {
  const unsigned kept = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_DEPENDS_ON_CHANNELS;
  hk_system *s = &d->system;
  const hk_instances *forces = &d->plugins->kind[HK_FORCE], *constraints = &d->plugins->kind[HK_CONSTRAINT];
  s->flags = 0;
  for (size_t k = 0; k < forces->count; k++) {
    s->flags |= forces->item[k]->plugin->force->flags & kept;
    d->has_timed |= forces->item[k]->spec->timed_count > 0;
    d->updates |= forces->item[k]->plugin->force->update != NULL;
    d->limits |= forces->item[k]->plugin->force->step_limit != NULL;
    d->listens |= forces->item[k]->plugin->force->accepted != NULL;
    d->demands |= forces->item[k]->plugin->force->longest_step != NULL;
  }
  for (size_t k = 0; k < constraints->count; k++) d->has_timed |= constraints->item[k]->spec->timed_count > 0;
  s->contact = d->updates || d->limits;
  if (constraints->count) s->flags |= HK_DEPENDS_ON_X | HK_DEPENDS_ON_V;
  if (d->has_timed || d->pins->has_paths) s->flags |= HK_DEPENDS_ON_T;
}

hk_status hk_dynamics_open(hk_dynamics *d, const hk_scene *scene, hk_state *state, hk_pins *pins, hk_plugins *plugins,
                           hk_shared *shared) {
  const hk_system kept = d->system;
  *d = (hk_dynamics){.system = kept, .scene = scene, .state = state, .pins = pins, .plugins = plugins};
  d->shared = shared;
  d->error = shared->error;
  d->timed_at = NAN;
  set_functions(&d->system);
  hk_status status = list_forces(d);
  d->parts = (hk_parts){.state = state,
                        .pins = pins,
                        .shared = shared,
                        .forces = &plugins->kind[HK_FORCE],
                        .view = d->force_view,
                        .acts = d->force_acts,
                        .takes = d->takes};
  if (status == HK_OK && !hk_parts_open(&d->parts))
    status = hk_error_set(d->error, HK_NO_MEMORY, "no memory for the parts of forces");
  if (status == HK_OK) status = hk_publications_list(d);
  if (status != HK_OK) return status;
  set_flags(d);
  if (d->system.flags & HK_DEPENDS_ON_T && !hk_evaluations_open(&d->evaluations, scene->duration))
    return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the times of evaluations");
  const hk_instance *method = hk_plugins_one(plugins, HK_INTEGRATOR);
  bool spare = method && method->plugin->integrator->flags & HK_USES_SPARE;
  if (spare && !hk_state_open_spare(state)) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for a new state");
  hk_dynamics_refresh(d);
  status = hk_parts_arrange(&d->parts, d->error);
  return status == HK_OK ? hk_evaluate_resize(d) : status;
}

void hk_dynamics_take_all(hk_dynamics *d) {
  d->system.takes_channels = d->system.takes_constraints = true;
  for (size_t k = 0; k < d->system.forces; k++) d->takes[k] = true;
}

static void refresh_system(hk_dynamics *d) {
  hk_system *s = &d->system;
  s->model = &d->state->model;
  s->t = d->state->t;
  s->X = d->state->X;
  s->spare = d->state->spare;
  s->n = d->state->model.n;
  s->size = d->state->size;
}

void hk_dynamics_refresh(hk_dynamics *d) {
  refresh_system(d);
  for (size_t k = 0; k < d->system.forces; k++)
    d->force_view[k] = hk_instance_view(d->plugins->kind[HK_FORCE].item[k], &d->state->view);
}

hk_status hk_dynamics_remap(hk_dynamics *d, const uint32_t *map, size_t n_old) {
  hk_pins_remap(d->pins, map);
  hk_dynamics_refresh(d);
  hk_status status = hk_plugins_remap(d->plugins, map, n_old, &d->state->view, d->state->size, d->error);
  hk_dynamics_refresh(d); /* selections have changed as well */
  if (status == HK_OK) status = hk_elements_refresh(d);
  if (status == HK_OK) status = hk_evaluate_resize(d);
  if (status == HK_OK) status = hk_constraints_topology(d);
  hk_jacobian_topology(d);
  return status == HK_OK ? hk_sweep_settle(d) : status;
}

void hk_dynamics_close(hk_dynamics *d) {
  hk_constraints_close(d);
  hk_jacobian_close(d);
  hk_evaluations_close(&d->evaluations);
  hk_parts_close(&d->parts);
  void *arrays[] = {d->force_view, d->force_acts,  d->takes, d->takes_kept,  d->force_info, d->element_list,
                    d->offered,    d->publication, d->join,  d->unaccounted, d->predicted};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
}
