/* The comparison of a run with other runs of its scene, from which its error is estimated.
 *
 * 1. With half the step: 2n + 1 steps replace the n steps of a frame, so that a periodic load cannot be in phase with
 *    the steps of both runs; an adaptive method gets a tenth of the tolerance and at most half its longest step. The
 *    start is perturbed by 1e-14 of the extent, which shows motion that no method can predict.
 * 2. With an independent method that controls its error (reference.c), where that costs little. Its distance is the
 *    error, whatever the two runs of one method have in common.
 * 3. Without a reference, the distance D to half the step bounds the error by 2 D from order 1 on. Where D is below the
 *    accuracy and 2 D is not, a third run with a quarter of the step shows the order, and the error is D / (1 - ratio)
 *    of the two distances (Richardson). Where figures of the run contradict a small D, the reference is tried at a
 *    higher cost.
 *
 * All are compared at all frames (hk_trajectory), or at the end where the scene says so. */
#include "core/run/run.h"

#include <stdlib.h>
#include <string.h>

enum { FINER_REFINEMENT = 16 };
static const double perturbation = 1e-14, margin = 2, rounding = 1e-9,
                    visible = 0.1, /* of the motion, or of the kinetic energy, as in judge/verdict.c */
    no_order = 0.75,               /* the ratio of two distances above which no order is seen */
    resolved = 1,                  /* h w of swings that steps h resolve */
    stricter = 1e-3,               /* the tolerance of a second reference, relative to the first */
    reserve = 0.97;                /* what a reference leaves of the accuracy, for its own error */

/* What is asked of a run, and what comparisons have found. Errors are relative to what is asked: the largest of that of
 * the positions and those of the channels. */
typedef struct comparison {
  const hk_reopen *reopen;
  const hk_run_options *first;
  hk_run *whole;
  hk_summary *summary;
  double accuracy; /* m; NAN: not asked for positions, but for channels */
  double *channel; /* the accuracy that each channel is to have */
  hk_rerun half;
  bool compared;     /* there is half */
  bool referred;     /* the error is that to a reference */
  bool varies;       /* a function of time changes between the steps, which steps of any method may skip */
  double error;      /* relative; NAN: not known */
  double position;   /* m */
  hk_distance worst; /* the distance it is from */
  char how[160];
} comparison;

static hk_distance distance(const comparison *c, const hk_rerun *other) {
  return hk_trajectory_distance(&c->whole->judgement.trajectory, &other->trajectory, c->whole->scene, c->channel,
                                c->whole->asked.at_end);
}

static double relative(const comparison *c, const hk_distance *d) {
  double position = c->accuracy > 0 ? d->position / c->accuracy : isnan(d->position) ? NAN : 0;
  return isnan(position) ? NAN : fmax(position, d->channel);
}

/* ---- the runs ---- */

/* The same dt with the refined division of frames, finer still where a function of time changes between the steps. An
 * adaptive method gets half of a dt that was given, which it may use as a fixed step. */
static hk_run_options refined(const comparison *c, size_t refine) {
  hk_run *whole = c->whole;
  hk_run_options o = *c->first;
  double given = isnan(o.dt) ? whole->scene->dt : o.dt;
  bool adaptive = whole->step.method->flags & HK_ADAPTIVE;
  o.dt = adaptive ? given / (2 * (double)refine) : given;
  o.tol = whole->dynamics.system.tol / pow(10, (double)refine);
  o.refine = refine;
  o.dt_most = whole->record.dt_max / (2 * (double)refine);
  o.step_limit *= 4 * refine;
  o.perturb = perturbation;
  o.perturb_seed = refine;
  o.compare = HK_COMPARE_ALWAYS;
  o.no_output = true;
  o.progress = -1;
  return o;
}

static hk_status take_half(comparison *c, hk_error *error) {
  hk_run_options o = refined(c, c->varies ? FINER_REFINEMENT : 1);
  hk_status status = hk_rerun_take(c->reopen, &o, c->whole, &c->half, error);
  c->compared = status == HK_OK;
  return status;
}

/* The accuracy relative to the scale of what it is for, the strictest. */
static double strictest(const comparison *c) {
  const hk_state *s = &c->whole->state;
  double scale = hk_state_extent(s) + hk_trajectory_motion(&c->whole->judgement.trajectory);
  double least = c->accuracy > 0 ? c->accuracy / scale : INFINITY;
  for (size_t k = 0; k < c->whole->scene->channels; k++) {
    double most = 0;
    const double *y = s->X + (6 + s->channel[k].offset) * s->model.n;
    for (size_t e = 0; e < s->channel[k].size * s->model.n; e++) most = fmax(most, fabs(y[e]));
    if (c->channel[k] < most) least = fmin(least, c->channel[k] / most);
  }
  return least;
}

/* A reference that has passed by a force of short range is none. */
static void use_reference(comparison *c, const hk_rerun *reference) {
  hk_distance d = distance(c, reference);
  if (isnan(d.position) || reference->passed_by > c->accuracy) return;
  c->referred = true;
  c->worst = d;
  c->error = relative(c, &d) / reserve;
  c->position = d.position;
  snprintf(c->how, sizeof c->how, "compared with %s at a tolerance of %.1g and a start off by 1e-14 of the extent",
           reference->method, reference->tol);
}

static void take_reference(comparison *c, hk_effort effort) {
  hk_reference want = {strictest(c), 0, effort};
  hk_rerun reference;
  if (c->referred || c->varies || !hk_reference_take(c->reopen, c->first, c->whole, &want, &reference)) return;
  use_reference(c, &reference);
  hk_trajectory_free(&reference.trajectory);
}

/* Where a run agrees with half its step and not with the reference, one of them is wrong: swings that the run damps, or
 * a reference that passed by what the run saw, or whose errors grow. A stricter one with steps no longer than the run's
 * decides. */
static void settle_contradiction(comparison *c) {
  hk_distance d = distance(c, &c->half);
  hk_reference want = {strictest(c) * stricter, c->whole->record.dt_max, HK_EFFORT_LARGE};
  hk_rerun reference;
  if (!c->referred || c->error <= 1 || !(margin * relative(c, &d) <= 1)) return;
  if (!hk_reference_take(c->reopen, c->first, c->whole, &want, &reference)) return;
  use_reference(c, &reference);
  hk_trajectory_free(&reference.trajectory);
}

/* The error by half the step, by a method of order p or, where it has jumps and kinks to step over, order 1. */
static void estimate_by_half(comparison *c) {
  hk_distance d = distance(c, &c->half);
  c->worst = d;
  c->error = margin * relative(c, &d);
  c->position = margin * d.position;
  snprintf(c->how, sizeof c->how, "compared with half the step and a start off by 1e-14 of the extent");
}

/* The error by the distances to a half and a quarter of the step. */
static void estimate_by_order(comparison *c) {
  hk_rerun quarter;
  hk_error error = {0};
  hk_run_options o = refined(c, 2);
  if (hk_rerun_take(c->reopen, &o, c->whole, &quarter, &error) == HK_OK) {
    hk_distance first = distance(c, &c->half), whole = distance(c, &quarter);
    hk_distance second = hk_trajectory_distance(&c->half.trajectory, &quarter.trajectory, c->whole->scene, c->channel,
                                                c->whole->asked.at_end);
    double ratio = relative(c, &second) / relative(c, &first);
    if (ratio < no_order) {
      c->worst = whole;
      c->error = relative(c, &whole) / (1 - ratio * ratio) / reserve;
      c->position = whole.position / (1 - ratio * ratio);
      snprintf(c->how, sizeof c->how, "compared with a half and a quarter of the step");
    }
  }
  hk_trajectory_free(&quarter.trajectory);
}

/* ---- doubts of two runs that agree ---- */

/* The energy defect in J of a step of length 0, extrapolated from the two runs with an error proportional to
 * step^order. */
static double converged_defect_of_order(const hk_summary *s, const hk_rerun *second, int order) {
  double error_ratio = pow(second->step, order);
  return fabs((second->energy_defect - error_ratio * hk_energy_defect(s)) / (1 - error_ratio));
}

static double converged_defect(const hk_run *run, const hk_summary *s, const hk_rerun *second) {
  return fmin(converged_defect_of_order(s, second, 1), converged_defect_of_order(s, second, run->step.method->order));
}

/* The work of damping that acts within less than a step is integrated inaccurately, even where the motion is accurate.
 * Where the positions of both runs agree, and the energy defect is a part of the work done and vanishes with the step,
 * the defect is no evidence against the positions. */
static bool energy_converges(const comparison *c) {
  const hk_summary *s = c->summary;
  bool vanishes =
      fmin(converged_defect(c->whole, s, &c->half), fabs(c->half.energy_defect)) < visible * c->half.kinetic;
  return c->error <= 1 && fabs(hk_energy_defect(s)) < 2 * fabs(s->energy_work) && vanishes;
}

static double free_mass(const hk_run *run) {
  double sum = 0;
  for (size_t i = 0; i < run->state.model.n; i++) sum += run->state.inverse_mass[i] > 0 ? run->state.mass[i] : 0;
  return sum;
}

/* Whether numerical damping alone halves the amplitude of the fastest mode within the run. Methods that estimate their
 * errors are excluded: their error estimates include this damping. */
static bool damps_fastest_mode(const hk_run *run, const hk_summary *s, const hk_spectrum *spectrum) {
  const hk_integrator *m = run->step.method;
  double h = s->dt_max, w = spectrum->w_max, g = hk_spectrum_floor(spectrum, w);
  if (run->record.worst_error > 0 || !m->amplification || !(w > 0)) return false;
  return (double)s->steps * (log(m->amplification(run->step.parameters, h * w, h * g)) + fmin(h * g / 2, h * w)) <
         log(0.5);
}

/* An energy defect that such a method keeps with a step of length 0 was the energy of oscillations that both runs have
 * damped, so their positions agree although the oscillations are lost. The result is the displacement in m (RMS) of the
 * particles by the end of the run if this energy were kinetic. */
static double lost_energy_displacement(const hk_run *run, const hk_summary *s, const hk_rerun *second) {
  double defect = converged_defect(run, s, second);
  double energy = fabs(s->energy_first) + fabs(s->energy_last) + s->kinetic_max;
  if (isnan(defect) || defect < rounding * energy || fabs(s->energy_work) > 0.5 * defect) return 0;
  return damps_fastest_mode(run, s, &second->spectrum) ? sqrt(2 * defect / free_mass(run)) * s->t : 0;
}

/* ---- the verdict ---- */

static void add_reason(hk_summary *s, const char *format, ...) HK_PRINTF(2, 3);

static void add_reason(hk_summary *s, const char *format, ...) {
  size_t used = strlen(s->reason), room = sizeof s->reason;
  va_list arguments;
  if (used && used + 2 < room) used += (size_t)snprintf(s->reason + used, room - used, "; ");
  va_start(arguments, format);
  vsnprintf(s->reason + used, room - used, format, arguments);
  va_end(arguments);
  *s->checked = 0;
  s->verdict = HK_INACCURATE;
  s->verdict_name = hk_verdict_name(s->verdict);
}

static void judge_error(const comparison *c, hk_summary *s) {
  bool asked = s->accuracies > 0;
  const char *channel = c->worst.position / c->accuracy > c->worst.channel ? NULL : c->worst.channel_name;
  if (isnan(c->error)) {
    if (asked) add_reason(s, "the accuracy asked for, %g m, could not be checked", s->accuracy);
  } else if (c->error > 1 && channel)
    add_reason(s, "the error of the channel '%s' is about %.3g times the accuracy asked for it (%s)", channel, c->error,
               c->how);
  else if (c->error > 1 && asked)
    add_reason(s, "the error is about %.3g m at t = %.4g s, and the accuracy asked for, %g m, is not reached (%s)",
               c->position, c->worst.t, s->accuracy, c->how);
  else if (c->error > 1)
    add_reason(s, "the error is about %.3g m at t = %.4g s, more than a tenth of the motion (%s)", c->position,
               c->worst.t, c->how);
}

static void judge_doubts(const comparison *c, hk_summary *s) {
  double displacement = c->referred || !c->compared ? 0 : lost_energy_displacement(c->whole, s, &c->half);
  if (displacement > s->accuracy)
    add_reason(s,
               "the steps damp fast swings, whose energy is missing with half the step, too: as a speed it would have "
               "taken the particles %.3g m by the end, above the accuracy asked for, %g m",
               displacement, s->accuracy);
  if (!c->first->ignore_exact && s->accuracy > 0 && s->exact_error > s->accuracy)
    add_reason(s, "the error of %.3g m is above the accuracy asked for, %g m", s->exact_error, s->accuracy);
}

static void describe(const comparison *c, hk_summary *s) {
  if (s->verdict != HK_VERDICT_OK || isnan(c->error)) return;
  if (s->accuracy > 0)
    hk_checked_add(s, ", ", "error about %.2g m, asked %g m (%s)", c->position, s->accuracy, c->how);
  else if (s->accuracies > 0)
    hk_checked_add(s, ", ", "channels within %.2g of the accuracy asked for (%s)", c->error, c->how);
  else
    hk_checked_add(s, ", ", "error about %.2g m (%s); accuracy not asked for", c->position, c->how);
}

/* Judges the run with what is known so far; false: there are doubts. */
static bool judge(comparison *c) {
  hk_summary *s = c->summary;
  double difference = s->verify_difference, wall = s->check_wall_s;
  c->whole->judgement.confirmed = c->referred && c->error <= 1;
  c->whole->judgement.energy_converges = c->compared && energy_converges(c);
  hk_judge(&c->whole->loop, &c->whole->judgement, &c->whole->asked);
  hk_run_summary(c->whole, s);
  s->verify_difference = difference;
  s->check_wall_s = wall;
  s->error_estimate = c->position;
  if (s->accuracies > (s->accuracy > 0)) s->channel_error = c->worst.channel;
  judge_error(c, s);
  judge_doubts(c, s);
  describe(c, s);
  return s->verdict == HK_VERDICT_OK;
}

/* Whether the method may have damped swings that it does not resolve, so that no run with longer steps shows them. */
static bool may_hide_swings(const comparison *c) {
  const hk_run *run = c->whole;
  return run->step.method->flags & HK_IMPLICIT && run->record.dt_max * c->half.spectrum.w_reached > resolved;
}

/* Where an accuracy was asked for. */
static void judge_accuracy(comparison *c) {
  take_reference(c, HK_EFFORT_SMALL);
  if (!c->referred && may_hide_swings(c)) take_reference(c, HK_EFFORT_MEDIUM);
  settle_contradiction(c);
  if (!c->referred) estimate_by_half(c);
  bool between = !c->referred && c->error > 1 && c->error <= margin, fine = judge(c);
  if (fine || c->referred || !(c->error <= margin)) return;
  take_reference(c, HK_EFFORT_LARGE); /* in doubt */
  if (!c->referred && between) estimate_by_order(c);
  judge(c);
}

/* Where none was: half the step is taken where it could defend the run. */
static void judge_motion(comparison *c) {
  hk_error error = {0};
  take_reference(c, HK_EFFORT_SMALL);
  if (!c->referred) return;
  if (c->error > 1 && !c->compared) take_half(c, &error);
  if (c->compared) settle_contradiction(c);
  judge(c);
}

/* Where nothing is asked, an error of a tenth of the motion is visible, as in judge/verdict.c. */
static hk_status set_accuracies(comparison *c, hk_error *error) {
  const hk_scene *scene = c->whole->scene;
  const hk_trajectory *own = &c->whole->judgement.trajectory;
  bool asked = c->summary->accuracies > 0;
  double moved = visible * hk_trajectory_motion(own) + rounding * hk_state_extent(&c->whole->state);
  c->accuracy = c->summary->accuracy > 0 ? c->summary->accuracy : asked ? NAN : moved;
  c->channel = calloc(scene->channels + 1, sizeof *c->channel);
  if (!c->channel) return hk_error_set(error, HK_NO_MEMORY, "no memory for the accuracies of the channels");
  for (size_t k = 0; k < scene->channels; k++) {
    double given = scene->channel[k].accuracy, changed = visible * hk_trajectory_channel_change(own, scene, k);
    c->channel[k] = given > 0 ? given : changed > 0 ? changed : INFINITY;
  }
  return HK_OK;
}

hk_status hk_verify(const hk_reopen *reopen, const hk_run_options *first, bool half, hk_run *whole, hk_summary *s,
                    hk_error *error) {
  comparison c = {.reopen = reopen, .first = first, .whole = whole, .summary = s, .error = NAN, .position = NAN};
  bool judged = s->verdict == HK_VERDICT_OK || s->verdict == HK_INACCURATE, asked = s->accuracies > 0;
  double begin = hk_clock();
  hk_status status = hk_trajectory_note(&whole->judgement.trajectory, &whole->state, whole->record.frames, true, error);
  if (status == HK_OK) status = set_accuracies(&c, error);
  c.varies = hk_varies_between_steps(&whole->loop);
  if (status == HK_OK && (half || asked)) status = take_half(&c, error);
  s->verify_difference = c.compared ? distance(&c, &c.half).position : NAN;
  if (judged && asked && c.compared)
    judge_accuracy(&c);
  else if (judged && asked)
    judge(&c);
  else if (judged && status == HK_OK && whole->judgement.compared)
    judge_motion(&c);
  s->check_wall_s = hk_clock() - begin;
  hk_trajectory_free(&c.half.trajectory);
  free(c.channel);
  return status;
}
