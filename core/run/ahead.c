/* What is said before the first step: options without an effect, and a number of steps that nobody wants to wait for.
 * Where a scene is so stiff that an explicit method takes tens of millions of steps, some steps of it are timed, and
 * some of an implicit method, whose steps are as long as it likes. */
#include "core/run/run.h"

#include <math.h>
#include <stdio.h>

static const double many_steps = 1e7;
/* Steps that are timed. The first ones of an implicit method allocate and analyse its matrices. */
enum { EXPLICIT_STEPS = 1000, IMPLICIT_STEPS = 10 };
static const double implicit_steps_per_frame = 2; /* as loop/step_choice.c chooses them */

static bool is_adaptive(const hk_plugin *plugin, const void *context) {
  (void)context;
  return plugin->integrator->flags & HK_ADAPTIVE;
}

void hk_warn_of_idle_options(hk_run *run) {
  const hk_plugin *adaptive = NULL;
  hk_error why = {0};
  if (isnan(run->options.tol) || run->step.method->flags & HK_ADAPTIVE) return;
  hk_registry_prefer(run->scene->registry, HK_INTEGRATOR, is_adaptive, NULL, &adaptive, &why);
  hk_warn(&run->warnings,
          "--tol %g has no effect: %s takes steps of a given length; give --dt, or choose a method that chooses its "
          "steps%s%s",
          run->options.tol, run->step.method_name, adaptive ? ", such as --integrator " : "",
          adaptive ? adaptive->name : "");
}

static bool is_implicit(const hk_integrator *m) {
  return m->flags & (HK_IMPLICIT | HK_NEEDS_SOLVER | HK_NEEDS_JACOBIAN);
}

/* Of fixed steps, that damps what it does not resolve. */
static bool suits(const hk_plugin *plugin, const void *context) {
  const hk_integrator *m = plugin->integrator;
  const hk_run *whole = context;
  bool constrained = whole->plugins.kind[HK_CONSTRAINT].count > 0;
  bool takes = !(constrained && m->without_constraints);
  return takes && m->flags & HK_IMPLICIT &&
         !(m->flags & (HK_ADAPTIVE | HK_SYMPLECTIC | HK_REVERSIBLE | HK_SPLITS_FORCES));
}

/* s a step, of another run of the scene; NAN: it took none. */
static double time_steps(const hk_reopen *reopen, const hk_run_options *first, const char *integrator, double dt,
                         size_t steps) {
  hk_run *again = NULL;
  hk_error why = {0};
  hk_run_options o = hk_rerun_options(first, 1);
  double found = NAN;
  o.resume = NULL;
  o.compare = HK_COMPARE_ASKED;
  o.step_limit = steps;
  o.integrator = integrator;
  o.dt = dt;
  hk_status status = reopen->open(reopen->context, &o, &again, &why);
  if (status == HK_OK) status = hk_run_advance(again, hk_run_end(again), &why);
  if ((status == HK_OK || status == HK_INTERRUPTED) && again->record.steps > 0)
    found = again->loop.seconds / (double)again->record.steps;
  if (again) hk_run_close(again, NULL);
  reopen->close(reopen->context, again);
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

static double steps_to_come(const hk_run *whole) {
  double rest = hk_run_end(whole) - whole->state.t, dt = fmin(whole->step.dt, 1 / whole->step.fps);
  return rest / dt;
}

void hk_foretell(const hk_reopen *reopen, const hk_run_options *first, hk_run *whole) {
  const hk_step_choice *step = &whole->step;
  const hk_plugin *implicit = NULL;
  hk_error why = {0};
  char now[32], then[32];
  double w, steps = steps_to_come(whole);
  if (first->progress <= 0 || is_implicit(step->method) || step->method->flags & HK_ADAPTIVE || !(steps > many_steps))
    return;
  double each = time_steps(reopen, first, first->integrator, first->dt, EXPLICIT_STEPS);
  if (!isfinite(each)) return;
  const char *label = hk_stiffest_force(&whole->loop, &w);
  fprintf(stderr, "hooke: %.2g steps of %.2g s are to come, which take about %s", steps, fmin(step->dt, 1 / step->fps),
          duration(steps * each, now, sizeof now));
  if (label) fprintf(stderr, "; the fastest swings, of %.2g s, are those of '%s'", 2 * acos(-1) / w, label);
  fprintf(stderr, "\n");
  if (hk_registry_prefer(whole->scene->registry, HK_INTEGRATOR, suits, whole, &implicit, &why) != HK_OK) return;
  double frames = (hk_run_end(whole) - whole->state.t) * step->fps;
  double other = time_steps(reopen, first, implicit->name, INFINITY, IMPLICIT_STEPS);
  if (isfinite(other))
    fprintf(stderr,
            "hooke: --integrator %s would take about %s, with %.2g steps a frame: it damps swings that are faster than "
            "its steps\n",
            implicit->name, duration(other * frames * implicit_steps_per_frame, then, sizeof then),
            implicit_steps_per_frame);
}
