/* Watches the bounds behind the stable step while the scene moves. A full estimate takes some hundred evaluations, and
 * the stiffness may rise long before the next one: edges turn into one direction, a sheet without shear stiffness folds
 * flat, a particle falls into a steep potential. The stiffness and damping that the forces state (stiffness.c) cost
 * only a few evaluations. They are measured at intervals and extrapolated to the next measurement, by the factor by
 * which they rose since the last; the extrapolation is compared with the bounds of the last estimate.
 *
 * Where it exceeds them, the spectrum is either estimated anew, as far as the evaluations so far can pay for it, or
 * raised in proportion, on the assumption that the stated bound is as sharp as at the last estimate. (It is a bound by
 * itself, and sharp in a flat sheet; in a creased one, whose stiffest place is one crease, it may be twice too high.) A
 * raised spectrum gets headroom, so that a scene that stiffens without end raises it some twenty times for each factor
 * of e.
 *
 * Constraints state nothing, but their forces stiffen what they hold as they grow: a chain with a heavy end that falls
 * from the horizontal begins with none, and its light links end as taut strings. Where there are constraints a sample
 * of the stiffness (hk_stiffness_sample) is watched beside what forces state: at the same intervals, and as soon as
 * what they hold moves faster than before, since tension rises with v^2, an impact makes it jump, and what becomes
 * unstable begins to move.
 *
 * The interval between two measurements is halved when the bounds change fast and doubled when they do not, as far as
 * the evaluations so far can pay for it. */
#include "core/numerics/stability/stability.h"
#include "core/numerics/stability/stiffness.h"

/* Relative to the bound at the last estimate; the limit is above the truth by half of it at most, unless the estimate
 * itself has a margin, as it mostly has. */
static const double slack = 0.02, slack_of_samples = 0.1, headroom = 1.05, headroom_of_samples = 1.3;
/* A measurement costs about MEASURE_COST evaluations; all together may cost a MEASURE_PART-th of the run's evaluations,
 * beside the first MEASURE_FREE. */
enum { MEASURE_COST = 4, SAMPLE_COST = 6, MEASURE_PART = 100, MEASURE_FREE = 20, LEAST = 4, MOST = 1024 };
/* A sample that changes fast is taken at every step, whatever it costs, where it is more than this part of what would
 * determine the step: tension that rises and falls with what it holds has its peaks between others. */
static const double near_part = 0.25;
static const double fast = 0.05, slow = 0.01; /* relative changes between two measurements */
/* Growth of v^2 that calls for a measurement: the first is that of w^2 within the safety factor of a chosen step, the
 * second is for scenes where the last growth changed the sample by less than `slow`. */
static const double faster = 1.1, much_faster = 2;

static bool risen(const hk_watch *w) {
  return w->expected.stiffness > (1 + slack) * w->allowed.stiffness ||
         w->expected.damping > (1 + slack) * w->allowed.damping ||
         w->expected.sample > (1 + slack_of_samples) * w->allowed.sample;
}

/* Where velocities matter every other measurement is of the damping. By the same number of evaluations it is seen that
 * the state is that of the last one, as after an estimate that the watch asked for: how fast the sample rises is then
 * known from before. */
static void measure(hk_watch *w, hk_system *s, double (*scratch)[6], bool all, size_t evaluations) {
  bool again = evaluations == w->at;
  double sample, last = w->last.sample, before = w->seen.sample;
  w->at = evaluations;
  bool damping = s->queries->flags & HK_DEPENDS_ON_V && w->allowed.damping > 0 && w->measurements % 2;
  w->last = w->seen;
  if (all || !damping) w->seen.covered = hk_stiffness_part_of(s, HK_STIFFNESS_WHOLE, scratch, &w->seen.stiffness);
  if (all || damping) hk_stiffness_part_of(s, HK_DAMPING_WHOLE, scratch, &w->seen.damping);
  if (s->constraint && hk_stiffness_sample(s, &sample) == HK_OK) w->seen.sample = sample;
  w->last.sample = again ? last : before;
}

void hk_watch_begin(hk_watch *w, hk_system *s, double (*scratch)[6], double motion, size_t evaluations) {
  measure(w, s, scratch, true, evaluations);
  w->moved = motion;
  w->motion = faster * motion;
  double last = w->last.sample;
  w->last = w->allowed = w->expected = w->seen;
  w->last.sample = last;
  w->peak[0] = w->peak[1];
  w->peak[1] = 0;
  if (w->every == 0) w->every = LEAST;
  w->next = evaluations + w->every;
}

static double change(double now, double before) { return now > 0 ? fabs(now - before) / fmax(now, before) : 0; }

static void set_interval(hk_watch *w, size_t evaluations, size_t cost) {
  double most = fmax(change(w->seen.stiffness, w->last.stiffness), change(w->seen.damping, w->last.damping));
  most = fmax(most, change(w->seen.sample, w->last.sample));
  size_t often = w->often ? w->often : 1, longest = MOST / often;
  bool paid = cost * w->measurements <= often * evaluations / MEASURE_PART + cost * MEASURE_FREE;
  bool near =
      w->seen.sample > near_part * w->leeway * w->allowed.sample && change(w->seen.sample, w->last.sample) > fast;
  if (near)
    w->every = 1;
  else if (most > fast && paid)
    w->every = w->every / 2 > LEAST ? w->every / 2 : LEAST;
  else if (most < slow || !paid)
    w->every = 2 * w->every < longest ? 2 * w->every : longest;
  w->next = evaluations + w->every;
}

bool hk_watch_exceeded(const hk_watch *w, double sample) { return sample > (1 + slack_of_samples) * w->allowed.sample; }

bool hk_watch_calls(const hk_watch *w, double motion, size_t evaluations) {
  return evaluations >= w->next || motion > w->motion;
}

/* The value at the next measurement, if it rises by the factor by which it rose since the last, at most fourfold. */
static double continued(double now, double before) { return before > 0 ? now * fmin(4, fmax(1, now / before)) : now; }

bool hk_watch_measure(hk_watch *w, hk_system *s, double (*scratch)[6], double motion, size_t evaluations) {
  if (!w->allowed.covered && !s->constraint) return false;
  measure(w, s, scratch, false, evaluations);
  w->measurements++;
  w->expected.stiffness = continued(w->seen.stiffness, w->last.stiffness);
  w->expected.damping = continued(w->seen.damping, w->last.damping);
  w->peak[1] = fmax(w->peak[1], w->seen.sample);
  w->expected.sample = fmax(continued(w->seen.sample, w->last.sample), fmax(w->peak[0], w->peak[1]));
  bool indifferent = motion >= faster * w->moved && change(w->seen.sample, w->last.sample) < slow;
  w->motion = fmax(w->motion, motion * (indifferent ? much_faster : faster));
  w->moved = motion;
  set_interval(w, evaluations, MEASURE_COST + (s->constraint ? SAMPLE_COST : 0));
  return risen(w);
}

/* Raises *allowed to what is expected; returns the factor, INFINITY where nothing was allowed. */
static double raise(double *allowed, double expected, double by) {
  double before = *allowed;
  *allowed = fmax(before, by * expected);
  return *allowed == before ? 1 : *allowed / before;
}

void hk_watch_raise(hk_watch *w, hk_spectrum *s) {
  double before = w->allowed.stiffness, stiffer = raise(&w->allowed.stiffness, w->expected.stiffness, headroom);
  double damped = raise(&w->allowed.damping, w->expected.damping, headroom);
  double room = change(w->seen.sample, w->last.sample) > fast ? headroom_of_samples : headroom;
  double tauter = raise(&w->allowed.sample, w->expected.sample, room), w_max = s->w_max;
  s->w_max = isfinite(stiffer) ? s->w_max * sqrt(stiffer) : sqrt(w->allowed.stiffness);
  s->w_max = fmax(s->w_max, isfinite(tauter) && w_max > 0 ? w_max * sqrt(tauter) : sqrt(w->allowed.sample));
  if (isfinite(stiffer)) s->w_switching *= sqrt(stiffer); /* what rose may be what sets in and ceases */
  s->g_max = isfinite(damped) ? s->g_max * damped : s->g_max + w->allowed.damping;
  if (s->beta > 0) /* all that stiffened may be tension, which their damping does not reach */
    s->w_undamped = fmin(s->w_max, sqrt(s->w_undamped * s->w_undamped + w->allowed.stiffness - before));
  for (int k = 0; k < HK_DAMPED_LINES; k++) s->damped[k].offset += s->damped[k].slope * (w->allowed.stiffness - before);
  s->damping_slope = 0;
}
