/* The words behind the verdict ok: what was measured of this run, what was not checked, and how to ask for it. */
#include "core/judge/judge.h"
#include "core/text/text.h"

#include <stdio.h>
#include <string.h>

void hk_checked_add(hk_summary *s, const char *separator, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  hk_text_append(s->checked, sizeof s->checked, separator, format, arguments);
  va_end(arguments);
}

double hk_energy_rounding(const hk_summary *s) {
  return 1e-11 * (fabs(s->energy_first) + fabs(s->energy_last) + s->kinetic_max) + s->kinetic_rounding;
}

static const double balanced = 0.1; /* as in verdict.c */

static void describe_energy(hk_summary *s) {
  if (fabs(s->energy_drift) * s->kinetic_max <= hk_energy_rounding(s))
    hk_checked_add(s, ", ", "energy balanced to its rounding");
  else if (fabs(s->energy_drift) > balanced)
    hk_checked_add(s, ", ", "energy off by %.2g %% of the largest kinetic energy, which the positions do not show",
                   100 * fabs(s->energy_drift));
  else if (!isnan(s->energy_drift))
    hk_checked_add(s, ", ", "energy balanced to %.2g %% of the largest kinetic energy", 100 * fabs(s->energy_drift));
  else if (s->kinetic_max > 0)
    hk_checked_add(s, ", ", "energy balance not known");
}

static void describe_stability(const hk_loop *loop, hk_summary *s) {
  if (loop->step->growth_expected)
    hk_checked_add(s, ", ", "not stable at any step");
  else if (loop->record->dt_beyond > 0)
    hk_checked_add(s, ", ", "with steps above the stable limit, which the positions do not show");
  else
    hk_checked_add(s, ", ", "stable");
}

/* An accuracy that is worth asking for: the power of ten nearest to a thousandth of the scene's extent. */
static double worthwhile(const hk_loop *loop) { return pow(10, round(log10(hk_state_extent(loop->state)) - 3)); }

void hk_checked_describe(const hk_loop *loop, const hk_judgement *j, const hk_asked *asked, hk_summary *s) {
  unsigned flags = loop->step->method->flags;
  *s->checked = 0;
  if (!(flags & (HK_ADAPTIVE | HK_IMPLICIT)) && isfinite(s->dt_limit)) describe_stability(loop, s);
  if (flags & HK_ADAPTIVE && loop->record->worst_error > 0) hk_checked_add(s, ", ", "each step within its tolerance");
  describe_energy(s);
  if (loop->record->by_hand)
    hk_checked_add(s, ", ", "moved by hand (work %.3g J), which no other run repeats: compared with none",
                   s->hand_work);
  if (loop->record->contact_frames) hk_checked_add(s, ", ", "no surfaces intersect at any frame");
  if (!(asked->accuracy > 0) && !j->confirmed && !loop->record->by_hand)
    hk_checked_add(s, "; ", "accuracy not asked for: --accuracy %g would", worthwhile(loop));
}
