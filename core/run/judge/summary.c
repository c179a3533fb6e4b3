/* The summary of a run: all its figures, gathered in one structure. */
#include "core/engine/contract/contract.h"
#include "core/numerics/implicit/implicit.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/judge/judge.h"

#include <stdio.h>
#include <stdlib.h>

const char *hk_verdict_name(hk_verdict verdict) {
  switch (verdict) {
  case HK_VERDICT_OK:
    return "ok";
  case HK_INACCURATE:
    return "inaccurate";
  case HK_DIVERGED:
    return "diverged";
  case HK_STOPPED:
    return "interrupted";
  case HK_RUNNING:
    break;
  }
  return "running";
}

static double seconds_of(const hk_instance *instance) {
  if (instance->plugin->kind == HK_SERVICE)
    return instance->plugin->service->seconds ? instance->plugin->service->seconds(instance->self) : NAN;
  bool sampled = instance->sampled && instance->calls > instance->sampled;
  return instance->seconds * (sampled ? (double)instance->calls / (double)instance->sampled : 1);
}

/* The time of all plugins of a kind. */
static double seconds_of_kind(const hk_loop *loop, hk_kind kind) {
  const hk_instances *all = &loop->plugins->kind[kind];
  double seconds = 0;
  for (size_t k = 0; k < all->count; k++)
    if (all->item[k]->started) seconds += seconds_of(all->item[k]);
  return seconds;
}

/* What the steps took is shared among forces and constraints, of which samples are measured, correctors and sources,
 * and the integrator, which has the rest; so these add up to it. On a machine that others use, samples may have waited
 * more than the rest of the run: they are worth no more than there is, and the integrator then has nothing. The times
 * of solvers and services are also in those of their clients. */
typedef struct shares {
  double of_samples; /* at most 1: what they are worth */
  double integrator; /* s */
} shares;

static shares shares_of(const hk_loop *loop) {
  double samples = seconds_of_kind(loop, HK_FORCE) + seconds_of_kind(loop, HK_CONSTRAINT);
  double left = fmax(0, loop->seconds - seconds_of_kind(loop, HK_CORRECTOR) - seconds_of_kind(loop, HK_SOURCE));
  return (shares){samples > left ? left / samples : 1, fmax(0, left - samples)};
}

static double share_of(const hk_instance *instance, const shares *s) {
  hk_kind kind = instance->plugin->kind;
  if (kind == HK_INTEGRATOR) return s->integrator;
  return seconds_of(instance) * (kind == HK_FORCE || kind == HK_CONSTRAINT ? s->of_samples : 1);
}

/* What a corrector or a force says of the run so far. */
static void own_figures(const hk_loop *loop, const hk_instance *i, hk_plugin_time *time) {
  size_t (*list)(void *, const hk_view *, hk_own_figure *) = NULL;
  if (i->plugin->kind == HK_CORRECTOR) list = i->plugin->corrector->figures;
  if (i->plugin->kind == HK_FORCE) list = hk_force_of(i->plugin)->figures.list;
  if (!list) return;
  hk_view view = hk_instance_view(i, &loop->state->view);
  const hk_instance *outer = hk_enter(i);
  time->figures = list(i->self, &view, time->figure);
  if (i->plugin->kind == HK_FORCE && hk_force_of(i->plugin)->figures.remedy)
    time->remedy = hk_force_of(i->plugin)->figures.remedy(i->self, &view);
  hk_leave(i, outer);
}

static void plugin_times(const hk_loop *loop, hk_judgement *j, hk_summary *s) {
  static const hk_kind order[] = {HK_FORCE,  HK_CONSTRAINT, HK_CORRECTOR, HK_SOURCE,
                                  HK_OUTPUT, HK_INTEGRATOR, HK_SOLVER,    HK_SERVICE};
  const shares of = shares_of(loop);
  size_t room = 0;
  for (int kind = 0; kind < HK_KINDS; kind++) room += loop->plugins->kind[kind].count;
  free(j->plugin_time);
  j->plugin_time = calloc(room + 1, sizeof *j->plugin_time);
  for (size_t o = 0; j->plugin_time && o < sizeof order / sizeof *order; o++)
    for (size_t k = 0; k < loop->plugins->kind[order[o]].count; k++) {
      const hk_instance *instance = loop->plugins->kind[order[o]].item[k];
      if (!instance->started) continue;
      hk_plugin_time *time = &j->plugin_time[s->plugins++];
      *time = (hk_plugin_time){.kind = hk_kind_name(order[o]),
                               .name = instance->plugin->name,
                               .label = instance->label,
                               .seconds = share_of(instance, &of),
                               .apart = order[o] == HK_FORCE && hk_evaluate_is_apart(loop->dynamics, k)};
      own_figures(loop, instance, time);
    }
  s->plugin = j->plugin_time;
}

/* The hand of a user who has only watched. */
static bool is_idle_hand(const hk_instance *force, const hk_record *r) {
  return hk_force_of(force->plugin)->by_hand.moved && !r->by_hand && !force->plugin->force->energy;
}

static double momentum_drift(const hk_loop *loop, const hk_judgement *j) {
  const hk_record *r = loop->record;
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  bool conserved = loop->pins->count == 0 && !r->moved && !r->sourced;
  for (size_t k = 0; k < forces->count; k++)
    conserved = conserved &&
                (forces->item[k]->plugin->force->flags & HK_CONSERVES_MOMENTUM || is_idle_hand(forces->item[k], r));
  if (!conserved || !(r->momentum_scale > 0)) return NAN;
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double change = j->last_frame.momentum[c] - r->momentum_first[c];
    sum += change * change;
  }
  return sqrt(sum) / r->momentum_scale;
}

/* J: what stands still trembles by the last digits of its positions, some of 1e-16, in every step. */
static double kinetic_rounding(const hk_loop *loop) {
  const hk_state *state = loop->state;
  double mass = 0, far = 0, h = loop->record->steps ? loop->record->dt_min : INFINITY;
  for (size_t i = 0; i < state->model.n; i++) mass += state->inverse_mass[i] > 0 ? state->mass[i] : 0;
  for (size_t c = 0; c < 3 * state->model.n; c++) far = fmax(far, fabs(state->X[c]));
  double speed = 1e-14 * far / h;
  return mass * speed * speed / 2;
}

static void energies(hk_loop *loop, hk_summary *s) {
  const hk_state *state = loop->state;
  const hk_record *r = loop->record;
  double kinetic = hk_state_kinetic(state, state->X);
  bool balanced = hk_query_has_energy(loop->dynamics);
  s->energy_first = r->energy_first;
  s->energy_last = kinetic + hk_query_potential(loop->dynamics, state->t, state->X);
  s->energy_work = balanced ? hk_loop_work(state, r) : NAN;
  s->kinetic_max = fmax(r->kinetic_max, kinetic);
  s->kinetic_mean = r->frames ? r->kinetic_sum / (double)r->frames : kinetic;
  bool known = balanced && !r->corrected && !r->sourced && s->kinetic_max > 0;
  s->energy_drift = known ? (s->energy_last - s->energy_first - s->energy_work) / s->kinetic_max : NAN;
}

static void solvers(const hk_dynamics *d, hk_summary *s) {
  if (!hk_solver_in_use(d) || (d->count.factorizations == 0 && !d->constraints && !d->matrix)) return;
  const hk_instance *saddle = hk_saddle_point_solver(d), *solver = hk_solver_in_use(d);
  const hk_plugin *plugin = solver->plugin;
  s->solver = plugin->name;
  s->solver_choice = saddle                                    ? "chosen for the saddle points of constraints"
                     : d->special_spec && plugin->solver->fits ? "chosen for the pattern of the matrix"
                     : d->solver_spec                          ? "chosen for the forces and the size"
                                                               : "";
  const hk_instance *outer = hk_enter(solver);
  if (plugin->solver->describe) plugin->solver->describe(solver->self, s->solver_libraries, sizeof s->solver_libraries);
  hk_leave(solver, outer);
}

static void steps(const hk_loop *loop, hk_summary *s) {
  const hk_record *r = loop->record;
  const char *how = hk_step_choice_of(loop)->chosen ? "chosen" : "given";
  char limit[64] = "";
  s->steps = r->steps;
  s->frames = r->frames;
  s->rejected_steps = r->rejected;
  s->late_impacts = r->late_impacts;
  s->dt_min = r->steps ? r->dt_min : NAN;
  s->dt_max = r->steps ? r->dt_max : NAN;
  s->dt_limit = hk_step_choice_of(loop)->dt_limit;
  s->dt_chosen = hk_step_choice_of(loop)->chosen;
  if (isfinite(s->dt_limit)) snprintf(limit, sizeof limit, "; largest stable step %.4g s", s->dt_limit);
  if (r->steps && s->dt_max - s->dt_min > 1e-9 * s->dt_max)
    snprintf(s->step, sizeof s->step, "%.4g to %.4g s (%s%s)", s->dt_min, s->dt_max, how, limit);
  else if (r->steps)
    snprintf(s->step, sizeof s->step, "%.6g s (%s%s)", s->dt_max, how, limit);
}

static void wall_times(const hk_loop *loop, const hk_asked *asked, hk_summary *s) {
  s->start_wall_s = loop->first_step_at > 0 ? loop->first_step_at - asked->opened_at : NAN;
  s->wall_s = hk_clock() - asked->opened_at;
  s->step_wall_s = loop->seconds;
  s->steps_per_s = loop->seconds > 0 ? (double)s->steps / loop->seconds : NAN;
}

static size_t accuracies(const hk_scene *scene, const hk_asked *asked) {
  if (asked->accuracy == 0) return 0; /* the user wants none */
  size_t count = asked->accuracy > 0;
  for (size_t k = 0; k < scene->particles.channels; k++) count += scene->particles.channel[k].accuracy > 0;
  return count;
}

static void accuracy_figures(hk_loop *loop, const hk_judgement *j, const hk_asked *asked, hk_summary *s) {
  bool found;
  hk_error later = {0}; /* the end of the run asks again, and fails */
  double strain = hk_query_strain(loop->dynamics, NULL, &found), most = loop->record->strain_max;
  s->momentum_drift = momentum_drift(loop, j);
  s->constraint_violation = loop->record->violation_max;
  s->max_strain = !found ? NAN : fabs(strain) > fabs(most) || !isfinite(strain) ? strain : most;
  s->accuracy = asked->accuracy > 0 ? asked->accuracy : NAN;
  s->force_work = loop->record->force_work;
  bool approximate = loop->record->force_rms > 0;
  s->force_rms = approximate ? loop->record->force_rms : NAN;
  s->force_p99 = approximate ? loop->record->force_p99 : NAN;
  s->force_largest = approximate ? loop->record->force_largest : NAN;
  s->path_speed_error = loop->record->path_speed_error > 0 ? loop->record->path_speed_error : NAN;
  s->hand_work = loop->record->by_hand ? loop->record->hand_work : NAN;
  s->exact_error = NAN;
  if (j->verdict != HK_DIVERGED && !loop->record->by_hand) hk_figures_exact(j->scene, loop, &s->exact_error, &later);
  s->accuracies = accuracies(j->scene, asked);
}

static void comparison_figures(const hk_comparisons *c, hk_summary *s) {
  s->verify_difference = c->difference;
  s->error_estimate = c->position;
  s->channel_error = c->channel_error;
  s->check_wall_s = c->wall_s;
}

static void contact_figures(const hk_record *r, hk_summary *s) {
  bool any = r->contact_frames > 0;
  s->contact_frames = any ? (double)r->contact_frames : NAN;
  s->intersections = any ? (double)r->contact.intersections : NAN;
  s->intersections_first = any && r->intersections[0] ? (double)r->intersections[0] : NAN;
  s->closest = any && isfinite(r->contact.closest) ? r->contact.closest : NAN;
  s->impulse = any ? r->contact.impulse : NAN;
  s->impact_energy = any ? r->contact.impact_energy : NAN;
}

void hk_summary_measure(hk_loop *loop, hk_judgement *j, const hk_asked *asked, hk_summary *s) {
  const hk_counts *count = &loop->dynamics->count;
  *s = (hk_summary){.scene = j->scene->name,
                    .origin = j->scene->origin,
                    .integrator = loop->integrator->plugin->name,
                    .solver_choice = ""};
  s->t = j->verdict == HK_DIVERGED ? j->last_good.t : loop->state->t;
  s->end = asked->end;
  s->fps = loop->fps;
  s->n = loop->state->model.n;
  s->force_evaluations = count->evaluations;
  s->jacobian_evaluations = count->jacobians;
  s->factorizations = count->factorizations;
  s->linear_iterations = count->linear_iterations;
  solvers(loop->dynamics, s);
  steps(loop, s);
  wall_times(loop, asked, s);
  energies(loop, s);
  s->kinetic_rounding = kinetic_rounding(loop);
  s->damps_below = hk_damps_below(loop);
  accuracy_figures(loop, j, asked, s);
  contact_figures(loop->record, s);
  comparison_figures(&j->comparisons, s);
  plugin_times(loop, j, s);
  s->measures = j->scene->measures;
  s->measure_name = j->measure_name;
  s->measure_unit = j->measure_unit;
  s->measure = j->measure;
  s->warnings = loop->warnings->count;
  s->warning = loop->warnings->text;
}
