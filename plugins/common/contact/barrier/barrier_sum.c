/* See barrier_sum.h. */
#include "plugins/common/contact/barrier/barrier_sum.h"

typedef struct task {
  const hk_barrier_contacts *contacts;
  const hk_barrier_pair *near;
  const double *x;
  double *sums;  /* of the chunks */
  double *loads; /* 12 of every pair that acts: minus the force */
} task;

static task begin(hk_barrier_contacts *c, const hk_view *view) {
  hk_barrier_values_at(c, view);
  return (task){c, c->near.item, view->x, c->sums.item, c->loads.item};
}

static void energy_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  double sum = 0;
  for (size_t k = first; k < end; k++) {
    const hk_barrier_value *v = hk_barrier_acting(t->contacts, k);
    sum += v->m * v->E;
  }
  t->sums[chunk] = sum;
}

double hk_barrier_energy(hk_barrier_contacts *c, const hk_view *view) {
  task t = begin(c, view);
  double sum = 0;
  view->host->parallel_for(view->host, c->acting_count, HK_BARRIER_GRAIN, energy_chunk, &t);
  for (size_t k = 0; k * HK_BARRIER_GRAIN < c->acting_count; k++) sum += t.sums[k];
  return isnan(sum) ? INFINITY : sum; /* 0 times infinity, of parallel edges that touch */
}

static void force_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = first; k < end; k++) {
    const hk_barrier_value *v = hk_barrier_acting(t->contacts, k);
    hk_barrier_gradient(&t->near[v->near], v, t->x, t->loads + 12 * k);
  }
}

hk_status hk_barrier_add(hk_barrier_contacts *c, const hk_view *view, double *F) {
  task t = begin(c, view);
  if (c->touching) return HK_NOT_FINITE;
  view->host->parallel_for(view->host, c->acting_count, HK_BARRIER_GRAIN, force_chunk, &t);
  for (size_t k = 0; k < c->acting_count; k++) {
    const uint32_t *vertex = t.near[hk_barrier_acting(c, k)->near].pair.vertex;
    for (size_t e = 0; e < 12; e++) F[3 * (size_t)vertex[e / 3] + e % 3] -= t.loads[12 * k + e];
  }
  return HK_OK;
}
