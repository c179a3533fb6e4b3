/* The choice of the step: what the scene or the command line asks, checked against the stable limit; or, left out, the
 * limit times a safety factor. The limit is estimated at the start and again after events and, now and then, at frames;
 * how often is a count of evaluations, so that the estimates cost a few percent and runs repeat bit by bit. */
#include "core/run/engine.h"

#include <stdlib.h>

enum { REVIEW_EVERY = 40 }; /* evaluations of the run for each one of an estimate */

static bool covered(const hk_run *run) {
  for (size_t k = 0; k < run->scene->force.count; k++) {
    const hk_force *force = run->scene->force.item[k]->plugin->force;
    if (run->force_acts[k] && (force->flags & HK_DEPENDS_ON_X) && !force->elements) return false;
  }
  return run->scene->constraint.count == 0;
}

/* Within a tenth of a percent: the limit is the same, and finding it costs more than many a small scene's frame. */
static bool close_to(double a, double b) { return fabs(a - b) <= 1e-3 * fmax(fabs(a), fabs(b)); }

static bool same(const hk_spectrum *a, const hk_spectrum *b) {
  return close_to(a->w_max, b->w_max) && close_to(a->g_max, b->g_max) && close_to(a->alpha, b->alpha) &&
         close_to(a->beta, b->beta) && close_to(a->w_undamped, b->w_undamped) &&
         close_to(a->channel_rate, b->channel_rate) && a->evaluations > 0;
}

/* Evaluations and sampled times of an estimate are not the run's. */
hk_status hk_step_estimate(hk_run *run) {
  size_t before = run->evaluations, factorizations = run->factorizations;
  hk_spectrum before_it = run->spectrum;
  hk_status status = hk_spectrum_estimate(&run->system, covered(run), &run->spectrum, &run->error);
  run->estimate_cost = run->evaluations - before;
  run->evaluations = before;
  run->factorizations = factorizations;
  run->estimated_at = before;
  if (status != HK_OK) return status;
  if (same(&before_it, &run->spectrum)) return HK_OK;
  hk_stable stable = hk_stable_step(run->method, &run->spectrum);
  run->dt_limit = run->limit_now = stable.limit;
  run->dt_suggested = stable.suggestion;
  run->growth_rate = stable.growth_rate;
  run->growth_expected = stable.limit == 0;
  return HK_OK;
}

static void choose(hk_run *run) {
  double frame = 1 / run->scene->fps;
  run->dt_chosen = true;
  run->dt = run->method->flags & HK_IMPLICIT ? frame / 2 : fmin(run->dt_suggested, frame);
  if (run->growth_expected)
    hk_run_warn(run,
                "%s has no stable step on this scene; dt = %.3g s is chosen for accuracy, and motion may grow at a "
                "rate of %.3g 1/s",
                run->scene->integrator->plugin->name, run->dt, run->growth_rate);
}

static void check_given(hk_run *run, double given) {
  double frame = 1 / run->scene->fps;
  run->dt = given;
  if (given > frame * (1 + 1e-9))
    hk_run_warn(run, "dt = %g s is longer than a frame of %g s, so steps are of one frame; fps = %g allows it", given,
                frame, 1 / given);
  double h = fmin(given, frame);
  if (run->growth_expected)
    hk_run_warn(run, "%s has no stable step on this scene; motion may grow", run->scene->integrator->plugin->name);
  else if (h > run->dt_limit)
    hk_run_warn(
        run, "dt = %g s is above the largest stable step, %.4g s: expect an explosion; leave dt out to have it chosen",
        h, run->dt_limit);
}

hk_status hk_step_choose(hk_run *run) {
  double given = isnan(run->options.dt) ? run->scene->dt : run->options.dt;
  if (run->resumed) given = run->dt;
  if (run->method->flags & HK_ADAPTIVE) {
    run->dt = isnan(given) ? INFINITY : given;
    run->dt_chosen = isnan(given);
    return HK_OK;
  }
  if (run->method->flags & HK_IMPLICIT) {
    if (isnan(given))
      choose(run);
    else
      run->dt = given;
    return HK_OK;
  }
  hk_status status = hk_step_estimate(run);
  if (status == HK_NOT_FINITE) { /* not a matter of steps: the run itself will say what is wrong */
    run->error = (hk_error){0};
    run->dt_limit = run->limit_now = NAN;
    run->dt = isnan(given) ? 1 / run->scene->fps : given;
    return HK_OK;
  }
  if (status != HK_OK) return status;
  if (isnan(given))
    choose(run);
  else
    check_given(run, given);
  return HK_OK;
}

hk_status hk_step_reestimate(hk_run *run, bool event) {
  if (run->method->flags & (HK_ADAPTIVE | HK_IMPLICIT)) return HK_OK;
  if (!event && run->evaluations - run->estimated_at < REVIEW_EVERY * run->estimate_cost) return HK_OK;
  if (!(run->system.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V)) || run->model.n == 0) return HK_OK;
  double old = run->dt_limit;
  bool expected = run->growth_expected;
  hk_status status = hk_step_estimate(run);
  if (status != HK_OK) return status == HK_NOT_FINITE ? HK_OK : status;
  run->growth_expected |= expected;
  if (run->dt_limit > old) run->dt_limit = old; /* keep the worst that was seen, for the summary */
  if (run->dt_chosen && run->dt_suggested < run->dt) run->dt = run->dt_suggested;
  return HK_OK;
}
