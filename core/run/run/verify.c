/* The comparison of a run with other runs of its scene, from which its error is estimated.
 *
 * 1. With half the step: 2n + 1 steps replace the n steps of a frame, so that a periodic load cannot be in phase with
 *    the steps of both runs; an adaptive method gets a tenth of the tolerance and at most half its longest step. The
 *    start is perturbed by 1e-14 of the extent, which shows motion that no method can predict.
 * 2. With an independent method that controls its error (reference.c), where that costs little and one is there that is
 *    better than the run. Its distance is the error, whatever the two runs of one method have in common.
 * 3. Without a reference, the distance D to half the step bounds the error by 2 D from order 1 on. Where D is below the
 *    accuracy and 2 D is not, a quarter of the step shows the order in the first part of the run, and the error is
 *    D / (1 - ratio) of the two distances there (Richardson). Where figures of the run contradict a small D, the
 *    reference is tried at a higher cost.
 *
 *    Where half the step damps fast swings as well, a reference goes as far as its steps reach: those of the start are
 *    then seen to be lost.
 *
 * Where no accuracy is asked for there is 2. alone, for a fifth of the run's cost; if it disagrees, once more with a
 * smaller tolerance. 3. is for tiny scenes, whose figures speak against them. Where 2. is too dear, as of many turns,
 * one of the first part shows whether errors that add up may be visible at the end; then a larger effort, or half the
 * step, decides.
 *
 * All are compared at all frames (hk_trajectory), or at the end where the scene says so. The other runs end steps where
 * a function of time changes fast (judge/under_sampled.c), so that they do not step over what the run stepped over. */
#include "core/run/run/comparison.h"
#include "core/engine/text/text.h"

#include <string.h>

/* Evaluations times particles: some seconds; and errors add up over a thousand steps. */
static const double worth_seconds = 2e7, many_steps = 1000;

/* The channel whose error is the worst of all; NULL: that of the positions is. */
static const hk_channel_spec *worst_channel(const hk_comparison *c) {
  const hk_scene *scene = c->whole->scene;
  bool positions = c->worst.position / c->accuracy > c->worst.channel;
  for (size_t k = 0; k < scene->particles.channels && !positions && c->worst.channel_name; k++)
    if (strcmp(scene->particles.channel[k].name, c->worst.channel_name) == 0) return &scene->particles.channel[k];
  return NULL;
}

/* Judges the run with what is known so far; false: there are doubts. */
static bool judge(hk_comparison *c) {
  hk_run *run = c->whole;
  hk_comparisons *found = &run->judgement.comparisons;
  const hk_channel_spec *channel = worst_channel(c);
  found->tried = true;
  found->reference = c->has_reference;
  found->error = c->error;
  found->position = c->position;
  found->order = c->order;
  found->at = c->worst.t;
  found->channel = channel ? channel->name : NULL;
  found->channel_accuracy = channel && channel->accuracy > 0 ? channel->accuracy : 0;
  if (c->summary->accuracies > (c->summary->accuracy > 0)) found->channel_error = c->worst.channel;
  found->energy_converges = c->compared && hk_comparison_energy_converges(c);
  bool own = !c->has_reference && c->compared && c->summary->accuracies > 0;
  found->damped = own ? hk_comparison_damped_energy(c) : 0;
  memcpy(found->how, c->how, sizeof found->how);
  hk_judge(&run->loop, &run->judgement, &run->asked);
  return run->judgement.verdict == HK_VERDICT_OK;
}

/* Where an accuracy was asked for. */
static void judge_accuracy(hk_comparison *c) {
  bool known = true, possible = hk_comparison_agrees(c, 1);
  hk_effort effort = possible && hk_comparison_damped_modes(c) ? HK_EFFORT_MEDIUM : HK_EFFORT_SMALL;
  hk_comparison_reference(c, effort, possible);
  hk_comparison_tie_break(c, HK_EFFORT_LARGE);
  if (!c->has_reference) {
    hk_comparison_use_half(c);
    known = c->error <= 1 || !possible || hk_comparison_use_order(c);
    if (c->error <= 1 && hk_comparison_may_lose_swings(c)) hk_comparison_use_beginning(c, effort);
  }
  bool fine = judge(c);
  if (fine || c->has_reference || (known && c->error > 1)) return;
  hk_comparison_reference(c, HK_EFFORT_LARGE, false); /* in doubt */
  judge(c);
}

/* Half the step failed: only a reference can say how accurate the run was. */
static void judge_without_half(hk_comparison *c) {
  if (c->channel) hk_comparison_reference(c, HK_EFFORT_MEDIUM, false);
  judge(c);
}

/* Half the step, which costs two runs: where it could defend the run, and costs no more than a reference may. */
static bool take_half_in_defence(hk_comparison *c) {
  hk_error error = {0};
  if (!c->compared && hk_reference_affords(c->whole, 2, HK_EFFORT_LEAST)) hk_comparison_take_half(c, &error);
  return c->compared;
}

/* Whether a larger effort is no more than some seconds. */
static bool is_short(const hk_run *run) {
  return (double)run->dynamics.count.evaluations * (double)run->state.model.n <= worth_seconds;
}

/* The first part of the run lets one doubt its end. Where the run is worth seconds, so is the answer. */
static void settle_doubt(hk_comparison *c) {
  hk_error error = {0};
  if (!is_short(c->whole) || (double)c->whole->record.steps < many_steps) return;
  if (!hk_comparison_may_drift(c, HK_EFFORT_LEAST)) return;
  hk_comparison_reference(c, HK_EFFORT_MEDIUM, true);
  if (!c->has_reference) hk_comparison_take_half(c, &error);
  if (!c->has_reference && c->compared) hk_comparison_use_half(c);
}

/* What functions of time do between evaluations counts, and frames do not refute it; energies that are not balanced may
 * be a few large numbers of steps that damp, while the positions are right. A larger effort, or half the step, may
 * defend the run. */
static void judge_without_reference(hk_comparison *c) {
  hk_run *run = c->whole;
  hk_judge(&run->loop, &run->judgement, &run->asked);
  if (run->judgement.verdict != HK_INACCURATE || (c->sampling.varies && c->sampling.where)) return;
  if (is_short(run)) hk_comparison_reference(c, HK_EFFORT_MEDIUM, true);
  if (!c->has_reference && take_half_in_defence(c)) {
    hk_comparison_use_half(c);
    if (c->error > 1 && hk_comparison_agrees(c, 1)) hk_comparison_use_order(c);
  }
  if (c->has_reference || c->error <= 1) judge(c);
}

/* Where none was. */
static void judge_motion(hk_comparison *c) {
  hk_comparison_reference(c, HK_EFFORT_LEAST, true);
  if (!c->has_reference) settle_doubt(c);
  if (!c->has_reference && !c->compared) {
    judge_without_reference(c);
    return;
  }
  if (c->has_reference && c->error > 1) hk_comparison_sharpen(c, HK_EFFORT_LEAST);
  if (c->error > 1 && take_half_in_defence(c)) hk_comparison_tie_break(c, HK_EFFORT_SMALL);
  judge(c);
}

hk_status hk_verify(const hk_scene_loader *loader, const hk_run_options *first, bool half, hk_run *whole, hk_summary *s,
                    hk_error *error) {
  hk_comparison c = {
      .loader = loader, .first = first, .whole = whole, .summary = s, .error = NAN, .position = NAN, .order = NAN};
  hk_comparisons *found = &whole->judgement.comparisons;
  bool judged = s->verdict == HK_VERDICT_OK || s->verdict == HK_INACCURATE, asked = s->accuracies > 0;
  double begin = hk_clock();
  if (whole->record.by_hand) { /* no other run repeats that: its own figures judge it */
    if (judged) judge(&c);
    hk_run_summary(whole, s);
    return HK_OK;
  }
  hk_status status = hk_comparison_open(&c, error);
  found->sampling = c.sampling;
  found->not_begun = status != HK_OK;
  if (whole->options.progress > 0 && asked && whole->loop.seconds > 1)
    fprintf(stderr, "hooke: comparing the run with others, which takes some %.0f s\n", 2.5 * whole->loop.seconds);
  if (status == HK_OK && (half || asked)) status = hk_comparison_take_half(&c, error);
  if (c.compared) found->difference = hk_comparison_difference(&c);
  if (judged && asked && c.compared)
    judge_accuracy(&c);
  else if (judged && (asked || status != HK_OK))
    judge_without_half(&c);
  else if (judged && whole->judgement.keeps_trajectory)
    judge_motion(&c);
  found->wall_s = hk_clock() - begin;
  hk_run_summary(whole, s);
  hk_comparison_close(&c);
  return status;
}

/* ---- remedies: the scene is run with what an inaccurate run is told to take, and judged as that run would be ---- */

enum { MOST_TRIALS = 3 };
static const double least = 0.2 /* s, that trials may take in any case */, most = 100 /* s, at most */, in_contact = 8;
static const double compared = 3.5, alone = 1.2; /* runs: what a run costs with its comparisons */
static const double worth_a_word = 2;            /* s */
static const double little_work = 10000;         /* steps times particles */

/* s, that a run with this step or tolerance may take, with its comparisons. */
static double expected(const hk_run *run, const hk_summary *s, const hk_remedy *r) {
  double tol = run->dynamics.system.tol, steps = 1;
  if (r->dt > 0) steps = s->dt_max / r->dt;
  if (r->tol > 0) steps = pow(tol / r->tol, 1 / (1.0 + run->loop.method->order));
  return run->loop.seconds * fmax(steps, 1) * (s->accuracies > 0 ? compared : alone);
}

/* So little that it is tried at any speed of the machine: what a small scene is told does not depend on how busy that
 * is. */
static bool is_little(const hk_run *run, const hk_summary *s, const hk_remedy *r) {
  return r->dt > 0 && s->end / r->dt * (double)run->state.model.n <= little_work;
}

static double affordable(const hk_run *whole, const hk_summary *s) {
  double checks = whole->judgement.comparisons.wall_s;
  double spent = whole->loop.seconds + (checks > 0 ? checks : 0);
  if (s->contact_frames > 0) return fmin(fmax(in_contact * spent, least), most);
  /* Impacts follow the order of the method no better where no surfaces are in contact. */
  return s->accuracies > 0 || hk_is_abrupt(&whole->loop) ? fmin(fmax(spent, least), most) : 0;
}

/* HK_OK: it came to its end, and *r says whether it is ok, *next what it is told itself, *cost (s) what that would
 * take. */
static hk_status try_one(const hk_scene_loader *loader, const hk_run_options *first, hk_remedy *r, hk_remedy *next,
                         double *cost) {
  hk_run *again = NULL;
  hk_summary s;
  hk_error why = {0};
  hk_run_options o = hk_comparison_run_options(first, 0);
  o.perturb = 0;
  o.compare = first->compare;
  o.resume = NULL;
  if (r->dt > 0) o.dt = r->dt;
  if (r->tol > 0) o.tol = r->tol;
  hk_status status = loader->open(loader->context, &o, &again, &why);
  if (status == HK_OK) status = hk_run_advance(again, hk_run_end(again), &why);
  if (status == HK_OK) status = hk_run_close(again, &why); /* which judges it */
  if (status == HK_OK) hk_run_summary(again, &s);
  if (status == HK_OK) status = hk_verify(loader, &o, false, again, &s, &why);
  if (status == HK_OK) {
    *next = hk_remedy_propose(&again->loop, &again->judgement, &s);
    *cost = expected(again, &s, next);
    r->tried = true;
    r->ok = s.verdict == HK_VERDICT_OK;
  }
  if (again) hk_run_close(again, NULL);
  loader->close(loader->context, again);
  return status;
}

static bool is_known(const hk_remedy *r) { return r->dt > 0 || r->tol > 0; }

static void announce(const hk_run *whole, const hk_remedy *r, double cost) {
  if (!(whole->options.progress > 0 && cost > worth_a_word)) return;
  fprintf(stderr, "hooke: the run is inaccurate: trying %s %.1g, which takes some %.0f s\n",
          r->dt > 0 ? "--dt" : "--tol", r->dt > 0 ? r->dt : r->tol, cost);
}

void hk_remedy_try(const hk_scene_loader *loader, const hk_run_options *first, hk_run *whole, hk_summary *s) {
  double left = affordable(whole, s), begin = hk_clock();
  hk_remedy now = hk_remedy_propose(&whole->loop, &whole->judgement, s), next;
  double cost = expected(whole, s, &now);
  for (int tries = 0; tries < MOST_TRIALS && is_known(&now); tries++) {
    if (!(cost < left - (hk_clock() - begin) || (left > 0 && is_little(whole, s, &now)))) break;
    announce(whole, &now, cost);
    if (try_one(loader, first, &now, &next, &cost) != HK_OK) break;
    whole->judgement.comparisons.remedy = now;
    if (now.ok) break;
    now = next;
  }
  hk_run_summary(whole, s);
}
