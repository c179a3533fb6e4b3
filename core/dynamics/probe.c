/* Energies, forces and strains of one state, computed apart from the evaluation of f for figures, verdicts and
 * scripts. */
#include "core/dynamics/dynamics.h"

#include <string.h>

double hk_probe_potential(hk_dynamics *d, double t, const double *X) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  double sum = 0;
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
bool hk_probe_has_energy(const hk_dynamics *d) {
  const hk_instances *constraints = &d->plugins->kind[HK_CONSTRAINT];
  for (size_t k = 0; k < constraints->count; k++)
    if (constraints->item[k]->spec->timed_count > 0) return false;
  return true;
}

bool hk_probe_force(hk_dynamics *d, size_t k, const double *X, size_t n, double *F) {
  const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
  hk_view view = hk_force_view_at(d, k, d->state->t, X, n);
  double power = 0;
  hk_error kept = *d->error;
  view.power = &power;
  memset(F, 0, 3 * n * sizeof *F);
  const hk_instance *outer = hk_enter(force);
  bool fine = force->plugin->force->add(force->self, &view, F) == HK_OK;
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
  const hk_force *functions = force->plugin->force;
  if (functions->elements || functions->update) return false;
  if (!functions->jacobian && functions->flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V)) return false;
  if (view->acting == 0) return true;
  blocks->count = 0;
  if (functions->pattern) functions->pattern(force->self, view, &blocks->pattern);
  if (blocks->coupled || (F && functions->add(force->self, view, F) != HK_OK)) return false;
  hk_blocks into = {.slot = blocks->slot, .K = K[0], .D = D[0]};
  return !functions->jacobian || functions->jacobian(force->self, view, &into) == HK_OK;
}

bool hk_probe_alone(hk_system *s, const double *x, const double *v, size_t begin, size_t end, double *F, double (*K)[9],
                    double (*D)[9]) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  own_blocks blocks = {.pattern.block = note_block, .begin = begin, .end = end};
  hk_error kept = *d->error;
  bool fine = !d->constraints && end - begin <= MOST_ALONE;
  memset(K, 0, (end - begin) * sizeof *K);
  memset(D, 0, (end - begin) * sizeof *D);
  if (F) memset(F + 3 * begin, 0, 3 * (end - begin) * sizeof *F);
  for (size_t k = 0; k < s->forces && fine; k++) {
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

static double edge_length(const double *x, const uint32_t *pair) {
  const double *a = x + 3 * (size_t)pair[0], *b = x + 3 * (size_t)pair[1];
  double dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
  return sqrt(dx * dx + dy * dy + dz * dz);
}

/* The largest strain by magnitude, C over the rest value, of all numbers C of elements with a function of their own. */
static double largest_general(const hk_elements *e, const double *x) {
  double largest = 0, C[HK_ELEMENT_VALUES], dC[4 * HK_ELEMENT_VALUES][3];
  for (size_t j = 0; j < e->node.count; j++) {
    double rest = hk_tuple_value(&e->rest, j);
    e->evaluate(e->self, x, j, j + 1, C, dC);
    for (unsigned v = 0; v < e->values && rest != 0; v++)
      if (!(fabs(C[v] / rest) <= fabs(largest))) largest = C[v] / rest;
  }
  return largest;
}

static double largest_of_edges(const hk_elements *e, const double *x) {
  double largest = 0;
  for (size_t j = 0; j < e->node.count; j++) {
    double rest = hk_tuple_value(&e->rest, j);
    double strain = rest > 0 ? (edge_length(x, hk_tuple(&e->node, j)) - rest) / rest : 0;
    if (!(fabs(strain) <= fabs(largest))) largest = strain;
  }
  return largest;
}

static double largest_of(const hk_elements *e, const double *x) {
  if (e->rest.count == 0) return 0;
  return e->evaluate ? largest_general(e, x) : largest_of_edges(e, x);
}

double hk_probe_strain(const hk_dynamics *d, const char *label, bool *found) {
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
