/* Where within a step a one-sided equation that pushes ceases to: its multiplier falls through 0. The acceleration has
 * a corner there and no jump, so that a step across it has an error of the third order in its length, whatever its
 * method (Hairer, Norsett and Wanner, Solving ODEs I, II.6). Steps of methods above order 2 are therefore taken back
 * and cut there, as at impacts.
 *
 * Evaluations of the step in which such an equation rested show that it may have been released. The multiplier that it
 * would have at the end of the step, as if it were an equality, is then computed there, by one evaluation; it is
 * negative after a release. The instant is found by the secant through the start, and then through the ends of the
 * attempts at the same step, whose multipliers go to 0. A cut at a distance d from the release leaves an error of
 * h d/6 times the rate of the acceleration in the velocity. */

#include "core/numerics/constraints/constraints.h"

#include <stdlib.h>
#include <string.h>

enum { ATTEMPTS = 6 }; /* cuts of one step of the loop, at most */

/* To an end of the step, in parts of it: d above; and the change of a multiplier, in parts of the largest so far, in
 * which its zero does not matter, as the step then is short by as much. */
static const double close_enough = 1e-10, no_change = 1e-9;

void hk_release_begin(hk_constraints *c) { memset(c->releases.freed, 0, c->equations * sizeof *c->releases.freed); }

void hk_release_note(hk_constraints *c, bool at_start) {
  hk_releases *r = &c->releases;
  for (size_t k = 0; k < c->equations; k++) {
    if (!c->touches[k]) continue;
    r->acts[k] |= c->pushes[k];
    r->freed[k] |= !c->pushes[k];
    if (at_start) r->before[k] = c->solution[k];
    r->most[k] = fmax(r->most[k], c->solution[k]);
  }
}

void hk_release_end(hk_constraints *c) {
  memcpy(c->releases.acts, c->pushes, c->equations * sizeof *c->pushes);
  memcpy(c->releases.before, c->lambda, c->equations * sizeof *c->lambda);
}

static bool may_release(const hk_constraints *c, size_t k) {
  const hk_releases *r = &c->releases;
  return c->touches[k] && r->acts[k] && r->freed[k] && r->before[k] > 0;
}

/* r->after, by an evaluation at the end of the step. The set of equations that act stays that of the last evaluation of
 * the step, whose factors a method may go on with. */
static hk_status weigh(hk_dynamics *d, double t, double *x, double *v) {
  hk_constraints *c = d->constraints;
  hk_releases *r = &c->releases;
  size_t n = d->state->model.n, m = c->equations;
  double *a = r->slope;
  memcpy(r->rests, c->rests, m * sizeof *r->rests);
  memcpy(r->scale, c->scale, m * sizeof *r->scale);
  c->table.takes_constraints = r->weighing = true;
  hk_status status = d->system.accelerations(&d->system, t, x, v, x + 6 * n, a, a + 3 * n);
  r->weighing = false;
  memcpy(r->after, c->solution, m * sizeof *r->after);
  memcpy(c->rests, r->rests, m * sizeof *r->rests);
  memcpy(c->scale, r->scale, m * sizeof *r->scale);
  return status;
}

hk_status hk_release_solve(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) {
    c->rests[k] = c->one_sided[k] ? !(c->touches[k] && c->releases.acts[k]) : c->implied[k];
    c->rhs[k] = -c->c[k];
  }
  hk_constraint_matrix_rest(c);
  hk_status status = hk_constraint_matrix_factorize(d);
  return status == HK_OK ? hk_constraint_matrix_solve(d) : status;
}

/* The part of the step at which the multiplier of k is 0, which is `left` at its end. */
static double root(const hk_releases *r, size_t k, double begin, double h, double left) {
  double slope = (left - r->before[k]) / h, end = begin + h;
  if (r->equation == k && r->begin == begin && r->end > end && r->left != left) {
    double secant = (left - r->left) / (end - r->end), part = 1 - left / (secant * h);
    if (secant < 0 && part > 0) return part;
  }
  return 1 - left / (slope * h);
}

/* Whether a step to `end` may be cut once more; one that is not part of a step that was cut before may. */
static bool may_cut(hk_releases *r, double end) {
  if (!(end <= r->until)) r->until = end, r->cuts = 0;
  return r->cuts < ATTEMPTS;
}

hk_status hk_constraints_release(hk_dynamics *d, double t, double *x, double *v, double h, double *part) {
  hk_constraints *c = d->constraints;
  hk_releases *r = &c->releases;
  bool any = false;
  size_t first = SIZE_MAX;
  if (hk_constraint_order(d) <= HK_RELEASE_MATTERS) return HK_OK;
  for (size_t k = 0; k < c->equations && !any; k++) any = may_release(c, k);
  if (!any || !may_cut(r, t)) return HK_OK;
  hk_status status = weigh(d, t, x, v);
  if (status != HK_OK) return status;
  double least = *part;
  for (size_t k = 0; k < c->equations; k++) {
    if (!may_release(c, k) || !(r->after[k] < 0) || r->before[k] - r->after[k] <= no_change * r->most[k]) continue;
    double at = root(r, k, t - h, h, r->after[k]);
    bool inside = at > close_enough && at < 1 - close_enough && t - h + at * h > t - h;
    if (inside && at < least) least = at, first = k;
  }
  if (first == SIZE_MAX) return HK_OK;
  r->equation = first, r->begin = t - h, r->end = t, r->left = r->after[first];
  r->cuts++;
  *part = least;
  return HK_OK;
}

/* ---- the lists of what is noted, for the equations that there are ---- */

hk_status hk_releases_open(hk_dynamics *d) {
  hk_releases *r = &d->constraints->releases;
  size_t m = d->constraints->equations + 1;
  bool **sets[] = {&r->acts, &r->freed, &r->rests};
  double **lists[] = {&r->before, &r->most, &r->after, &r->scale, &r->slope};
  bool fine = true;
  for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) fine &= (*sets[k] = calloc(m, sizeof **sets[k])) != NULL;
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
    fine &= (*lists[k] = calloc(m + d->state->size, sizeof **lists[k])) != NULL;
  return fine ? HK_OK : hk_error_set(d->error, HK_NO_MEMORY, "no memory for the constraints");
}

static void forget_releases(hk_constraints *c) {
  hk_releases *r = &c->releases;
  for (size_t k = 0; k < c->equations; k++) {
    r->acts[k] = r->freed[k] = false;
    r->before[k] = r->most[k] = 0;
  }
  r->equation = r->cuts = 0;
  r->begin = r->end = r->left = r->until = 0;
}

void hk_constraints_forget(hk_dynamics *d) {
  if (!d->constraints) return;
  d->constraints->kept = false;
  forget_releases(d->constraints);
}

void hk_releases_close(hk_releases *r) {
  void *lists[] = {r->acts, r->freed, r->rests, r->before, r->most, r->after, r->scale, r->slope};
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) free(lists[k]);
}
