/* The verdict of a run that reached its end: a pure function of what the run measured and of what comparisons with
 * other runs showed. It asks nothing of the run and prints nothing; findings.c has the words. */
#include "core/run/judge/judge.h"

const hk_limits hk_limit = {.visible = 0.1,
                            .mean_energy = 0.5,
                            .unresolved = 0.1,
                            .violation = 1e-6,
                            .violated = 1e-5,
                            .tolerance = 1 + 1e-9,
                            .rounding = 1e-9};

double hk_energy_rounding(const hk_summary *s) {
  return 1e-11 * (fabs(s->energy_first) + fabs(s->energy_last) + s->kinetic_max) + s->kinetic_rounding;
}

static void find(hk_opinion *o, hk_fault fault, double value, double excess, double order) {
  if (o->count < HK_FAULTS) o->finding[o->count++] = (hk_finding){fault, value, excess, order};
}

/* A value above what is allowed; the step cures it by the order. */
static void find_above(hk_opinion *o, hk_fault fault, double value, double allowed, double order) {
  if (value > allowed) find(o, fault, value, value / allowed, order);
}

bool hk_confirmed(const hk_comparisons *c) { return c->reference && c->error <= 1; }

bool hk_damps_as_chosen(const hk_summary *s) { return s->damps_below > 0 && s->accuracies == 0 && s->energy_drift < 0; }

/* J, energy that came or went without a cause. What known errors of forces may have done is no fault of the steps. */
static double drift_of(const hk_summary *s) { return fabs(s->energy_drift) * s->kinetic_max - s->force_work; }

static double excess_of_largest(const hk_summary *s) { return drift_of(s) / (hk_limit.visible * s->kinetic_max); }

static double excess_of_mean(const hk_summary *s) {
  return drift_of(s) / (hk_limit.mean_energy * (s->kinetic_mean + fabs(s->energy_work)));
}

bool hk_damps_visibly(const hk_summary *s) {
  return hk_damps_as_chosen(s) && fmax(excess_of_largest(s), excess_of_mean(s)) > 1;
}

/* ---- energy ---- */

/* Damping is chosen with the method; to lose most of what contact has given is not. Of methods of order 1 the work of
 * contact is not known well enough to tell. */
static bool damps_as_chosen(const hk_evidence *e) {
  double lost = drift_of(e->figures), given = e->record->contact_work;
  return hk_damps_as_chosen(e->figures) && !(e->order > 1 && given > 0 && lost > hk_limit.mean_energy * given);
}

/* Energy that came or went without a cause. It is compared with the kinetic energy that is known to have been there:
 * the largest, and the mean over the frames, which one moment of high speed does not raise; work that was done counts
 * with the latter, since what was dissipated moved before. What grows by a factor in every step is small in its
 * logarithm. */
static void judge_energy(const hk_evidence *e, const hk_comparisons *c, hk_opinion *o) {
  const hk_summary *s = e->figures;
  double drift = drift_of(s), of_largest = excess_of_largest(s), of_mean = excess_of_mean(s),
         excess = fmax(of_largest, of_mean);
  if (!isfinite(s->energy_last) || !isfinite(s->kinetic_max)) {
    find(o, HK_ENERGY_NOT_FINITE, s->energy_last, NAN, 0);
    return;
  }
  if (c->energy_converges || !(drift > hk_energy_rounding(s)) || damps_as_chosen(e)) return;
  if (s->energy_drift > 0) excess = fmin(excess, fmax(1.01, log1p(s->energy_drift) / hk_limit.visible));
  if (of_largest > 1)
    find(o, HK_ENERGY_OF_LARGEST, drift, excess, e->order);
  else if (of_mean > 1)
    find(o, HK_ENERGY_OF_MEAN, drift, excess, e->order);
}

/* J: work of the mean force of contact on a way that nobody sees, as of what lies still to the tolerance of contact. */
static double slight_work(const hk_evidence *e) {
  double impulse = e->record->contact.impulse, t = e->figures->t;
  return impulse > 0 && t > 0 ? hk_limit.rounding * e->extent * impulse / t : 0;
}

/* Surfaces that push each other make a run wrong whoever agrees with it: other methods have the same contact. */
static void judge_contact_energy(const hk_evidence *e, const hk_comparisons *c, hk_opinion *o) {
  const hk_summary *s = e->figures;
  double given = e->record->contact_rise;
  if (given > hk_limit.visible * s->kinetic_max && given > fmax(hk_energy_rounding(s), slight_work(e)))
    find(o, HK_CONTACT_ENERGY, given, NAN, 0);
  else if (hk_confirmed(c) && e->record->contact_frames > 0 && s->energy_drift > 0)
    judge_energy(e, c, o);
}

/* ---- the run's own figures ---- */

/* Figures from which an error of the positions could be inferred. */
static void judge_figures(const hk_evidence *e, const hk_comparisons *c, hk_opinion *o) {
  const hk_summary *s = e->figures;
  const hk_record *r = e->record;
  bool explicit_fixed = !(e->method & (HK_ADAPTIVE | HK_IMPLICIT)), asked = s->accuracy > 0;
  if (explicit_fixed && !e->growth_expected && r->dt_beyond > 0)
    find(o, HK_STEP_UNSTABLE, r->dt_beyond, r->dt_beyond / s->dt_limit, 1);
  judge_energy(e, c, o);
  /* h^2 times the change of the accelerations */
  find_above(o, HK_UNRESOLVED, e->unresolved, asked ? s->accuracy : hk_limit.unresolved * e->extent, 2);
  if (e->missed > (asked ? s->accuracy : hk_limit.visible * e->motion)) find(o, HK_ENCOUNTER, e->missed, NAN, 0);
  find_above(o, HK_ABOVE_TOLERANCE, r->worst_error, hk_limit.tolerance, e->order);
}

/* Where no accuracy is asked for, an error of a tenth of the motion is visible. */
static void judge_exact(const hk_evidence *e, hk_opinion *o) {
  const hk_summary *s = e->figures;
  if (e->ignore_exact || isnan(s->exact_error)) return;
  if (s->accuracy > 0)
    find_above(o, HK_EXACT_ABOVE_ACCURACY, s->exact_error, s->accuracy, e->order);
  else
    find_above(o, HK_EXACT_VISIBLE, s->exact_error, hk_limit.visible * e->exact_motion + hk_limit.rounding * e->extent,
               e->order);
}

/* ---- comparisons with other runs ---- */

static void judge_comparisons(const hk_evidence *e, const hk_comparisons *c, hk_opinion *o) {
  const hk_summary *s = e->figures;
  if (e->record->by_hand) {
    if (c->tried && s->accuracies > 0) find(o, HK_BY_HAND, s->hand_work, NAN, 0);
    return;
  }
  if (c->tried && isnan(c->error) && (s->accuracies > 0 || c->not_begun)) find(o, HK_NOT_CHECKED, NAN, NAN, 0);
  double order = c->order > 0 ? fmin(c->order, e->order) : e->abrupt ? 1 : e->order;
  if (c->tried) find_above(o, HK_ERROR, c->error, 1, order);
  find_above(o, HK_DAMPED, c->damped, s->accuracy, e->order);
  if (!c->tried && c->sampling.varies && c->sampling.where) find(o, HK_PULSE, c->sampling.shortest, NAN, 0);
}

/* What correctors hold to limits of their own. */
static void judge_own_figures(const hk_summary *s, hk_opinion *o) {
  for (size_t p = 0; p < s->plugins; p++)
    for (size_t k = 0; k < s->plugin[p].figures; k++)
      if (hk_above_limit(&s->plugin[p].figure[k])) {
        find(o, HK_OWN_FIGURE, s->plugin[p].figure[k].value, NAN, 0);
        return; /* the words name all of them */
      }
}

/* m: a micrometre, unless that is much of the scene, or less than its coordinates can hold. */
static double most_violation(const hk_evidence *e) {
  return fmin(fmax(hk_limit.violation, hk_limit.rounding * e->extent), hk_limit.violated * e->extent);
}

hk_opinion hk_verdict_find(const hk_evidence *e, const hk_comparisons *c) {
  hk_opinion o = {.verdict = HK_VERDICT_OK};
  const hk_record *r = e->record;
  if (!hk_confirmed(c)) judge_figures(e, c, &o);
  judge_contact_energy(e, c, &o);
  judge_exact(e, &o);
  if (r->violation_max > most_violation(e)) find(&o, HK_VIOLATION, r->violation_max, NAN, 0);
  if (r->intersecting > 0 || r->intersections[1] > 0) find(&o, HK_INTERSECTIONS, NAN, NAN, 0);
  judge_own_figures(e->figures, &o);
  if (e->exact_failed) find(&o, HK_EXACT_FAILED, NAN, NAN, 0);
  judge_comparisons(e, c, &o);
  if (o.count > 0) o.verdict = HK_INACCURATE;
  return o;
}
