/* Which one-sided equations take part in an impact, and how fast they open after it. An equation that closes at the
 * speed u opens at e u with its coefficient of restitution e (Newton's law; with several equations Moreau's: each opens
 * at e u at least, and has an impulse where it does so exactly). Below the speed `still` it stays closed: bounces would
 * follow each other ever faster (Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics). */
#include "core/numerics/constraints/constraints.h"

#include <stdlib.h>
#include <string.h>

static void ask(hk_constraints *c, const hk_instance *instance, size_t first) {
  if (!instance->plugin->constraint->restitution) return;
  const hk_instance *outer = hk_enter(instance);
  instance->plugin->constraint->restitution(instance->self, c->bounce + first, c->still + first);
  hk_leave(instance, outer);
}

hk_status hk_restitution_open(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  const hk_instances *list = &d->plugins->kind[HK_CONSTRAINT];
  bool any = false;
  for (size_t k = 0; k < list->count; k++) any |= list->item[k]->plugin->constraint->restitution != NULL;
  if (!any) return HK_OK;
  c->bounce = calloc(3 * c->equations + 1, sizeof *c->bounce);
  if (!c->bounce) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu equations", c->equations);
  c->still = c->bounce + c->equations, c->opening = c->still + c->equations;
  for (size_t k = 0; k < list->count; k++) ask(c, list->item[k], c->equation_first[k]);
  return HK_OK;
}

void hk_restitution_begin(hk_constraints *c, const double *x, const double *v) {
  double size = hk_constraint_extent(c, x);
  hk_constraint_rate(c, v, c->residual, c->correction);
  for (size_t k = 0; k < c->equations; k++) {
    c->allowed[k] = c->one_sided[k] && hk_constraint_touches(c, k, size);
    if (c->bounce) c->opening[k] = c->allowed[k] && c->residual[k] < -c->still[k] ? -c->bounce[k] * c->residual[k] : 0;
  }
}

void hk_restitution_subtract(const hk_constraints *c, double *rate) {
  for (size_t k = 0; k < c->equations && c->bounce; k++) rate[k] -= c->opening[k];
}
