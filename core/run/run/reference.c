/* A run with an independent method: an adaptive one of high order, explicit or, where a scene is too stiff for that,
 * implicit; where it has to be more accurate than 1e-9, one that reaches rounding (facet adaptive: `finest`). A
 * reference is better than the run: where that is adaptive, the reference has a tenth of its tolerance at most, or
 * there is none. What two runs of one method have in common (swings that it damps, steps that skip what happens) it
 * does not share, because it chooses its steps by its own estimate of their errors. It is worth a part of the run's own
 * cost; costs are counted in evaluations, never by a clock, so that verdicts are reproducible. */
#include "core/engine/contract/contract.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/run/run.h"

#include <float.h>

enum { LEAST_ORDER = 4 };

/* What an implicit step costs, in evaluations: a Jacobian; its factors, of a cloth of 32 x 32 as much as 300
 * evaluations and of 64 x 64 some 590, since those of a surface take n^(3/2) operations (George 1973), of chains, by
 * a solver for matrices of that kind, some 10; in each stage some iterations. Constraints take factors in every
 * evaluation. */
static const double jacobian_cost = 5, factor_cost = 10, factor_per_particle = 0.5, factor_per_root = 9,
                    implicit_stage = 8;

/* What a reference may cost: a share of the run's evaluations, and `free` evaluations of a scene of a few particles;
 * one of 16 particles costs about twice as much as one of none. */
static const struct budget {
  double share, free, particles;
} budgets[] = {
    [HK_EFFORT_SMALL] = {0.4, 6e4, 16}, [HK_EFFORT_MEDIUM] = {0.4, 6e5, 16}, [HK_EFFORT_LARGE] = {4, 6e5, 16}};

/* Parts of the accuracy that a step may be off by: errors of 1e4 steps and more add up. Where that takes too many
 * steps, a coarser reference is better than none, with less confidence. */
static const struct strictness { double part, reserve; } strictnesses[] = {{1e-5, 0.98}, {3e-3, 0.8}};
/* A tolerance that is less than so many times another takes about as many steps: fewer by 1 in 4 at order 5. */
static const double coarser = 4;

enum { STRICTNESSES = sizeof strictnesses / sizeof *strictnesses };

static const double coarsest = 1e-6, of_own = 0.1;

/* A method reaches rounding whose tolerance may be so small; it is worth its sweeps below a tolerance `sharp`; and its
 * iteration converges up to h w of some 2. */
static const double rounding = 1e-15, sharp = 2e-9, iteration_limit = 2;

typedef struct wish {
  bool implicit, constraints, rounding;
} wish;

static bool suits(const hk_plugin *plugin, const void *context) {
  const wish *w = context;
  const hk_integrator *m = plugin->integrator;
  bool solves = m->flags & (HK_IMPLICIT | HK_NEEDS_SOLVER | HK_NEEDS_JACOBIAN);
  if (!(m->flags & HK_ADAPTIVE) || solves != w->implicit || m->order < LEAST_ORDER) return false;
  if (w->rounding != (hk_finest_tolerance(m) <= rounding)) return false;
  return !(w->implicit && !(m->flags & HK_IMPLICIT)) &&
         !(w->constraints && hk_integrator_tables_of(m)->constrained.refused);
}

static double factors(const hk_run *whole) {
  const hk_counts *c = &whole->dynamics.count;
  double n = (double)whole->state.model.n;
  if (c->special_factorizations == c->factorizations) return factor_cost;
  return factor_cost + fmin(factor_per_particle * n, factor_per_root * sqrt(n));
}

static double cost(const hk_run *whole) {
  const hk_counts *c = &whole->dynamics.count;
  return (double)c->evaluations + jacobian_cost * (double)c->jacobians + factors(whole) * (double)c->factorizations;
}

static double evaluations_of(const hk_integrator *method) {
  double stated = hk_integrator_tables_of(method)->adaptive.evaluations;
  return stated > 0 ? stated : method->stages;
}

static double step_cost(const hk_run *whole, const hk_integrator *method) {
  double constrained = whole->plugins.kind[HK_CONSTRAINT].count ? factors(whole) : 0;
  if (!(method->flags & HK_IMPLICIT)) return evaluations_of(method) * (1 + constrained);
  return method->stages * implicit_stage + jacobian_cost + factors(whole);
}

/* An implicit method takes more than the share of a run that is implicit itself, so it is for small scenes. */
static double allowed_steps(const hk_run *whole, hk_effort effort, const hk_integrator *method) {
  const struct budget *b = &budgets[effort];
  double share = method->flags & HK_IMPLICIT && effort != HK_EFFORT_LARGE ? 0 : b->share;
  double free_cost = method->flags & HK_IMPLICIT ? step_cost(whole, method) : evaluations_of(method);
  return share * cost(whole) / step_cost(whole, method) +
         b->free / (1 + (double)whole->state.model.n / b->particles) / free_cost;
}

static double end_of(const hk_run *whole, const hk_reference *want) {
  return want->until > 0 ? want->until : whole->state.t;
}

/* The steps that a method needs at least: one for each frame, and an explicit method of s stages is stable for h w < s
 * at most (van der Houwen 1977, Construction of integration formulas, 2.6). */
static double least_steps(const hk_run *whole, const hk_reference *want, const hk_integrator *method) {
  double end = end_of(whole, want), part = whole->state.t > 0 ? end / whole->state.t : 1;
  double w = fmax(want->frequency, whole->step->spectrum.w_reached);
  bool iterates = hk_integrator_tables_of(method)->adaptive.evaluations > 0;
  double limit = iterates ? iteration_limit : method->stages;
  double stable = method->flags & HK_IMPLICIT ? 0 : w * end / limit;
  return fmax(part * (double)whole->record.frames, stable);
}

/* What is looked for, and with what confidence. */
typedef struct search {
  const hk_scene_loader *loader;
  const hk_run_options *first;
  const hk_run *whole;
  const hk_reference *want;
  const struct strictness *strict;
  hk_comparison_run *found;
  hk_error error; /* of the last run that was tried */
} search;

static double least_of_own(const hk_run *whole) {
  return whole->loop.method->flags & HK_ADAPTIVE ? of_own * whole->dynamics.system.tol : INFINITY;
}

static double tolerance(const search *s, const struct strictness *strict) {
  return fmin(least_of_own(s->whole), fmin(coarsest, s->want->relative * strict->part));
}

/* The reference that reaches rounding starts where the run does, up to rounding, so that its distance is the error. */
static hk_run_options options_of(const search *s, const hk_plugin *plugin) {
  hk_run_options o = hk_comparison_run_options(s->first, 2);
  double finest = hk_finest_tolerance(plugin->integrator);
  if (finest <= rounding) o.perturb = DBL_EPSILON;
  o.integrator = plugin->name;
  o.dt = INFINITY;
  o.tol = fmax(tolerance(s, s->strict), finest);
  o.refine = 0;
  o.dt_most = isfinite(s->want->dt_most) ? s->want->dt_most : 0;
  return o;
}

static bool take(search *s, const hk_run_options *o, const hk_plugin *plugin) {
  double end = end_of(s->whole, s->want);
  bool reached = hk_comparison_run_take(s->loader, o, s->whole, end, s->found, &s->error) == HK_OK;
  s->found->method = plugin->name;
  s->found->perturbation = o->perturb;
  s->found->reserve = s->strict->reserve;
  if (!reached) hk_trajectory_free(&s->found->trajectory);
  return reached;
}

static bool attempt(search *s, wish w) {
  const hk_run *whole = s->whole;
  const hk_plugin *plugin;
  s->error = (hk_error){0};
  if (hk_registry_prefer(whole->scene->registry, HK_INTEGRATOR, suits, &w, &plugin, &s->error) != HK_OK) return false;
  hk_run_options o = options_of(s, plugin);
  double steps = allowed_steps(whole, s->want->effort, plugin->integrator);
  if (o.tol > least_of_own(whole) || !(steps >= least_steps(whole, s->want, plugin->integrator))) return false;
  o.step_limit = (size_t)steps;
  bool reached = take(s, &o, plugin);
  if (s->error.status == HK_NO_MEMORY)
    hk_warn(whole->loop.warnings, "no memory for a run with %s, with which this one would be compared: %s",
            plugin->name, s->error.text);
  return reached;
}

/* The scene cannot be run again, whatever the method. */
static bool is_lost(const hk_error *e) {
  return e->status == HK_IO || e->status == HK_SCRIPT || e->status == HK_BAD_PARAM;
}

/* An explicit method: where a tolerance is sharp, one that reaches rounding, of smooth scenes; another one if that
 * takes too many steps, or is not there. */
static bool attempt_explicit(search *s) {
  wish w = {.constraints = s->whole->plugins.kind[HK_CONSTRAINT].count > 0}, best = w;
  best.rounding = true;
  bool smooth = !w.constraints && !s->whole->dynamics.system.contact;
  if (smooth && tolerance(s, s->strict) < sharp && attempt(s, best)) return true;
  return !is_lost(&s->error) && attempt(s, w);
}

static bool attempt_implicit(search *s) {
  return attempt(s, (wish){.implicit = true, .constraints = s->whole->plugins.kind[HK_CONSTRAINT].count > 0});
}

/* Steps that an explicit method could take are not too short for another one. */
static bool is_explicit(const hk_run *whole) { return !(whole->loop.method->flags & (HK_IMPLICIT | HK_ADAPTIVE)); }

/* Such a source bears at other times where the steps are others. */
static bool emits_before_steps(const hk_run *whole) {
  const hk_instances *sources = &whole->plugins.kind[HK_SOURCE];
  for (size_t k = 0; k < sources->count; k++)
    if (!(sources->item[k]->plugin->source->flags & HK_AFTER_STEPS)) return true;
  return false;
}

bool hk_reference_take(const hk_scene_loader *loader, const hk_run_options *first, const hk_run *whole,
                       const hk_reference *want, hk_comparison_run *found) {
  search s = {loader, first, whole, want, strictnesses, found, {0}};
  if (whole->plugins.kind[HK_CORRECTOR].count || emits_before_steps(whole)) return false;
  if (whole->record.force_rms > 0) return false; /* it would have the errors of the forces as well */
  for (size_t k = 0; k < (want->coarse ? STRICTNESSES : 1); k++) {
    s.strict = &strictnesses[k];
    if (k > 0 && !(tolerance(&s, s.strict) > coarser * tolerance(&s, s.strict - 1))) break;
    if (attempt_explicit(&s)) return true;
    if (!is_explicit(whole) && attempt_implicit(&s)) return true;
  }
  return false;
}
