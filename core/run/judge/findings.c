/* The words of a verdict: for each finding a clause of the reason; of a run that is ok what was measured, what was not
 * checked, and how to ask for it. */
#include "core/engine/text/text.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/judge/judge.h"

#include <stdio.h>
#include <string.h>

/* ---- why a run is inaccurate ---- */

typedef struct words {
  const hk_loop *loop;
  const hk_judgement *j;
  hk_summary *s;
} words;

static void add(const words *w, const char *format, ...) HK_PRINTF(2, 3);

static void add(const words *w, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  hk_text_append(w->s->reason, sizeof w->s->reason, "; ", format, arguments);
  va_end(arguments);
}

static void add_energy(const words *w, const hk_finding *f) {
  const hk_summary *s = w->s;
  bool largest = f->fault == HK_ENERGY_OF_LARGEST, grew = s->energy_drift > 0;
  const char *cause = grew                    ? "source"
                      : s->contact_frames > 0 ? "sink (steps lose what impacts within them have, and implicit ones "
                                                "what swings: try a smaller dt)"
                                              : "sink";
  add(w, "the energy %s by %.3g of the %s kinetic energy without a %s", grew ? "grew" : "fell",
      largest ? fabs(s->energy_drift) : f->value / s->kinetic_mean, largest ? "largest" : "mean", cause);
}

static void add_encounter(const words *w, const hk_finding *f) {
  const hk_record *r = w->loop->record;
  add(w,
      "particle %u passes '%s' between two evaluations, before t = %g s, and misses %.3g m/s, which half the step "
      "may miss as well: the particles end about %.3g m off (RMS); try dt below %.2g s",
      r->passed_id, w->loop->plugins->kind[HK_FORCE].item[r->passed_force]->label, r->passed_at, r->passed_most,
      f->value, r->passed_dt);
}

static void add_intersections(const words *w) {
  const hk_record *r = w->loop->record;
  if (r->intersecting > 0)
    add(w, "surfaces intersected at %zu of %zu frames, %zu times, first at t = %.6g s: %s", r->intersecting,
        r->contact_frames, r->contact.intersections, r->intersecting_at, r->contact.first);
  else
    add(w, "%zu of the %zu intersections of the start are left", r->intersections[1], r->intersections[0]);
}

static void add_own_figures(const words *w) {
  for (size_t p = 0; p < w->s->plugins; p++)
    for (size_t k = 0; k < w->s->plugin[p].figures; k++) {
      const hk_own_figure *f = &w->s->plugin[p].figure[k];
      if (hk_above_limit(f))
        add(w, "%s: %s is %.3g%s%s, and %g is the most that is ok%s%s", w->s->plugin[p].label, f->name, f->value,
            *f->unit ? " " : "", f->unit, f->limit, w->s->plugin[p].remedy ? ": " : "",
            w->s->plugin[p].remedy ? w->s->plugin[p].remedy : "");
    }
}

static void add_error(const words *w, const hk_finding *f) {
  const hk_comparisons *c = &w->j->comparisons;
  if (c->channel && c->channel_accuracy > 0)
    add(w, "the error of the channel '%s' is about %.3g, and the accuracy asked for, %g, is not reached (%s)",
        c->channel, f->value * c->channel_accuracy, c->channel_accuracy, c->how);
  else if (c->channel)
    add(w, "the error of the channel '%s' is about %.2g of its change (%s)", c->channel, hk_limit.visible * f->value,
        c->how);
  else if (w->s->accuracy > 0)
    add(w, "the error is about %.3g m at t = %.4g s, and the accuracy asked for, %g m, is not reached (%s)",
        c->position, c->at, w->s->accuracy, c->how);
  else
    add(w, "the error is about %.3g m at t = %.4g s, more than a tenth of the motion (%s)", c->position, c->at, c->how);
  if (hk_damps_as_chosen(w->s))
    add(w, "%s damps what swings faster than %.2g s by half or more in a swing, and faster than %.2g s by the end",
        w->s->integrator, w->s->damps_below, hk_damps_by_now(w->loop));
}

/* What comparisons with other runs showed, or could not. */
static void add_compared(const words *w, const hk_finding *f) {
  const hk_summary *s = w->s;
  const hk_sampling *times = &w->j->comparisons.sampling;
  switch (f->fault) {
  case HK_NOT_CHECKED:
    add(w, s->accuracies > 0 ? "the accuracy asked for could not be checked" : "no memory was left to check the run");
    break;
  case HK_ERROR:
    add_error(w, f);
    break;
  case HK_DAMPED:
    add(w,
        "the steps damp fast swings, whose energy is missing with half the step, too: as a speed it would have taken "
        "the particles %.3g m by the end, above the accuracy asked for, %g m",
        f->value, s->accuracy);
    break;
  case HK_PULSE:
    add(w,
        "%s: %s: %s does something within %.3g s at t = %.6g s, between two evaluations of the run: try a smaller dt, "
        "or --accuracy",
        times->where, times->label, times->name, f->value, times->begin);
    break;
  case HK_BY_HAND:
    add(w,
        "the accuracy asked for could not be checked: the user's hand did work of %.3g J or changed parameters as it "
        "ran, which no other run repeats",
        f->value);
    break;
  default:
    break;
  }
}

/* What the run's own figures show, and else comparisons. */
static void add_finding(const words *w, const hk_finding *f) {
  const hk_summary *s = w->s;
  switch (f->fault) {
  case HK_STEP_UNSTABLE:
    add(w, "the step %g s is above the stable limit, %g s at its least", f->value, s->dt_limit);
    break;
  case HK_ENERGY_NOT_FINITE:
    add(w, "the energy is not finite: %g J at the end", f->value);
    break;
  case HK_ENERGY_OF_LARGEST:
  case HK_ENERGY_OF_MEAN:
    add_energy(w, f);
    break;
  case HK_CONTACT_ENERGY:
    add(w, "contact gave %.3g J, %.3g of the largest kinetic energy, while no surface was driven: try a smaller dt",
        f->value, f->value / s->kinetic_max);
    break;
  case HK_UNRESOLVED:
    add(w, "the steps do not resolve what swings: a step is off by %.3g m by the change of its accelerations",
        f->value);
    break;
  case HK_ENCOUNTER:
    add_encounter(w, f);
    break;
  case HK_ABOVE_TOLERANCE:
    add(w, "the error estimate was %.3g times the tolerance", f->value);
    break;
  case HK_VIOLATION:
    add(w, "constraints were violated by %.3g m", f->value);
    break;
  case HK_INTERSECTIONS:
    add_intersections(w);
    break;
  case HK_OWN_FIGURE:
    add_own_figures(w);
    break;
  case HK_EXACT_FAILED:
    add(w, "the exact solution is not known: %.600s", w->j->exact_cause);
    break;
  case HK_EXACT_VISIBLE:
    add(w, "the error against the exact solution, %.3g m, is more than a tenth of the motion, %.3g m", f->value,
        w->j->exact_motion);
    break;
  case HK_EXACT_ABOVE_ACCURACY:
    add(w, "the error of %.3g m is above the accuracy asked for, %g m", f->value, s->accuracy);
    break;
  default:
    add_compared(w, f);
  }
}

void hk_findings_describe(const hk_loop *loop, const hk_judgement *j, hk_summary *s) {
  const words w = {loop, j, s};
  for (size_t k = 0; k < j->opinion.count; k++) add_finding(&w, &j->opinion.finding[k]);
}

/* ---- what the verdict ok rests on ---- */

static void checked(hk_summary *s, const char *separator, const char *format, ...) HK_PRINTF(3, 4);

static void checked(hk_summary *s, const char *separator, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  hk_text_append(s->checked, sizeof s->checked, separator, format, arguments);
  va_end(arguments);
}

static void describe_energy(const hk_loop *loop, hk_summary *s) {
  if (hk_damps_visibly(s)) {
    checked(s, ", ",
            "energy fell by %.2g %% of the largest kinetic energy: %s damps what swings faster than %.2g s by half or "
            "more in a swing, and faster than %.2g s by the end",
            100 * fabs(s->energy_drift), s->integrator, s->damps_below, hk_damps_by_now(loop));
    return;
  }
  if (fabs(s->energy_drift) * s->kinetic_max <= hk_energy_rounding(s))
    checked(s, ", ", "energy balanced to its rounding");
  else if (fabs(s->energy_drift) > hk_limit.visible)
    checked(s, ", ", "energy off by %.2g %% of the largest kinetic energy, which the positions do not show",
            100 * fabs(s->energy_drift));
  else if (!isnan(s->energy_drift))
    checked(s, ", ", "energy balanced to %.2g %% of the largest kinetic energy", 100 * fabs(s->energy_drift));
  else if (s->kinetic_max > 0)
    checked(s, ", ", "energy balance not known");
}

static void describe_stability(const hk_loop *loop, hk_summary *s) {
  if (hk_step_choice_of(loop)->growth_expected)
    checked(s, ", ", "not stable at any step");
  else if (loop->record->dt_beyond > 0)
    checked(s, ", ", "with steps above the stable limit, which the positions do not show");
  else
    checked(s, ", ", "stable");
}

static void describe_error(const hk_comparisons *c, hk_summary *s) {
  if (s->accuracy > 0)
    checked(s, ", ", "error about %.2g m, asked %g m (%s)", c->position, s->accuracy, c->how);
  else if (s->accuracies > 0)
    checked(s, ", ", "channels within %.2g of the accuracy asked for (%s)", c->error, c->how);
  else
    checked(s, ", ", "error about %.2g m (%s); accuracy not asked for", c->position, c->how);
}

/* What was assumed of functions of time: no samples can exclude a pulse between them. */
static void describe_functions(const hk_sampling *f, hk_summary *s) {
  if (f->assumed > 0)
    checked(s, "; ", "functions of time are assumed to do nothing within less than %.2g s%s", f->assumed,
            f->assumed <= f->declared && isfinite(f->declared) ? ", as declared" : "");
}

/* An accuracy that is worth asking for: the power of ten nearest to a thousandth of the scene's extent. */
static double worthwhile(const hk_loop *loop) { return pow(10, round(log10(hk_state_extent(loop->state)) - 3)); }

void hk_checked_describe(const hk_loop *loop, const hk_judgement *j, hk_summary *s) {
  unsigned flags = loop->method->flags;
  const hk_comparisons *c = &j->comparisons;
  if (!(flags & (HK_ADAPTIVE | HK_IMPLICIT)) && isfinite(s->dt_limit)) describe_stability(loop, s);
  if (flags & HK_ADAPTIVE && loop->record->worst_error > 0) checked(s, ", ", "each step within its tolerance");
  describe_energy(loop, s);
  if (loop->record->by_hand && s->hand_work == 0)
    checked(s, ", ", "its parameters were changed while it ran, which no other run repeats: compared with none");
  else if (loop->record->by_hand)
    checked(s, ", ", "moved by hand (work %.3g J), which no other run repeats: compared with none", s->hand_work);
  if (loop->record->contact_frames) checked(s, ", ", "no surfaces intersect at any frame");
  double gap = loop->record->contact.closest;
  if (loop->record->contact_frames && isfinite(gap))
    checked(s, ", ", "the nearest %s %.3g m", gap < 0 ? "within their thickness by" : "at a gap of", fabs(gap));
  bool known = hk_confirmed(c) || (c->tried && !isnan(c->error));
  if (!(s->accuracy > 0) && !known && !loop->record->by_hand)
    checked(s, "; ", "accuracy not asked for: --accuracy %g would", worthwhile(loop));
  if (c->tried && !isnan(c->error)) describe_error(c, s);
  describe_functions(&c->sampling, s);
}
