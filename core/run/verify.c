/* The comparison of a run with other runs of its scene, from which its error is estimated.
 *
 * 1. With half the step: 2n + 1 steps replace the n steps of a frame, so that a periodic load cannot be in phase with
 *    the steps of both runs; an adaptive method gets a tenth of the tolerance and at most half its longest step. The
 *    start is perturbed by 1e-14 of the extent, which shows motion that no method can predict.
 * 2. With an independent method that controls its error (reference.c), where that costs little. Its distance is the
 *    error, whatever the two runs of one method have in common.
 * 3. Without a reference, the distance D to half the step bounds the error by 2 D from order 1 on. Where D is below the
 *    accuracy and 2 D is not, a quarter of the step shows the order in the first part of the run, and the error is
 *    D / (1 - ratio) of the two distances there (Richardson). Where figures of the run contradict a small D, the
 *    reference is tried at a higher cost.
 *
 * All are compared at all frames (hk_trajectory), or at the end where the scene says so. The other runs end steps where
 * a function of time changes fast (judge/under_sampled.c), so that they do not step over what the run stepped over. */
#include "core/run/comparison.h"
#include "core/text/text.h"

#include <string.h>

static const double visible = 0.1; /* of the change of a channel, as in comparison.c */

static void add_reason(hk_summary *s, const char *format, ...) HK_PRINTF(2, 3);

static void add_reason(hk_summary *s, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  hk_text_append(s->reason, sizeof s->reason, "; ", format, arguments);
  va_end(arguments);
  *s->checked = 0;
  s->verdict = HK_INACCURATE;
  s->verdict_name = hk_verdict_name(s->verdict);
}

/* The channel whose error is the worst of all; NULL: that of the positions is. */
static const hk_channel_spec *worst_channel(const hk_comparison *c) {
  const hk_scene *scene = c->whole->scene;
  bool positions = c->worst.position / c->accuracy > c->worst.channel;
  for (size_t k = 0; k < scene->channels && !positions && c->worst.channel_name; k++)
    if (strcmp(scene->channel[k].name, c->worst.channel_name) == 0) return &scene->channel[k];
  return NULL;
}

static void judge_error(const hk_comparison *c, hk_summary *s) {
  const hk_channel_spec *channel = worst_channel(c);
  if (isnan(c->error)) {
    if (s->accuracies > 0) add_reason(s, "the accuracy asked for could not be checked");
  } else if (!(c->error > 1))
    return;
  else if (channel && channel->accuracy > 0)
    add_reason(s, "the error of the channel '%s' is about %.3g, and the accuracy asked for, %g, is not reached (%s)",
               channel->name, c->error * channel->accuracy, channel->accuracy, c->how);
  else if (channel)
    add_reason(s, "the error of the channel '%s' is about %.2g of its change (%s)", channel->name, visible * c->error,
               c->how);
  else if (s->accuracy > 0)
    add_reason(s, "the error is about %.3g m at t = %.4g s, and the accuracy asked for, %g m, is not reached (%s)",
               c->position, c->worst.t, s->accuracy, c->how);
  else
    add_reason(s, "the error is about %.3g m at t = %.4g s, more than a tenth of the motion (%s)", c->position,
               c->worst.t, c->how);
}

static void judge_doubts(const hk_comparison *c, hk_summary *s) {
  double displacement = c->referred || !c->compared ? 0 : hk_doubts_lost_energy(c);
  hk_remedy_need(&c->whole->judgement, displacement / s->accuracy, c->whole->step.method->order);
  if (displacement > s->accuracy)
    add_reason(s,
               "the steps damp fast swings, whose energy is missing with half the step, too: as a speed it would have "
               "taken the particles %.3g m by the end, above the accuracy asked for, %g m",
               displacement, s->accuracy);
  if (!c->first->ignore_exact)
    hk_remedy_need(&c->whole->judgement, s->exact_error / s->accuracy, c->whole->step.method->order);
  if (!c->first->ignore_exact && s->accuracy > 0 && s->exact_error > s->accuracy)
    add_reason(s, "the error of %.3g m is above the accuracy asked for, %g m", s->exact_error, s->accuracy);
}

/* What was assumed of functions of time: no samples can exclude a pulse between them. */
static void describe_functions(const hk_comparison *c, hk_summary *s) {
  const hk_sampling *f = &c->sampling;
  if (!(f->assumed > 0) || s->verdict != HK_VERDICT_OK) return;
  hk_checked_add(s, "; ", "functions of time are assumed to do nothing within less than %.2g s%s", f->assumed,
                 f->assumed <= f->declared && isfinite(f->declared) ? ", as declared" : "");
}

static void describe(const hk_comparison *c, hk_summary *s) {
  if (s->verdict != HK_VERDICT_OK || isnan(c->error)) return;
  if (s->accuracy > 0)
    hk_checked_add(s, ", ", "error about %.2g m, asked %g m (%s)", c->position, s->accuracy, c->how);
  else if (s->accuracies > 0)
    hk_checked_add(s, ", ", "channels within %.2g of the accuracy asked for (%s)", c->error, c->how);
  else
    hk_checked_add(s, ", ", "error about %.2g m (%s); accuracy not asked for", c->position, c->how);
  describe_functions(c, s);
}

/* Judges the run with what is known so far; false: there are doubts. */
static bool judge(hk_comparison *c) {
  hk_summary *s = c->summary;
  double difference = s->verify_difference, wall = s->check_wall_s;
  c->whole->judgement.confirmed = c->referred && c->error <= 1;
  c->whole->judgement.energy_converges = c->compared && hk_doubts_energy_converges(c);
  hk_judge(&c->whole->loop, &c->whole->judgement, &c->whole->asked);
  hk_run_summary(c->whole, s);
  s->verify_difference = difference;
  s->check_wall_s = wall;
  s->error_estimate = c->position;
  if (s->accuracies > (s->accuracy > 0)) s->channel_error = c->worst.channel;
  judge_error(c, s);
  judge_doubts(c, s);
  hk_remedy_need(&c->whole->judgement, c->error, c->whole->step.method->order);
  describe(c, s);
  return s->verdict == HK_VERDICT_OK;
}

/* Where an accuracy was asked for. */
static void judge_accuracy(hk_comparison *c) {
  bool known = true, possible = hk_comparison_agrees(c, 1);
  hk_comparison_refer(c, possible && hk_doubts_hidden_swings(c) ? HK_EFFORT_MEDIUM : HK_EFFORT_SMALL, possible);
  hk_comparison_settle(c);
  if (!c->referred) {
    hk_comparison_use_half(c);
    known = c->error <= 1 || !possible || hk_comparison_use_order(c);
  }
  bool fine = judge(c);
  if (fine || c->referred || (known && c->error > 1)) return;
  hk_comparison_refer(c, HK_EFFORT_LARGE, false); /* in doubt */
  judge(c);
}

/* Half the step failed: only a reference can say how accurate the run was. */
static void judge_without_half(hk_comparison *c) {
  if (c->channel) hk_comparison_refer(c, HK_EFFORT_MEDIUM, false);
  judge(c);
}

/* A function of time that acts between the evaluations of a run which is compared with no other. */
static void judge_sampling(const hk_comparison *c, hk_summary *s) {
  const hk_sampling *f = &c->sampling;
  if (f->varies && f->where)
    add_reason(s,
               "%s: %s: %s does something within %.3g s at t = %.6g s, between two evaluations of the run: try a "
               "smaller dt, or --accuracy",
               f->where, f->label, f->name, f->shortest, f->begin);
}

/* Where none was: half the step is taken where it could defend the run. */
static void judge_motion(hk_comparison *c) {
  hk_error error = {0};
  hk_comparison_refer(c, HK_EFFORT_SMALL, true);
  if (!c->referred) {
    judge_sampling(c, c->summary);
    describe_functions(c, c->summary);
    return;
  }
  if (c->error > 1 && !c->compared) hk_comparison_take_half(c, &error);
  if (c->compared) hk_comparison_settle(c);
  judge(c);
}

/* No other run does what the user's hand did: the run stays as its own figures have judged it. */
static void judge_by_hand(hk_summary *s) {
  if (s->accuracies > 0)
    add_reason(s,
               "the accuracy asked for could not be checked: the user's hand did work of %.3g J, which no other run "
               "repeats",
               s->hand_work);
}

hk_status hk_verify(const hk_reopen *reopen, const hk_run_options *first, bool half, hk_run *whole, hk_summary *s,
                    hk_error *error) {
  hk_comparison c = {.reopen = reopen, .first = first, .whole = whole, .summary = s, .error = NAN, .position = NAN};
  bool judged = s->verdict == HK_VERDICT_OK || s->verdict == HK_INACCURATE, asked = s->accuracies > 0;
  double begin = hk_clock();
  if (whole->record.by_hand) {
    if (judged) judge_by_hand(s);
    return HK_OK;
  }
  hk_status status = hk_comparison_open(&c, error);
  if (whole->options.progress > 0 && asked && whole->loop.seconds > 1)
    fprintf(stderr, "hooke: comparing the run with others, which takes some %.0f s\n", 2.5 * whole->loop.seconds);
  if (status == HK_OK && (half || asked)) status = hk_comparison_take_half(&c, error);
  s->verify_difference = c.compared ? hk_comparison_difference(&c) : NAN;
  if (judged && asked && c.compared)
    judge_accuracy(&c);
  else if (judged && asked)
    judge_without_half(&c);
  else if (judged && status == HK_OK && whole->judgement.compared)
    judge_motion(&c);
  hk_remedy_describe(&whole->loop, &whole->judgement, s);
  s->check_wall_s = hk_clock() - begin;
  hk_comparison_close(&c);
  return status;
}
