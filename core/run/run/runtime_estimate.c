/* How long a run will take, said before its first step. The number of steps of a fixed-step method is known, and an
 * evaluation at the start, where the run has just had one, is timed: that many are the least that a run takes. Where
 * they take long, some steps are taken and timed in another run of the scene, from which nothing stays; shorter runs
 * are not worth that, and what is left out so, dear steps and outputs, report/progress.c sees in the first steps. Where
 * a scene is so stiff that an explicit method takes tens of millions of steps, some of an implicit one are timed, too,
 * whose steps are as long as it likes. */
#include "core/engine/contract/contract.h"
#include "core/engine/text/text.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/run/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double many_steps = 1e7;
/* Steps that are timed for a choice between methods. The first ones of an implicit method allocate and analyse its
 * matrices. */
enum { EXPLICIT_STEPS = 1000, IMPLICIT_STEPS = 10 };
static const double implicit_steps_per_frame = 2; /* as step_choice.c chooses them */

/* A trial may take a tenth of the least that the run does: it opens the scene again, which has just been timed, and
 * takes steps for a tenth of a second, or three implicit ones, each of which fills and factorises a matrix. That is
 * some thirty evaluations where it is cheap (a chain, whose matrix has a narrow band), and thousands where it is not.
 */
static const double part_of_run = 0.1, trial = 0.1 /* s */, evaluations_of_implicit = 30;
enum { IMPLICIT_TRIAL = 3, EXPLICIT_TRIAL = 10000 /* at most */ };
/* Of an adaptive method, whose first steps are much shorter than those that follow. */
enum { ADAPTIVE_TRIAL = 50 };

static bool is_implicit(const hk_integrator *m) {
  return m->flags & (HK_IMPLICIT | HK_NEEDS_SOLVER | HK_NEEDS_JACOBIAN);
}

/* Of fixed steps, that damps what it does not resolve. */
static bool suits(const hk_plugin *plugin, const void *context) {
  const hk_integrator *m = plugin->integrator;
  const hk_run *whole = context;
  bool constrained = whole->plugins.kind[HK_CONSTRAINT].count > 0;
  bool takes = !(constrained && hk_integrator_tables_of(m)->constrained.refused);
  return takes && m->flags & HK_IMPLICIT &&
         !(m->flags & (HK_ADAPTIVE | HK_SYMPLECTIC | HK_REVERSIBLE | HK_SPLITS_FORCES));
}

/* s a step, of another run of the scene; NAN: it took none. `next`: s, the length of those to come, that
 * of the next one or the mean: an adaptive method's next one may end at a cut. */
static double time_steps(const hk_scene_loader *loader, const hk_run_options *first, const char *integrator, double dt,
                         size_t steps, double *next) {
  hk_run *again = NULL;
  hk_error why = {0};
  hk_run_options o = hk_comparison_run_options(first, 1);
  double found = NAN;
  o.resume = NULL;
  o.compare = HK_COMPARE_ASKED;
  o.step_limit = steps;
  o.integrator = integrator;
  o.dt = dt;
  hk_status status = loader->open(loader->context, &o, &again, &why);
  if (status == HK_OK) status = hk_run_advance(again, hk_run_end(again), &why);
  if ((status == HK_OK || status == HK_INTERRUPTED) && again->record.steps > 0)
    found = again->loop.seconds / (double)again->record.steps;
  if (isfinite(found)) *next = fmax(again->step->length.dt, again->state.t / (double)again->record.steps);
  if (again) hk_run_close(again, NULL);
  loader->close(loader->context, again);
  return found;
}

/* "40 s", "3 min", "5 h", "2 days". */
static const char *duration(double seconds, char *text, size_t size) {
  if (seconds < 100)
    snprintf(text, size, "%.2g s", seconds);
  else if (seconds < 6000)
    snprintf(text, size, "%.0f min", seconds / 60);
  else if (seconds < 2e5)
    snprintf(text, size, "%.0f h", seconds / 3600);
  else
    snprintf(text, size, "%.0f days", seconds / 86400);
  return text;
}

static double steps_to_come(const hk_run *whole, double dt) {
  return (hk_run_end(whole) - whole->state.t) / fmin(dt, 1 / whole->step->fps);
}

/* s; NAN: the accelerations are not finite, which the first step will say. */
static double time_evaluation(hk_run *whole) {
  hk_system *s = &whole->dynamics.system;
  size_t size = whole->state.size;
  double *copy = malloc((2 * size + 1) * sizeof *copy), *a = copy + size;
  if (!copy) return NAN;
  for (size_t k = 0; k < size; k++) copy[k] = whole->state.X[k];
  hk_counts before = whole->dynamics.count;
  double begin = hk_clock();
  hk_status status = s->accelerations(s, whole->state.t, copy, copy + 3 * s->n, copy + 6 * s->n, a, a + 3 * s->n);
  double seconds = hk_clock() - begin;
  whole->dynamics.count = before;
  if (status != HK_OK) hk_error_clear(&whole->error);
  free(copy);
  return status == HK_OK ? seconds : NAN;
}

static void estimate_stiff(const hk_scene_loader *loader, const hk_run_options *first, hk_run *whole) {
  const hk_step_choice *step = whole->step;
  const hk_plugin *implicit = NULL;
  hk_error why = {0};
  char now[32], then[32], stiffest[128];
  double w, next, steps = steps_to_come(whole, step->length.dt);
  double each = time_steps(loader, first, first->integrator, first->dt, EXPLICIT_STEPS, &next);
  if (!isfinite(each)) return;
  const char *label = hk_stiffest_force(&whole->loop, &w);
  whole->progress.expected = steps * each;
  fprintf(stderr, "hooke: %.2g steps of %.2g s are to come, which take about %s", steps,
          fmin(step->length.dt, 1 / step->fps), duration(steps * each, now, sizeof now));
  if (label) hk_plain_line(stiffest, sizeof stiffest, label);
  if (label) fprintf(stderr, "; the fastest swings, of %.2g s, are those of '%s'", 2 * acos(-1) / w, stiffest);
  fprintf(stderr, "\n");
  if (hk_registry_prefer(whole->scene->registry, HK_INTEGRATOR, suits, whole, &implicit, &why) != HK_OK) return;
  double frames = (hk_run_end(whole) - whole->state.t) * step->fps;
  double other = time_steps(loader, first, implicit->name, INFINITY, IMPLICIT_STEPS, &next);
  if (isfinite(other))
    fprintf(stderr,
            "hooke: --integrator %s would take about %s, with %.2g steps a frame: it damps swings that are faster than "
            "its steps\n",
            implicit->name, duration(other * frames * implicit_steps_per_frame, then, sizeof then),
            implicit_steps_per_frame);
}

/* Adaptive methods take a step a frame at least. */
static void estimate_long(const hk_scene_loader *loader, const hk_run_options *first, hk_run *whole) {
  double opening = hk_clock() - whole->asked.opened_at, evaluation = time_evaluation(whole), next = NAN;
  bool implicit = is_implicit(whole->loop.method);
  double steps = steps_to_come(whole, whole->step->length.dt),
         least = evaluation * (implicit ? evaluations_of_implicit : 1);
  double few = whole->loop.method->flags & HK_ADAPTIVE ? ADAPTIVE_TRIAL : IMPLICIT_TRIAL;
  double cost = opening + (implicit ? few * least : trial);
  if (!(part_of_run * steps * least > cost)) return;
  double tried = implicit ? few : fmin(fmax(trial / least, 1), EXPLICIT_TRIAL);
  double each = time_steps(loader, first, first->integrator, first->dt, (size_t)tried, &next);
  if (isfinite(each)) hk_progress_expect(&whole->progress, each, steps_to_come(whole, next));
}

void hk_runtime_estimate(const hk_scene_loader *loader, const hk_run_options *first, hk_run *whole) {
  const hk_integrator *method = whole->loop.method;
  bool fixed = !is_implicit(method) && !(method->flags & HK_ADAPTIVE);
  if (first->progress <= 0) return;
  if (fixed && steps_to_come(whole, whole->step->length.dt) > many_steps)
    estimate_stiff(loader, first, whole);
  else
    estimate_long(loader, first, whole);
}
