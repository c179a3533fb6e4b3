/* See barrier_contacts.h. Every chunk of `near` writes the values of its pairs that act to its own part of `values`,
 * from the start on; `acting` then lists them all. */
#include "plugins/common/contact/barrier/barrier_contacts.h"

#include <string.h>

typedef struct task {
  const hk_barrier_contacts *contacts;
  const double *x;
  hk_barrier_value *values;
  hk_barrier_tally *tally;
} task;

static void evaluate_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_barrier_pair *near = t->contacts->near.item;
  hk_barrier_tally tally = {0};
  for (size_t k = begin; k < end; k++) {
    hk_barrier_value *v = &t->values[begin + tally.acting];
    if (hk_barrier_is_apart(&near[k], &t->contacts->law, t->x)) continue;
    if (!hk_barrier_evaluate(&near[k], &t->contacts->law, t->x, v)) continue;
    v->near = (uint32_t)k;
    tally.acting++;
    tally.touching += v->gap <= 0;
  }
  t->tally[chunk] = tally;
}

static bool are_known(const hk_barrier_contacts *c, const hk_view *view) {
  return c->evaluated && c->evaluated_stiffness == c->law.stiffness &&
         memcmp(c->at.item, view->x, 3 * view->n * sizeof *view->x) == 0;
}

void hk_barrier_values_at(hk_barrier_contacts *c, const hk_view *view) {
  task t = {c, view->x, c->values.item, c->tally.item};
  uint32_t *acting = c->acting.item;
  if (c->found == 0) c->acting_count = c->touching = 0; /* nothing was looked for yet: there is no memory either */
  if (c->found == 0 || are_known(c, view)) return;
  view->host->parallel_for(view->host, c->found, HK_BARRIER_GRAIN, evaluate_chunk, &t);
  c->acting_count = c->touching = 0;
  for (size_t chunk = 0; chunk * HK_BARRIER_GRAIN < c->found; chunk++) {
    for (uint32_t k = 0; k < t.tally[chunk].acting; k++)
      acting[c->acting_count++] = (uint32_t)(chunk * HK_BARRIER_GRAIN) + k;
    c->touching += t.tally[chunk].touching;
  }
  memcpy(c->at.item, view->x, 3 * view->n * sizeof *view->x);
  c->evaluated_stiffness = c->law.stiffness;
  c->evaluated = true;
}

const hk_barrier_value *hk_barrier_acting(const hk_barrier_contacts *c, size_t k) {
  const hk_barrier_value *values = c->values.item;
  return &values[((const uint32_t *)c->acting.item)[k]];
}
