/* What went wrong and where. A run that diverged is traced to the first particle and the force behind it; one that
 * finished is judged by what it measured. Nothing here changes the state. */
#include "core/run/engine.h"
#include "core/base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Above these a finished run is called inaccurate. Energy that came from nowhere or went there, beyond the work of pins
 * and damping: a tenth of the largest kinetic energy is visible in any picture, while leapfrog at 0.9 of its limit
 * oscillates by less on cloth. */
static const double energy_limit = 0.1, violation_limit = 1e-6, unresolved_limit = 0.1, /* of the extent, in a step */
    energy_rounding = 1e-11; /* of the energy held: a scene at rest has a kinetic energy of rounding */

void hk_run_warn(hk_run *run, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  for (size_t k = 0; k < run->warnings; k++)
    if (strcmp(run->warning[k], text) == 0) return;
  char *copy = hk_string_copy(text), **grown = realloc(run->warning, (run->warnings + 1) * sizeof *grown);
  if (grown) run->warning = grown;
  if (grown && copy)
    run->warning[run->warnings++] = copy;
  else
    free(copy);
  if (run->options.progress >= 0) fprintf(stderr, "hooke: warning: %s\n", text);
}

void hk_snapshot_free(hk_snapshot *s) {
  free(s->X);
  free(s->id);
  free(s->mass);
  *s = (hk_snapshot){0};
}

hk_status hk_snapshot_take(hk_run *run, hk_snapshot *s) {
  size_t n = run->model.n, size = run->system.size;
  if (size > s->capacity) {
    hk_snapshot_free(s);
    s->X = malloc(size * sizeof *s->X);
    s->id = malloc((n + 1) * sizeof *s->id);
    s->mass = malloc((n + 1) * sizeof *s->mass);
    if (!s->X || !s->id || !s->mass) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory to keep a good state");
    s->capacity = size;
  }
  s->t = run->system.t;
  s->n = n;
  s->size = size;
  memcpy(s->X, run->X, size * sizeof *s->X);
  memcpy(s->id, run->id, n * sizeof *s->id);
  memcpy(s->mass, run->mass, n * sizeof *s->mass);
  return HK_OK;
}

static size_t first_bad(const double *list, size_t count) {
  size_t k = 0;
  while (k < count && isfinite(list[k])) k++;
  return k;
}

static double size_of(const double *f) { return sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]); }

/* One force alone at X; false when it failed. */
static bool force_alone(hk_run *run, size_t k, const double *X, size_t n, double *F) {
  hk_instance *force = run->scene->force.item[k];
  hk_view view = run->force_view[k];
  double power;
  hk_error kept = run->error;
  view.x = X;
  view.v = X + 3 * n;
  view.y = run->width ? X + 6 * n : NULL;
  view.t = run->system.t;
  view.power = &power;
  memset(F, 0, 3 * n * sizeof *F);
  bool fine = force->plugin->force->add(force->self, &view, F) == HK_OK;
  run->error = kept;
  return fine;
}

/* The force whose F is not finite, and its first such particle; else, given a particle, the largest on it. */
static const char *culprit(hk_run *run, const double *X, size_t n, size_t *particle, double *newton) {
  double *F = malloc((3 * n + 1) * sizeof *F), largest = -1;
  const char *label = NULL;
  for (size_t k = 0; F && k < run->scene->force.count; k++) {
    if (!run->force_acts[k] || !force_alone(run, k, X, n, F)) continue;
    size_t bad = first_bad(F, 3 * n);
    if (bad < 3 * n) {
      if (*particle == n) *particle = bad / 3;
      label = run->scene->force.item[k]->label;
      *newton = F[bad];
      break;
    }
    double here = *particle < n ? size_of(F + 3 * *particle) : 0;
    if (*particle < n && here > largest) {
      largest = *newton = here;
      label = run->scene->force.item[k]->label;
    }
  }
  free(F);
  return label;
}

static void remedy(const hk_run *run, char *text, size_t size) {
  if (run->last_h > run->dt_limit)
    snprintf(text, size, "; the step %g s is above the stable limit %g s: leave dt out or give less", run->last_h,
             run->dt_limit);
  else if (run->method->flags & HK_IMPLICIT)
    snprintf(text, size, "; try a smaller dt or fps");
  else
    snprintf(text, size, "; try a smaller dt, and look at the masses and stiffnesses of that particle");
}

static size_t fastest(const double *v, size_t n) {
  size_t best = 0;
  for (size_t i = 1; i < n; i++)
    if (size_of(v + 3 * i) > size_of(v + 3 * best)) best = i;
  return best;
}

/* What blew up, in words: a state that is not finite, a force that is not, or else, where a method keeps the last
 * finite state, the fastest particle in it. */
static void explain(hk_run *run, char *text, size_t size) {
  size_t n = run->model.n, bad = first_bad(run->X, 6 * n), particle = n;
  double newton = NAN;
  const char *label = NULL;
  if (bad == 6 * n) {
    label = culprit(run, run->X, n, &particle, &newton);
    if (label) {
      snprintf(text, size, "particle %u gets a force that is not finite from '%s'", run->id[particle], label);
      return;
    }
    particle = fastest(run->X + 3 * n, n);
    label = culprit(run, run->X, n, &particle, &newton);
  } else {
    particle = bad % (3 * n) / 3;
    if (run->last_good.n == n) label = culprit(run, run->last_good.X, n, &particle, &newton);
  }
  snprintf(text, size, "particle %u %s%s%s%s", run->id[particle],
           bad < 6 * n ? "has a position or velocity that is not finite" : "was the fastest",
           label ? "; the largest force on it was '" : "", label ? label : "", label ? "'" : "");
}

hk_status hk_diagnose(hk_run *run, hk_status cause) {
  char fix[200], what[400];
  remedy(run, fix, sizeof fix);
  if (cause == HK_NOT_CONVERGED)
    snprintf(run->reason, sizeof run->reason, "did not converge at step %zu, t = %g s: %.700s%s", run->steps + 1,
             run->system.t, run->error.text, fix);
  else {
    explain(run, what, sizeof what);
    snprintf(run->reason, sizeof run->reason, "diverged at step %zu, t = %g s: %s%s", run->steps + 1, run->system.t,
             what, fix);
  }
  return cause;
}

static void add_reason(hk_run *run, const char *format, ...) {
  size_t used = strlen(run->reason);
  va_list arguments;
  if (used && used + 2 < sizeof run->reason)
    used += (size_t)snprintf(run->reason + used, sizeof run->reason - used, "; ");
  va_start(arguments, format);
  vsnprintf(run->reason + used, sizeof run->reason - used, format, arguments);
  va_end(arguments);
}

void hk_judge(hk_run *run) {
  hk_summary s;
  hk_run_summary(run, &s);
  *run->reason = 0;
  bool explicit_fixed = !(run->method->flags & (HK_ADAPTIVE | HK_IMPLICIT));
  if (explicit_fixed && !run->growth_expected && run->dt_beyond > 0)
    add_reason(run, "the step %g s is above the stable limit, %g s at its least", run->dt_beyond, run->dt_limit);
  double gone = fabs(s.energy_drift) * s.kinetic_max, held = fabs(s.energy_first) + fabs(s.energy_last);
  if (fabs(s.energy_drift) > energy_limit && gone > energy_rounding * held && !run->energy_converges)
    add_reason(run, "the energy %s by %.3g of the largest kinetic energy without a %s",
               s.energy_drift > 0 ? "grew" : "fell", fabs(s.energy_drift), s.energy_drift > 0 ? "source" : "sink");
  double allowed = s.accuracy > 0 ? s.accuracy : unresolved_limit * hk_run_extent(run),
         unresolved = hk_under_resolved_error(run);
  if (unresolved > allowed)
    add_reason(run, "the steps do not resolve what swings: a step is off by %.3g m by the change of its accelerations",
               unresolved);
  if (run->worst_error > 1 + 1e-9) add_reason(run, "the error estimate was %.3g times the tolerance", run->worst_error);
  if (run->violation_max > violation_limit) add_reason(run, "constraints were violated by %.3g m", run->violation_max);
  run->verdict = *run->reason ? HK_INACCURATE : HK_VERDICT_OK;
}
