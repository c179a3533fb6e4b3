/* The diagnosis of a run that diverged: step, time, the first particle that is not finite and the force responsible. It
 * does not change the state. */
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/judge/judge.h"

#include <stdio.h>
#include <stdlib.h>

static size_t first_bad(const double *list, size_t count) {
  size_t k = 0;
  while (k < count && isfinite(list[k])) k++;
  return k;
}

static double size_of(const double *f) { return sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]); }

/* The label of the force whose F is not finite, and the first such particle in *particle; if F of every force is finite
 * and *particle is given, the label of the largest force on it. *newton: the size of that force. */
static const char *find_force(hk_loop *loop, const double *X, size_t n, size_t *particle, double *newton) {
  double *F = malloc((3 * n + 1) * sizeof *F), largest = -1;
  const char *label = NULL;
  for (size_t k = 0; F && k < loop->plugins->kind[HK_FORCE].count; k++) {
    if (!loop->dynamics->force_acts[k] || !hk_query_force(loop->dynamics, k, X, n, F)) continue;
    size_t bad = first_bad(F, 3 * n);
    if (bad < 3 * n) {
      if (*particle == n) *particle = bad / 3;
      label = loop->plugins->kind[HK_FORCE].item[k]->label;
      *newton = F[bad];
      break;
    }
    double here = *particle < n ? size_of(F + 3 * *particle) : 0;
    if (*particle < n && here > largest) {
      largest = *newton = here;
      label = loop->plugins->kind[HK_FORCE].item[k]->label;
    }
  }
  free(F);
  return label;
}

/* What did not converge names its particles itself. */
static void remedy(const hk_loop *loop, hk_status cause, char *text, size_t size) {
  if (loop->last_h > hk_step_choice_of(loop)->dt_limit)
    snprintf(text, size, "; the step %g s is above the stable limit %g s: leave dt out or give less", loop->last_h,
             hk_step_choice_of(loop)->dt_limit);
  else if (cause == HK_NOT_CONVERGED || loop->method->flags & HK_IMPLICIT)
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

/* Writes the diagnosis: a particle whose state is not finite, a force that is not finite, or, where the method keeps
 * the last finite state, its fastest particle. */
static void explain(hk_loop *loop, const hk_judgement *j, char *text, size_t size) {
  size_t n = loop->state->model.n, bad = first_bad(loop->state->X, 6 * n), particle = n;
  double newton = NAN;
  const char *label = NULL;
  if (bad == 6 * n) {
    label = find_force(loop, loop->state->X, n, &particle, &newton);
    if (label) {
      snprintf(text, size, "particle %u gets a force that is not finite from '%s'", loop->state->id[particle], label);
      return;
    }
    particle = fastest(loop->state->X + 3 * n, n);
    label = find_force(loop, loop->state->X, n, &particle, &newton);
  } else {
    particle = bad % (3 * n) / 3;
    if (j->last_good.n == n) label = find_force(loop, j->last_good.X, n, &particle, &newton);
  }
  snprintf(text, size, "particle %u %s%s%s%s", loop->state->id[particle],
           bad < 6 * n ? "has a position or velocity that is not finite" : "was the fastest",
           label ? "; the largest force on it was '" : "", label ? label : "", label ? "'" : "");
}

hk_status hk_diagnose(hk_loop *loop, hk_judgement *j, hk_status cause) {
  char fix[200], what[400];
  remedy(loop, cause, fix, sizeof fix);
  if (cause == HK_NOT_CONVERGED)
    snprintf(j->reason, sizeof j->reason, "did not converge at step %zu, t = %g s: %.700s%s", loop->record->steps + 1,
             loop->state->t, loop->error->text, fix);
  else {
    explain(loop, j, what, sizeof what);
    snprintf(j->reason, sizeof j->reason, "diverged at step %zu, t = %g s: %s%s", loop->record->steps + 1,
             loop->state->t, what, fix);
  }
  return cause;
}
