/* The runs with which a run is compared: with half the step, a quarter of it, and with an independent method. */
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/run/comparison.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static const double margin = 2, no_order = 0.75, /* the ratio of two distances above which no order is seen */
    order_part = 0.125,     /* of the run that the quarter of the step is taken for: half the run's cost */
    beginning_part = 0.125, /* of the run, for a reference that cannot be had for all of it */
    seen = 1e-4,            /* of the accuracy: a distance that shows an order */
    stricter = 1e-3,        /* the tolerance of a second reference, relative to the first */
    drift_margin = 4,       /* errors that add up grow in proportion to time, and some with its square */
    reserve = 0.98;         /* what an estimate leaves of the accuracy, for its own error */

/* The first frame is late where it is beyond this part of the run. */
static const double sparse = 1.0 / 64;

/* Calls of functions of time: 60 ms where an accuracy is asked for, and 20 ms else. */
static const size_t calls_asked = 200000, calls_unasked = 60000;

/* A piece of more than so many shortest times is more than a pulse; and that part of the shortest time is resolved. */
static const double pulse_lengths = 4;

/* Steps in each piece of a pulse, 2 refine + 1. */
enum { PULSE_REFINEMENT = 2, VIBRATION_REFINEMENT = 16 };

static double begin_of(const hk_comparison *c) { return c->whole->asked.at_end ? c->whole->state.t : 0; }

static hk_distance distance(const hk_comparison *c, const hk_comparison_run *a, const hk_comparison_run *b,
                            double until) {
  const hk_trajectory *first = a ? &a->trajectory : &c->whole->judgement.trajectory;
  return hk_trajectory_distance(first, &b->trajectory, c->whole->scene, c->channel, begin_of(c), until);
}

static double relative(const hk_comparison *c, const hk_distance *d) {
  double position = c->accuracy > 0 ? d->position / c->accuracy : isnan(d->position) ? NAN : 0;
  return isnan(position) ? NAN : fmax(position, d->channel);
}

/* ---- what is asked ---- */

static double own_motion(const hk_comparison *c) {
  return fmax(hk_trajectory_motion(&c->whole->judgement.trajectory), c->whole->record.reach);
}

/* Where nothing is asked, an error of a tenth of the motion is visible. The motion is the
 * smaller one of the two runs: one that explodes is not its own measure. */
static void measure_by(hk_comparison *c, const hk_trajectory *other, double reach) {
  const hk_scene *scene = c->whole->scene;
  const hk_trajectory *own = &c->whole->judgement.trajectory;
  double motion = fmin(own_motion(c), fmax(hk_trajectory_motion(other), reach));
  if (c->summary->accuracies == 0)
    c->accuracy = hk_limit.visible * motion + hk_limit.rounding * hk_state_extent(&c->whole->state);
  for (size_t k = 0; k < scene->particles.channels; k++) {
    double first = hk_trajectory_channel_change(own, scene, k), second = hk_trajectory_channel_change(other, scene, k);
    double change = fmax(fmin(first, second), hk_limit.rounding * fmax(first, second));
    if (!(scene->particles.channel[k].accuracy > 0)) c->channel[k] = change > 0 ? hk_limit.visible * change : INFINITY;
  }
}

static hk_status set_accuracies(hk_comparison *c, hk_error *error) {
  const hk_scene *scene = c->whole->scene;
  c->accuracy = c->summary->accuracy > 0 ? c->summary->accuracy : NAN;
  c->channel = calloc(scene->particles.channels + 1, sizeof *c->channel);
  if (!c->channel) return hk_error_set(error, HK_NO_MEMORY, "no memory for the accuracies of the channels");
  for (size_t k = 0; k < scene->particles.channels; k++) c->channel[k] = scene->particles.channel[k].accuracy;
  measure_by(c, &c->whole->judgement.trajectory, c->whole->record.reach);
  return HK_OK;
}

hk_status hk_comparison_open(hk_comparison *c, hk_error *error) {
  hk_run *run = c->whole;
  hk_status status = hk_trajectory_note(&run->judgement.trajectory, &run->state, run->record.frames, true, error);
  if (status == HK_OK) status = set_accuracies(c, error);
  if (status != HK_OK || !run->judgement.keeps_trajectory) return status;
  c->sampling = hk_under_sampled(&run->loop, &run->judgement.trajectory,
                                 c->summary->accuracies > 0 ? calls_asked : calls_unasked);
  c->cuts = hk_sampling_cuts(&c->sampling, c->cut, HK_MOST_CUTS);
  return HK_OK;
}

void hk_comparison_close(hk_comparison *c) {
  hk_trajectory_free(&c->half.trajectory);
  free(c->channel);
}

/* The accuracy relative to the scale of what it is for, the strictest. */
static double strictest(const hk_comparison *c) {
  const hk_state *s = &c->whole->state;
  double scale = hk_state_extent(s) + own_motion(c);
  double least = c->accuracy > 0 ? c->accuracy / scale : INFINITY;
  for (size_t k = 0; k < c->whole->scene->particles.channels; k++) {
    double most = 0;
    const double *y = s->X + (6 + s->channel[k].offset) * s->model.n;
    for (size_t e = 0; e < s->channel[k].size * s->model.n; e++) most = fmax(most, fabs(y[e]));
    if (c->channel[k] < most) least = fmin(least, c->channel[k] / most);
  }
  return least;
}

/* ---- the runs ---- */

/* Whether a function goes up and down all the time, or more often than there are cuts, so that cuts are no help. */
static bool vibrates(const hk_comparison *c) {
  const hk_sampling *f = &c->sampling;
  bool any = f->more;
  for (size_t k = 0; k < f->pieces; k++) any = any || f->piece[k][1] - f->piece[k][0] > pulse_lengths * f->shortest;
  return any;
}

/* The same dt with the refined division of frames, and steps that end where a function of time changes. An adaptive
 * method gets half of a dt that was given, which it may use as a fixed step. */
static hk_run_options refined(const hk_comparison *c, size_t refine) {
  hk_run *whole = c->whole;
  hk_run_options o = hk_comparison_run_options(c->first, refine);
  double given = isnan(o.dt) ? whole->scene->dt : o.dt;
  bool adaptive = whole->loop.method->flags & HK_ADAPTIVE;
  o.dt = adaptive ? given / (2 * (double)refine) : given;
  o.tol = whole->dynamics.system.tol / (refine > 1 ? 100 : 10);
  o.refine = refine;
  o.dt_most = whole->record.dt_max / (2 * (double)refine);
  o.step_limit *= 4 * refine;
  o.cut = c->cut;
  o.cuts = c->cuts;
  return o;
}

hk_status hk_comparison_take_half(hk_comparison *c, hk_error *error) {
  size_t pulses = vibrates(c) ? VIBRATION_REFINEMENT : PULSE_REFINEMENT;
  hk_run_options o = refined(c, c->sampling.varies ? pulses : 1);
  hk_status status = hk_comparison_run_take(c->loader, &o, c->whole, c->whole->state.t, &c->half, error);
  c->compared = status == HK_OK;
  if (c->compared) measure_by(c, &c->half.trajectory, c->half.reach);
  return status;
}

/* How fast the error falls from the step to half of it. */
static double order_of(const hk_comparison *c, double error, double error_of_half) {
  return c->compared && error > 0 && error_of_half > 0 ? log(error / error_of_half) / -log(c->half.step) : NAN;
}

/* A reference that has passed by a force of short range is none. */
static bool use_reference(hk_comparison *c, const hk_comparison_run *reference) {
  measure_by(c, &reference->trajectory, reference->reach);
  hk_distance d = distance(c, NULL, reference, INFINITY);
  if (isnan(d.position) || reference->missed > c->accuracy) return false;
  c->has_reference = true;
  c->worst = d;
  c->error = relative(c, &d) / reference->reserve;
  c->position = d.position;
  if (c->compared) {
    hk_distance half = distance(c, &c->half, reference, INFINITY);
    c->order = order_of(c, relative(c, &d), relative(c, &half));
  }
  snprintf(c->how, sizeof c->how, "compared with %s at a tolerance of %.1g and a start off by %.1g of the extent",
           reference->method, reference->tol, reference->perturbation);
  return true;
}

/* Functions that vibrate limit the steps. */
static bool run_reference(const hk_comparison *c, hk_reference want, hk_comparison_run *reference) {
  if (vibrates(c)) want.dt_most = fmin(want.dt_most, c->sampling.shortest / pulse_lengths);
  hk_run_options o = *c->first;
  o.cut = c->cut;
  o.cuts = c->cuts;
  return hk_reference_take(c->loader, &o, c->whole, &want, reference);
}

static bool take_reference(hk_comparison *c, hk_reference want) {
  hk_comparison_run reference;
  if (!run_reference(c, want, &reference)) return false;
  bool used = use_reference(c, &reference);
  hk_trajectory_free(&reference.trajectory);
  return used;
}

/* 1/s, the largest frequency that is known; of implicit runs, which need none, it is estimated here, since without it
 * hopeless explicit references are tried up to the end of their steps. */
static double frequency(const hk_comparison *c) {
  hk_run *whole = c->whole;
  hk_spectrum found = whole->step->spectrum;
  double known = fmax(c->half.swings, found.w_reached);
  if (known > 0) return known;
  hk_counts counts = whole->dynamics.count;
  hk_status status = hk_spectrum_estimate(&whole->dynamics.system, &found, whole->dynamics.error);
  if (status != HK_OK) hk_error_clear(whole->dynamics.error);
  whole->dynamics.count = counts;
  return status == HK_OK ? found.w_reached : 0;
}

static hk_reference wanted(const hk_comparison *c, hk_effort effort) {
  return (hk_reference){.relative = strictest(c), .dt_most = INFINITY, .frequency = frequency(c), .effort = effort};
}

void hk_comparison_reference(hk_comparison *c, hk_effort effort, bool coarse) {
  if (c->has_reference) return;
  hk_reference want = wanted(c, effort);
  want.coarse = coarse;
  take_reference(c, want);
}

/* Frames are the moments that can be compared. Where even the first one is too late for a reference, nothing says that
 * the phase is not lost; with impacts or births there is no reference of any part. */
static bool frames_are_sparse(const hk_comparison *c) {
  const hk_plugins *plugins = &c->whole->plugins;
  double first = hk_trajectory_time(&c->whole->judgement.trajectory, DBL_EPSILON);
  bool possible = !plugins->kind[HK_CORRECTOR].count && !plugins->kind[HK_SOURCE].count;
  return possible && first > sparse * c->whole->state.t;
}

static hk_reference beginning(const hk_comparison *c, hk_effort effort) {
  hk_reference want = wanted(c, effort);
  want.coarse = true;
  want.beginning = beginning_part;
  return want;
}

/* The distance from a reference of the beginning, up to its end, *until. */
static hk_distance distance_at_first(hk_comparison *c, const hk_comparison_run *reference, double *until) {
  const hk_trajectory *own = &c->whole->judgement.trajectory;
  *until = hk_trajectory_time(&reference->trajectory, 1);
  return hk_trajectory_distance(own, &reference->trajectory, c->whole->scene, c->channel, 0, *until);
}

bool hk_comparison_may_drift(hk_comparison *c, hk_effort effort) {
  hk_comparison_run first;
  double until;
  if (!run_reference(c, beginning(c, effort), &first)) return frames_are_sparse(c);
  hk_distance d = distance_at_first(c, &first, &until);
  hk_trajectory_free(&first.trajectory);
  return until > 0 && drift_margin * c->whole->state.t / until * relative(c, &d) > 1;
}

double hk_comparison_difference(const hk_comparison *c) { return distance(c, NULL, &c->half, INFINITY).position; }

bool hk_comparison_agrees(const hk_comparison *c, double times) {
  hk_distance d = distance(c, NULL, &c->half, INFINITY);
  return c->compared && times * relative(c, &d) <= 1;
}

/* One of the two is wrong: swings that the run damps, or a reference that passed by what the run saw, or whose errors
 * grow. The second has steps no longer than the run's; where those are too many, as of a method of high order, one that
 * chooses its steps still shows errors that grew. */
void hk_comparison_tie_break(hk_comparison *c, hk_effort effort) {
  if (!(c->has_reference && c->error > 1 && hk_comparison_agrees(c, margin))) return;
  hk_reference want = {.relative = strictest(c) * stricter,
                       .dt_most = c->whole->record.dt_max,
                       .frequency = c->half.swings,
                       .effort = effort};
  if (take_reference(c, want)) return;
  want.dt_most = INFINITY;
  take_reference(c, want);
}

void hk_comparison_sharpen(hk_comparison *c, hk_effort effort) {
  hk_reference want = wanted(c, effort);
  want.relative *= stricter;
  take_reference(c, want);
}

/* The error of a method of order p or, where it has jumps and kinks to step over, of order 1. */
void hk_comparison_use_half(hk_comparison *c) {
  hk_distance d = distance(c, NULL, &c->half, INFINITY);
  c->worst = d;
  c->error = margin * relative(c, &d);
  c->position = margin * d.position;
  snprintf(c->how, sizeof c->how, "compared with half the step and a start off by 1e-14 of the extent");
}

/* A beginning that agrees proves nothing of what follows: the error is then that by half the step. */
void hk_comparison_use_beginning(hk_comparison *c, hk_effort effort) {
  hk_comparison_run reference;
  double until, decay = c->half.damping * c->whole->state.t / 2; /* of the scene's own swings, by the end, at most */
  if (c->whole->asked.at_end && !(decay < log(2))) return;
  if (!run_reference(c, beginning(c, effort), &reference)) return;
  hk_distance d = distance_at_first(c, &reference, &until);
  double error = relative(c, &d) / reference.reserve;
  if (error > 1 && error > c->error && !(reference.missed > c->accuracy)) {
    c->has_reference = true;
    c->worst = d;
    c->error = error;
    c->position = d.position;
    snprintf(c->how, sizeof c->how,
             "compared up to t = %.3g s with %s at a tolerance of %.1g: the steps lose what half of them lose, too",
             until, reference.method, reference.tol);
  }
  hk_trajectory_free(&reference.trajectory);
}

/* The order is that of the first part of the run, where a quarter of the step is affordable; the distance is that of
 * the whole run. */
bool hk_comparison_use_order(hk_comparison *c) {
  hk_comparison_run quarter;
  hk_error error = {0};
  hk_run_options o = refined(c, 2);
  double until = begin_of(c) > 0 ? c->whole->state.t : hk_trajectory_time(&c->whole->judgement.trajectory, order_part),
         ratio = NAN;
  /* half the step is another part then; and the order of the first part may not be that of the rest */
  if (c->sampling.varies || hk_is_abrupt(&c->whole->loop)) return false;
  if (hk_comparison_run_take(c->loader, &o, c->whole, until, &quarter, &error) == HK_OK) {
    hk_distance first = distance(c, NULL, &c->half, until), second = distance(c, &c->half, &quarter, until);
    if (relative(c, &first) > seen) ratio = relative(c, &second) / relative(c, &first);
  }
  hk_trajectory_free(&quarter.trajectory);
  if (!(ratio < no_order)) return false;
  c->order = order_of(c, 1, ratio);
  ratio = fmax(ratio, pow(c->half.step, c->whole->loop.method->order)); /* no smaller than that of the method */
  c->error /= margin * (1 - ratio) * reserve;
  c->position /= margin * (1 - ratio);
  snprintf(c->how, sizeof c->how, "compared with a half and a quarter of the step");
  return true;
}
