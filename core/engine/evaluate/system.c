/* Assembly of the hk_system that integrators see: its functions, its list of forces, and the updates after births and
 * deaths. */
#include "core/engine/contract/contract.h"
#include "core/engine/evaluate/evaluate.h"

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
  *potential = hk_query_potential(dynamics_of(s), t, X);
  return HK_OK;
}

static void impose(hk_system *s, double t, double *x, double *v) { hk_dynamics_impose(dynamics_of(s), t, x, v); }

static void filter(hk_system *s, double *vector) {
  hk_pins_filter(dynamics_of(s)->pins, vector);
  for (size_t k = 0; k < s->model->riders; k++)
    memset(vector + 3 * (size_t)s->model->rider[k].particle, 0, 3 * sizeof *vector);
}

static void set_functions(hk_system *s) {
  s->accelerations = hk_evaluate_accelerations;
  s->rates = rates;
  s->impose = impose;
  s->filter = filter;
  s->fused = hk_evaluate_fused;
  s->tile = hk_evaluate_several;
  s->exchange = hk_evaluate_exchange;
}

static const hk_contact_table contact = {
    .update = hk_forces_update, .step_limit = hk_forces_step_limit, .potential = hk_forces_potential, .energy = energy};

static size_t count_element_lists(const hk_instances *forces) {
  size_t count = 0;
  for (size_t k = 0; k < forces->count; k++) count += hk_force_element_lists(forces->item[k]->plugin);
  return count;
}

static hk_status list_forces(hk_dynamics *d) {
  size_t count = d->plugins->kind[HK_FORCE].count;
  d->force_view = calloc(count + 1, sizeof *d->force_view);
  d->force_acts = calloc(count + 1, sizeof *d->force_acts);
  d->takes = calloc(count + 1, sizeof *d->takes);
  d->force_info = calloc(count + 1, sizeof *d->force_info);
  size_t lists = count_element_lists(&d->plugins->kind[HK_FORCE]);
  d->element_list = calloc(lists + 1, sizeof *d->element_list);
  d->offered = calloc(lists + 1, sizeof *d->offered);
  if (!d->force_view || !d->force_acts || !d->takes || !d->force_info || !d->element_list || !d->offered)
    return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu forces", count);
  for (size_t k = 0; k < count; k++) {
    const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    const hk_force_tables *f = hk_force_of(force->plugin);
    d->force_info[k] = (hk_force_info){.label = force->label,
                                       .flags = f->own.flags,
                                       .jacobian = f->implicit.jacobian != NULL,
                                       .elements = f->elements.list != NULL,
                                       .gradient = f->own.energy && !(f->own.flags & (HK_POWER | HK_DEPENDS_ON_V))};
  }
  d->split = (hk_split_table){.forces = count, .force = d->force_info, .takes = d->takes};
  hk_dynamics_take_all(d);
  return HK_OK;
}

static void set_flags(hk_dynamics *d) {
  const unsigned kept = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_DEPENDS_ON_CHANNELS;
  unsigned *flags = &d->queries.flags;
  const hk_instances *forces = &d->plugins->kind[HK_FORCE], *constraints = &d->plugins->kind[HK_CONSTRAINT];
  for (size_t k = 0; k < forces->count; k++) {
    const hk_force_tables *f = hk_force_of(forces->item[k]->plugin);
    *flags |= f->own.flags & kept;
    d->has_timed |= forces->item[k]->spec->timed_count > 0;
    d->updates |= f->steps.update != NULL;
    d->limits |= f->surfaces.step_limit != NULL;
    d->listens |= f->steps.accepted || f->internal.evolve;
    d->demands |= f->bounds.longest_step != NULL;
  }
  for (size_t k = 0; k < constraints->count; k++) d->has_timed |= constraints->item[k]->spec->timed_count > 0;
  d->system.contact = d->updates || d->limits ? &contact : NULL;
  if (constraints->count) *flags |= HK_DEPENDS_ON_X | HK_DEPENDS_ON_V;
  if (d->has_timed || d->pins->has_paths) *flags |= HK_DEPENDS_ON_T;
}

hk_status hk_dynamics_open(hk_dynamics *d, hk_state *state, hk_pins *pins, hk_plugins *plugins, hk_shared *shared) {
  const hk_system kept = d->system;
  *d = (hk_dynamics){.system = kept, .state = state, .pins = pins, .plugins = plugins};
  d->shared = shared;
  d->error = shared->error;
  d->timed_at = NAN;
  set_functions(&d->system);
  d->system.split = &d->split;
  d->queries = (hk_system_queries){.stiffness_bound = hk_forces_stiffness, .uncoupled = hk_query_uncoupled};
  d->system.queries = &d->queries;
  hk_status status = list_forces(d);
  d->tiles = (hk_tiles){.state = state,
                        .pins = pins,
                        .shared = shared,
                        .forces = &plugins->kind[HK_FORCE],
                        .view = d->force_view,
                        .acts = d->force_acts,
                        .takes = d->takes};
  if (status == HK_OK && !hk_tiles_open(&d->tiles))
    status = hk_error_set(d->error, HK_NO_MEMORY, "no memory for the parts of forces");
  if (status == HK_OK) status = hk_publications_list(d);
  if (status != HK_OK) return status;
  set_flags(d);
  const hk_instance *method = hk_plugins_one(plugins, HK_INTEGRATOR);
  if (method) d->system.host = &method->host;
  bool spare = method && method->plugin->integrator->flags & HK_USES_SPARE;
  if (spare && !hk_state_open_spare(state)) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for a new state");
  hk_dynamics_refresh(d);
  status = hk_tiles_arrange(&d->tiles, d->error);
  return status == HK_OK ? hk_evaluate_resize(d) : status;
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
  for (size_t k = 0; k < d->split.forces; k++)
    d->force_view[k] = hk_instance_view(d->plugins->kind[HK_FORCE].item[k], &d->state->view);
}

static hk_status start(hk_dynamics *d, hk_instance *instance) {
  hk_status status = hk_instance_select(instance, &d->state->model, d->error);
  if (status == HK_OK) status = hk_instance_set_time(instance, d->state->t, d->error);
  hk_view view = hk_instance_view(instance, &d->state->view);
  if (status == HK_OK) status = hk_instance_start(instance, &view, d->state->size, d->error);
  return d->error->status == HK_OK ? status : d->error->status; /* also of a service that it asked for */
}

hk_status hk_dynamics_start(hk_dynamics *d) {
  static const hk_kind order[] = {HK_CONSTRAINT, HK_FORCE, HK_CORRECTOR, HK_SOURCE, HK_INTEGRATOR, HK_OUTPUT};
  hk_status status = HK_OK;
  for (size_t o = 0; o < sizeof order / sizeof *order && status == HK_OK; o++) {
    const hk_instances *list = &d->plugins->kind[order[o]];
    for (size_t k = 0; k < list->count && status == HK_OK; k++) status = start(d, list->item[k]);
    hk_dynamics_refresh(d);                            /* the forces' selections of particles are known now */
    if (status == HK_OK) status = hk_joins_refresh(d); /* which surfaces of contact take for strands */
  }
  return status == HK_OK ? hk_elements_refresh(d) : status;
}

hk_status hk_dynamics_begin(hk_dynamics *d) {
  for (size_t k = 0; k < d->split.forces; k++)
    d->force_acts[k] = hk_force_acts_at(d->plugins->kind[HK_FORCE].item[k], d->state->t);
  hk_state_refresh(d->state);
  hk_dynamics_refresh(d);
  return hk_elements_refresh(d);
}

static hk_status remap(hk_dynamics *d, const uint32_t *map, size_t n_old) {
  hk_pins_remap(d->pins, map);
  hk_status status = hk_riders_remap(d->state, map, d->error);
  hk_dynamics_refresh(d);
  if (status == HK_OK) status = hk_plugins_remap(d->plugins, map, n_old, &d->state->view, d->state->size, d->error);
  hk_dynamics_refresh(d); /* selections have changed as well */
  if (status == HK_OK) status = hk_elements_refresh(d);
  if (status == HK_OK) status = hk_evaluate_resize(d);
  if (status == HK_OK && d->constrain) status = d->constrain->topology(d);
  if (d->blocks_changed) d->blocks_changed(d, true);
  return status == HK_OK ? hk_forces_settle(d) : status;
}

hk_status hk_dynamics_remap(hk_dynamics *d, const uint32_t *map, size_t n_old) {
  d->lost = true;
  hk_status status = remap(d, map, n_old);
  d->lost = status != HK_OK;
  return status;
}

void hk_dynamics_close(hk_dynamics *d) {
  hk_evaluations_close(&d->evaluations);
  hk_tiles_close(&d->tiles);
  void *arrays[] = {d->force_view, d->force_acts,  d->takes, d->force_info,  d->element_list,
                    d->offered,    d->publication, d->join,  d->unaccounted, d->predicted};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
}
