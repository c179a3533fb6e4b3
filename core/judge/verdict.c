/* The verdict of a run that came to its end, by what it measured. */
#include "core/judge/judge.h"

#include <stdio.h>
#include <string.h>

/* Above these a finished run is called inaccurate. Energy that came from nowhere or went there, beyond the work of pins
 * and damping: a tenth of the largest kinetic energy is visible in any picture, while a symplectic method at 0.9 of its
 * limit oscillates by less on cloth. */
static const double energy_limit = 0.1, visible = 0.1, violation_limit = 1e-6,
                    unresolved_limit = 0.1, /* of the extent, in a step */
    energy_rounding = 1e-11;                /* of the energy held: a scene at rest has a kinetic energy of rounding */

static void add_reason(hk_judgement *j, const char *format, ...) {
  size_t used = strlen(j->reason);
  va_list arguments;
  if (used && used + 2 < sizeof j->reason) used += (size_t)snprintf(j->reason + used, sizeof j->reason - used, "; ");
  va_start(arguments, format);
  vsnprintf(j->reason + used, sizeof j->reason - used, format, arguments);
  va_end(arguments);
}

/* Where the exact solution is known and no accuracy is asked for, an error of a tenth of the motion is visible. */
static void judge_known_error(hk_loop *loop, hk_judgement *j, const hk_asked *asked, const hk_summary *s) {
  if (asked->ignore_exact || s->accuracy > 0 || isnan(s->exact_error)) return;
  double motion = hk_figures_exact_motion(loop, loop->state->t);
  if (s->exact_error > visible * motion)
    add_reason(j, "the error against the exact solution, %.3g m, is more than a tenth of the motion, %.3g m",
               s->exact_error, motion);
}

void hk_judge(hk_loop *loop, hk_judgement *j, const hk_asked *asked) {
  hk_summary s;
  hk_summary_take(loop, j, asked, &s);
  *j->reason = 0;
  bool explicit_fixed = !(loop->step->method->flags & (HK_ADAPTIVE | HK_IMPLICIT));
  if (explicit_fixed && !loop->step->growth_expected && loop->record->dt_beyond > 0)
    add_reason(j, "the step %g s is above the stable limit, %g s at its least", loop->record->dt_beyond,
               loop->step->dt_limit);
  double gone = fabs(s.energy_drift) * s.kinetic_max, held = fabs(s.energy_first) + fabs(s.energy_last);
  if (fabs(s.energy_drift) > energy_limit && gone > energy_rounding * held && !j->energy_converges)
    add_reason(j, "the energy %s by %.3g of the largest kinetic energy without a %s",
               s.energy_drift > 0 ? "grew" : "fell", fabs(s.energy_drift), s.energy_drift > 0 ? "source" : "sink");
  double allowed = s.accuracy > 0 ? s.accuracy : unresolved_limit * hk_state_extent(loop->state),
         unresolved = hk_under_resolved_error(j);
  if (unresolved > allowed)
    add_reason(j, "the steps do not resolve what swings: a step is off by %.3g m by the change of its accelerations",
               unresolved);
  judge_known_error(loop, j, asked, &s);
  if (loop->record->worst_error > 1 + 1e-9)
    add_reason(j, "the error estimate was %.3g times the tolerance", loop->record->worst_error);
  if (loop->record->violation_max > violation_limit)
    add_reason(j, "constraints were violated by %.3g m", loop->record->violation_max);
  j->verdict = *j->reason ? HK_INACCURATE : HK_VERDICT_OK;
}
