/* The verdict of a run that reached its end, derived from the figures that the run measured. */
#include "core/judge/judge.h"
#include "core/text/text.h"

#include <stdio.h>
#include <string.h>

/* Limits above which a finished run is inaccurate. The energy drift is the change of energy without the work of pins
 * and damping: a tenth of the largest kinetic energy is visible in any picture, while the energy error of a symplectic
 * method at 0.9 of its stable limit stays below that on cloth. */
static const double energy_limit = 0.1, mean_energy_limit = 0.5, visible = 0.1, violation_limit = 1e-6,
                    rounding = 1e-9, /* of the extent: what stands still has no motion to compare with */
    unresolved_limit = 0.1;          /* of the extent, in a step */

static void add_reason(hk_judgement *j, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  hk_text_append(j->reason, sizeof j->reason, "; ", format, arguments);
  va_end(arguments);
}

/* Where the exact solution is known and no accuracy is asked for, an error above a tenth of the motion is visible and
 * makes the run inaccurate. */
static void judge_known_error(hk_loop *loop, hk_judgement *j, const hk_asked *asked, const hk_summary *s) {
  if (asked->ignore_exact || s->accuracy > 0 || isnan(s->exact_error)) return;
  double motion = hk_figures_exact_motion(loop, loop->state->t);
  double allowed = visible * motion + rounding * hk_state_extent(loop->state);
  if (!(s->exact_error > allowed)) return;
  hk_remedy_need(j, s->exact_error / allowed, loop->step->method->order);
  add_reason(j, "the error against the exact solution, %.3g m, is more than a tenth of the motion, %.3g m",
             s->exact_error, motion);
}

static hk_status check_exact(hk_loop *loop, hk_judgement *j, const hk_asked *asked) {
  double error;
  bool ignored = asked->ignore_exact || loop->record->by_hand;
  hk_status status = ignored ? HK_OK : hk_figures_exact(loop, &error, loop->error);
  if (status != HK_OK) add_reason(j, "the exact solution is not known: %.600s", loop->error->text);
  return status;
}

/* Energy that came or went without a cause. It is compared with the kinetic energy that is known to have been there:
 * the largest, and the mean over the frames, which one moment of high speed does not raise; work that was done counts
 * with the latter, since what was dissipated moved before. What known errors of forces may have done is no fault of the
 * steps. */
static void judge_energy(hk_judgement *j, const hk_summary *s, int order) {
  double drift = fabs(s->energy_drift) * s->kinetic_max - s->force_work;
  double moved = s->kinetic_mean + fabs(s->energy_work);
  if (!isfinite(s->energy_last) || !isfinite(s->kinetic_max)) {
    add_reason(j, "the energy is not finite: %g J at the end", s->energy_last);
    return;
  }
  if (j->energy_converges || !(drift > hk_energy_rounding(s))) return;
  const char *change = s->energy_drift > 0 ? "grew" : "fell", *cause = s->energy_drift > 0 ? "source" : "sink";
  double excess = fmax(drift / (energy_limit * s->kinetic_max), drift / (mean_energy_limit * moved));
  /* What grows by a factor in every step is small in its logarithm. */
  hk_remedy_need(j, s->energy_drift > 0 ? fmin(excess, fmax(1.01, log1p(s->energy_drift) / energy_limit)) : excess,
                 order);
  if (s->energy_drift < 0 && s->contact_frames > 0)
    cause = "sink (steps lose what impacts within them have, and implicit ones what swings: try a smaller dt)";
  if (drift > energy_limit * s->kinetic_max)
    add_reason(j, "the energy %s by %.3g of the largest kinetic energy without a %s", change, fabs(s->energy_drift),
               cause);
  else if (drift > mean_energy_limit * moved)
    add_reason(j, "the energy %s by %.3g of the mean kinetic energy without a %s", change, drift / s->kinetic_mean,
               cause);
}

/* Surfaces that push each other make a run wrong whoever agrees with it: other methods have the same contact. */
static void judge_contact_energy(hk_judgement *j, const hk_record *r, const hk_summary *s, int order) {
  double given = r->contact_rise;
  if (given > energy_limit * s->kinetic_max && given > hk_energy_rounding(s))
    add_reason(j,
               "contact gave %.3g J, %.3g of the largest kinetic energy, while no surface was driven: try a smaller dt",
               given, given / s->kinetic_max);
  else if (j->confirmed && r->contact_frames > 0 && s->energy_drift > 0)
    judge_energy(j, s, order);
}

/* Figures from which an error of the positions could be inferred. */
static void judge_figures(hk_loop *loop, hk_judgement *j, const hk_summary *s) {
  bool explicit_fixed = !(loop->step->method->flags & (HK_ADAPTIVE | HK_IMPLICIT));
  if (explicit_fixed && !loop->step->growth_expected && loop->record->dt_beyond > 0) {
    hk_remedy_need(j, loop->record->dt_beyond / loop->step->dt_limit, 1);
    add_reason(j, "the step %g s is above the stable limit, %g s at its least", loop->record->dt_beyond,
               loop->step->dt_limit);
  }
  judge_energy(j, s, loop->step->method->order);
  double allowed = s->accuracy > 0 ? s->accuracy : unresolved_limit * hk_state_extent(loop->state),
         unresolved = hk_under_resolved_error(j);
  hk_remedy_need(j, unresolved / allowed, 2); /* h^2 times the change of the accelerations */
  if (unresolved > allowed)
    add_reason(j, "the steps do not resolve what swings: a step is off by %.3g m by the change of its accelerations",
               unresolved);
  char passed[256];
  if (hk_passed_by_reason(loop, s->accuracy, passed, sizeof passed)) add_reason(j, "%s", passed);
  hk_remedy_need(j, loop->record->worst_error, loop->step->method->order);
  if (loop->record->worst_error > 1 + 1e-9)
    add_reason(j, "the error estimate was %.3g times the tolerance", loop->record->worst_error);
}

hk_status hk_judge(hk_loop *loop, hk_judgement *j, const hk_asked *asked) {
  hk_summary s;
  hk_by_hand_note(loop);
  hk_summary_take(loop, j, asked, &s);
  *j->reason = 0;
  j->excess = j->shorten = 1;
  if (!j->confirmed) judge_figures(loop, j, &s);
  judge_contact_energy(j, loop->record, &s, loop->step->method->order);
  judge_known_error(loop, j, asked, &s);
  if (loop->record->violation_max > violation_limit)
    add_reason(j, "constraints were violated by %.3g m", loop->record->violation_max);
  char intersections[384];
  if (hk_contacts_reason(loop, intersections, sizeof intersections)) add_reason(j, "%s", intersections);
  hk_status status = check_exact(loop, j, asked);
  j->verdict = *j->reason ? HK_INACCURATE : HK_VERDICT_OK;
  return status;
}
