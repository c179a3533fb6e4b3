/* The forces of constraints at one state, for scripts. They are what an evaluation at that state gives, whatever
 * method moves the particles and wherever it evaluated last: the multipliers lambda that keep the equations' second
 * derivatives at 0 under the forces of that time, and J^T lambda on the particles. What contact presses comes in
 * impulses after the steps; of the last step they count as their mean force.
 *
 * Equations that follow from others take their part here: all are solved for together, with the multipliers of least
 * norm, so that two bars side by side carry half of the load each. In evaluations they rest, and the motion is the
 * same.
 *
 * Invariant: looking changes nothing. Multipliers and the set of acting equations, from which implicit steps and
 * contacts go on, are put back, and so are counts. */

#include "core/numerics/constraints/constraints.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of a matrix with numbers of the size of 1: rounding in the directions in which it is singular grows by its inverse,
 * and a round of refinement leaves the shift over the smallest eigenvalue. */
static const double share_shift = 1e-6;

/* The number of the equation that comes first among those of constraint k, and behind the last. */
void hk_constraint_range(const hk_dynamics *d, size_t k, size_t *begin, size_t *end) {
  *begin = d->constraints->equation_first[k];
  *end = d->constraints->equation_first[k + 1];
}

/* What correctors pressed in the last step, on its mean. */
static void add_impulses(hk_dynamics *d, double *a, double *F) {
  const hk_instances *correctors = &d->plugins->kind[HK_CORRECTOR];
  size_t n = d->state->model.n;
  for (size_t k = 0; k < correctors->count; k++) {
    const hk_instance *c = correctors->item[k];
    if (!c->plugin->corrector->mean_forces) continue;
    hk_view view = hk_instance_view(c, &d->state->view);
    memset(F, 0, 3 * n * sizeof *F);
    const hk_instance *outer = hk_enter(c);
    c->plugin->corrector->mean_forces(c->self, &view, F);
    hk_leave(c, outer);
    hk_riders_gather(&d->state->model, F);
    for (size_t e = 0; e < 3 * n; e++) a[e] += F[e] * d->state->inverse_mass[e / 3];
  }
}

/* F/m of all forces, with the pins. */
static hk_status free_acceleration(hk_dynamics *d, double *a, double *F) {
  size_t n = d->state->model.n;
  memset(a, 0, 3 * n * sizeof *a);
  for (size_t k = 0; k < d->plugins->kind[HK_FORCE].count; k++) {
    if (!d->force_acts[k]) continue;
    if (!hk_query_force(d, k, d->state->X, n, F))
      return hk_error_set(d->error, HK_FAILED, "the force '%s' failed", d->plugins->kind[HK_FORCE].item[k]->label);
    hk_riders_gather(&d->state->model, F);
    for (size_t e = 0; e < 3 * n; e++) a[e] += F[e] * d->state->inverse_mass[e / 3];
  }
  add_impulses(d, a, F);
  if (d->pins->has_slides) hk_pins_filter(d->pins, a);
  return HK_OK;
}

/* What evaluations leave behind for later steps. */
typedef struct kept {
  double *lambda, *scale;
  bool *sets[5], *copy[5];
  double soft;
  size_t equations;
  hk_counts count;
} kept;

static kept kept_of(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  return (kept){.sets = {c->implied, c->pushes, c->allowed, c->held, c->rests},
                .soft = c->soft,
                .equations = d->constraints->table.equations,
                .count = d->count};
}

static void free_kept(kept *k) {
  free(k->lambda);
  free(k->scale);
  for (int s = 0; s < 5; s++) free(k->copy[s]);
}

static bool keep(hk_dynamics *d, kept *k) {
  const hk_constraints *c = d->constraints;
  size_t m = c->equations + 1;
  *k = kept_of(d);
  k->lambda = malloc(m * sizeof *k->lambda);
  k->scale = malloc(m * sizeof *k->scale);
  bool fine = k->lambda && k->scale;
  for (int s = 0; s < 5; s++) fine &= (k->copy[s] = malloc(m * sizeof(bool))) != NULL;
  if (!fine) return false;
  memcpy(k->lambda, c->lambda, m * sizeof *k->lambda);
  memcpy(k->scale, c->scale, m * sizeof *k->scale);
  for (int s = 0; s < 5; s++) memcpy(k->copy[s], k->sets[s], m * sizeof(bool));
  return true;
}

static void put_back(hk_dynamics *d, const kept *k) {
  hk_constraints *c = d->constraints;
  size_t m = c->equations + 1;
  memcpy(c->lambda, k->lambda, m * sizeof *k->lambda);
  memcpy(c->scale, k->scale, m * sizeof *k->scale);
  for (int s = 0; s < 5; s++) memcpy(k->sets[s], k->copy[s], m * sizeof(bool));
  c->soft = k->soft;
  c->dependent = false;
  d->constraints->table.equations = k->equations;
  d->count = k->count;
}

static void solve_for_all(hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++) c->dependent |= c->implied[k];
  memset(c->implied, 0, c->equations * sizeof *c->implied);
  memset(c->rests, 0, c->equations * sizeof *c->rests);
}

static hk_status find_multipliers(hk_dynamics *d, double *a, double *F) {
  double power = 0, *x = d->state->X, *v = x + 3 * d->state->model.n, t = d->state->t;
  hk_status status = d->has_timed && t != d->timed_at ? hk_dynamics_impose(d, t, x, v) : HK_OK;
  if (status == HK_OK) status = free_acceleration(d, a, F);
  return status == HK_OK ? hk_constraints_accelerate(d, t, x, v, a, &power) : status;
}

/* rhs = J W J^T solution */
static void multiply(hk_constraints *c, size_t n) {
  memset(c->moved, 0, 3 * n * sizeof *c->moved);
  hk_constraint_matrix_move(c, c->moved);
  memset(c->rhs, 0, c->equations * sizeof *c->rhs);
  for (size_t b = 0; b < c->blocks; b++)
    c->rhs[c->list.pair[b][0]] += hk_constraint_dot(c->J[b], c->moved + 3 * (size_t)c->list.pair[b][1]);
}

/* Shares the forces out: among all multipliers with the same forces on what can move those of least norm, whatever the
 * masses are. With A = J J^T the vector l of least norm with A l = A lambda has J^T l = J^T lambda. One-sided equations
 * keep theirs: shared out, one might pull that can only push. */
static hk_status share_out(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  double t = d->state->t, *x = d->state->X, *v = x + 3 * d->state->model.n;
  if (c->one_sided_count) return HK_OK;
  hk_constraint_matrix_forget_masses(d);
  for (size_t k = 0; k < c->equations; k++) c->scale[k] = c->full[k] > 0 ? 1 : 0;
  multiply(c, d->state->model.n);
  hk_status status = hk_constraint_matrix_factorize_shifted(d, share_shift);
  if (status == HK_OK) status = hk_constraint_matrix_solve(d);
  if (status == HK_OK) memcpy(c->lambda, c->solution, c->equations * sizeof *c->lambda);
  return status == HK_OK ? hk_constraint_matrix_linearise(d, t, x, v) : status;
}

hk_status hk_constraint_multipliers(hk_dynamics *d, double *lambda) {
  hk_constraints *c = d->constraints;
  size_t n = d->state->model.n;
  double *a = malloc((6 * n + 1) * sizeof *a);
  kept before;
  hk_status status = HK_NO_MEMORY;
  if (keep(d, &before) && a) {
    solve_for_all(c);
    status = find_multipliers(d, a, a + 3 * n);
    if (status == HK_OK && c->dependent) status = share_out(d);
    memcpy(lambda, c->lambda, c->equations * sizeof *lambda);
    put_back(d, &before);
  } else
    hk_error_set(d->error, status, "no memory for the forces of %zu constraints", c->equations);
  free_kept(&before);
  free(a);
  return status;
}

/* ---- the start of a step: constraints that change, some of them by what they bear ---- */

static hk_status update_one(hk_dynamics *d, const hk_instance *instance, bool *any) {
  bool changed = false;
  if (!instance->plugin->constraint->update) return HK_OK;
  hk_view view = hk_instance_view(instance, &d->state->view);
  const hk_instance *outer = hk_enter(instance);
  hk_status status = instance->plugin->constraint->update(instance->self, &view, &changed);
  hk_leave(instance, outer);
  *any |= changed;
  return hk_constraint_failed(d, instance, view.t, status);
}

/* Where constraint k wants its multipliers; NULL: it does not. */
static double *loads_of(const hk_dynamics *d, size_t k) {
  const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
  if (!instance->plugin->constraint->loads) return NULL;
  const hk_instance *outer = hk_enter(instance);
  double *into = instance->plugin->constraint->loads(instance->self);
  hk_leave(instance, outer);
  return into;
}

/* Tells those that ask what their equations bear; *any: there are some. */
static hk_status tell_loads(hk_dynamics *d, bool *any) {
  hk_constraints *c = d->constraints;
  size_t count = d->plugins->kind[HK_CONSTRAINT].count, begin, end;
  *any = false;
  for (size_t k = 0; k < count; k++) *any |= loads_of(d, k) != NULL;
  if (!*any || c->equations == 0) return HK_OK;
  double *lambda = malloc(c->equations * sizeof *lambda);
  if (!lambda) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the loads of %zu equations", c->equations);
  hk_status status = hk_constraint_multipliers(d, lambda);
  for (size_t k = 0; k < count && status == HK_OK; k++) {
    double *into = loads_of(d, k);
    hk_constraint_range(d, k, &begin, &end);
    if (into) memcpy(into, lambda + begin, (end - begin) * sizeof *into);
  }
  free(lambda);
  return status;
}

static hk_status rebuild(hk_dynamics *d) {
  d->constraints->jumped = true;
  if (d->blocks_changed) d->blocks_changed(d, true);
  return hk_constraints_topology(d);
}

hk_status hk_constraints_update(hk_dynamics *d) {
  bool any = true, changed = false, loaded = true;
  hk_status status = HK_OK;
  while (any && loaded && status == HK_OK) {
    any = false;
    status = tell_loads(d, &loaded);
    for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count && status == HK_OK; k++)
      status = update_one(d, d->plugins->kind[HK_CONSTRAINT].item[k], &any);
    changed |= any;
    if (any && loaded && status == HK_OK) status = rebuild(d);
  }
  if (status != HK_OK) return status;
  hk_release_begin(d->constraints);
  if (!changed) return hk_constraint_find_contacts(d, d->system.t, d->state->X, d->state->X + 3 * d->state->model.n);
  return loaded ? HK_OK : rebuild(d);
}

/* ---- on one particle ---- */

/* The blocks of all constraints as they are named; those of riders are not those of their carriers. */
typedef struct named_blocks {
  size_t *first;
  uint32_t (*pair)[2];
  double (*J)[3];
} named_blocks;

static named_blocks named(const hk_constraints *c) {
  const hk_rider_blocks *r = &c->riding;
  return r->given ? (named_blocks){r->first, r->pair, r->J} : (named_blocks){c->block_first, c->list.pair, c->J};
}

/* The force that draws particle i of block b towards j of the block behind it, for a multiplier of 1 N; 0 where what
 * the equation does is not along their line, to a part in 1e6. */
static double draws(const hk_dynamics *d, const named_blocks *block, size_t b) {
  static const double along = 1e-6;
  const double *x = d->state->X, *p = x + 3 * (size_t)block->pair[b][1], *q = x + 3 * (size_t)block->pair[b + 1][1];
  const double *J = block->J[b], *K = block->J[b + 1];
  double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, l = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), part = 0,
         off = 0;
  for (int e = 0; e < 3; e++) part += J[e] * u[e] / l;
  for (int e = 0; e < 3; e++) off = fmax(off, fmax(fabs(J[e] - part * u[e] / l), fabs(J[e] + K[e])));
  return off <= along * fabs(part) ? part : 0; /* also where l is 0 */
}

void hk_constraint_bar_forces(const hk_dynamics *d, const double *lambda, const hk_pair_forces *into) {
  named_blocks block = named(d->constraints);
  const hk_instances *list = &d->plugins->kind[HK_CONSTRAINT];
  for (size_t k = 0; k < list->count; k++) {
    bool places = list->item[k]->plugin->constraint->flags & HK_DIFFERENCES; /* x, y and z of each pair, no line */
    size_t end = places ? 0 : block.first[k + 1];
    for (size_t b = block.first[k], next; b < end; b = next) {
      uint32_t equation = block.pair[b][0];
      for (next = b + 1; next < end && block.pair[next][0] == equation;) next++;
      double part = next == b + 2 ? draws(d, &block, b) : 0;
      if (part != 0) into->add(into->context, block.pair[b][1], block.pair[b + 1][1], part * lambda[equation]);
    }
  }
}

void hk_constraint_force_on(const hk_dynamics *d, size_t k, const double *lambda, size_t particle, double F[3]) {
  named_blocks block = named(d->constraints);
  memset(F, 0, 3 * sizeof *F);
  for (size_t b = block.first[k]; b < block.first[k + 1]; b++)
    for (int e = 0; e < 3 && block.pair[b][1] == particle; e++) F[e] += lambda[block.pair[b][0]] * block.J[b][e];
}
