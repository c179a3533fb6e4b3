/* Energies, forces and strains of one state, computed apart from the evaluation of f for figures, verdicts and
 * scripts. */
#include "core/engine/contract/contract.h"
#include "core/engine/evaluate/evaluate.h"
#include "core/plugin/strain.h"

#include <math.h>
#include <string.h>

double hk_query_potential(hk_dynamics *d, double t, const double *X) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  double sum = 0;
  if (d->lost) return NAN;
  for (size_t k = 0; k < forces->count; k++) {
    const hk_instance *force = forces->item[k];
    if (!d->force_acts[k] || !d->takes[k] || !force->plugin->force->energy || hk_work_unaccounted(force)) continue;
    hk_view view = hk_force_view_at(d, k, t, X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    sum += force->plugin->force->energy(force->self, &view);
    hk_leave(force, outer);
  }
  return sum;
}

/* What a scripted pin does through a constraint is not measured, nor what a constraint does as its parameters change.
 */
bool hk_query_has_energy(const hk_dynamics *d) {
  const hk_instances *constraints = &d->plugins->kind[HK_CONSTRAINT];
  for (size_t k = 0; k < constraints->count; k++)
    if (constraints->item[k]->spec->timed_count > 0) return false;
  return true;
}

bool hk_query_force(hk_dynamics *d, size_t k, const double *X, size_t n, double *F) {
  const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
  if (d->lost) return false;
  hk_view view = hk_force_view_at(d, k, d->state->t, X, n);
  double power = 0;
  hk_error kept = *d->error;
  view.power = &power;
  memset(F, 0, 3 * n * sizeof *F);
  const hk_instance *outer = hk_enter(force);
  bool fine = hk_force_add(force, &view, F) == HK_OK;
  hk_leave(force, outer);
  *d->error = kept;
  return fine;
}

/* ---- particles that stand alone ---- */

enum { MOST_ALONE = 256, MOST_BLOCKS = 4 * MOST_ALONE };

typedef struct own_blocks {
  hk_pattern pattern; /* first member: what the force gets */
  size_t begin, end, count, slot[MOST_BLOCKS];
  bool coupled;
} own_blocks;

static void note_block(hk_pattern *pattern, uint32_t row, uint32_t column) {
  own_blocks *b = (own_blocks *)(void *)pattern;
  b->coupled |= row != column || row < b->begin || row >= b->end || b->count == MOST_BLOCKS;
  if (!b->coupled) b->slot[b->count++] = row - b->begin;
}

/* The force's view of some particles, of those that it acts on. */
static hk_view view_of_some(const hk_dynamics *d, size_t k, size_t begin, size_t end, uint32_t active[MOST_ALONE]) {
  hk_view view = d->force_view[k];
  const bool *is_active = view.is_active;
  view.acting = 0;
  for (size_t i = begin; i < end; i++)
    if (!is_active || is_active[i]) active[view.acting++] = (uint32_t)i;
  view.active = active;
  view.t = d->system.t;
  view.power = NULL;
  return view;
}

static bool add_alone(const hk_instance *force, const hk_view *view, own_blocks *blocks, double *F, double (*K)[9],
                      double (*D)[9]) {
  const hk_force_tables *f = hk_force_of(force->plugin);
  if (f->elements.list || f->steps.update) return false;
  if (!f->implicit.jacobian && f->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V)) return false;
  if (view->acting == 0) return true;
  blocks->count = 0;
  if (f->implicit.pattern) f->implicit.pattern(force->self, view, &blocks->pattern);
  if (blocks->coupled || (F && hk_force_add(force, view, F) != HK_OK)) return false;
  hk_blocks into = {.slot = blocks->slot, .K = K[0], .D = D[0]};
  return !f->implicit.jacobian || f->implicit.jacobian(force->self, view, &into) == HK_OK;
}

bool hk_query_uncoupled(hk_system *s, const double *x, const double *v, size_t begin, size_t end, double *F,
                        double (*K)[9], double (*D)[9]) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  own_blocks blocks = {.pattern.block = note_block, .begin = begin, .end = end};
  hk_error kept = *d->error;
  bool fine = !d->constrain && d->state->model.riders == 0 && end - begin <= MOST_ALONE;
  memset(K, 0, (end - begin) * sizeof *K);
  memset(D, 0, (end - begin) * sizeof *D);
  if (F) memset(F + 3 * begin, 0, 3 * (end - begin) * sizeof *F);
  for (size_t k = 0; k < d->split.forces && fine; k++) {
    const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    uint32_t active[MOST_ALONE];
    hk_view view = view_of_some(d, k, begin, end, active);
    view.x = x, view.v = v;
    if (!d->force_acts[k]) continue;
    const hk_instance *outer = hk_enter(force);
    fine = add_alone(force, &view, &blocks, F, K, D);
    hk_leave(force, outer);
  }
  *d->error = kept;
  return fine;
}

/* ---- strains ---- */

/* By magnitude; a strain that is not finite is the largest. */
static double largest_of(const hk_elements *e, const double *x) {
  double largest = 0;
  for (size_t k = 0; hk_elements_strained(e) && k < e->node.count; k++) {
    double strain = hk_element_strain(e, x, k);
    if (hk_element_is_strained(e, k) && !(fabs(strain) <= fabs(largest))) largest = strain;
  }
  return largest;
}

double hk_query_strain(const hk_dynamics *d, const char *label, bool *found) {
  double largest = 0;
  *found = false;
  for (size_t k = 0; k < d->state->model.element_lists; k++) {
    if (label && strcmp(d->element_list[k].force, label) != 0) continue;
    *found = true;
    const hk_instance *force = d->plugins->kind[HK_FORCE].item[d->element_list[k].index], *outer = hk_enter(force);
    double strain = largest_of(&d->element_list[k].elements, d->state->X);
    hk_leave(force, outer);
    if (fabs(strain) > fabs(largest) || isnan(strain)) largest = strain;
  }
  return largest;
}
