/* See barrier_sum.h. */
#include "plugins/common/barrier/barrier_sum.h"

#include <string.h>

typedef struct task {
  const hk_barrier_contacts *contacts;
  const hk_barrier_pair *near;
  const double *x;
  double *sums;  /* of the chunks */
  double *loads; /* 12 of every pair: minus the gradient, the first NAN where the pair does not act */
  bool definite;
  const uint32_t *acting;
  double *H; /* 144 of every pair of a batch */
} task;

static task begin(const hk_barrier_contacts *c, const hk_view *view) {
  return (task){.contacts = c, .near = c->near.item, .x = view->x, .sums = c->sums.item, .loads = c->loads.item};
}

/* ---- energy and force ---- */

static void energy_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  hk_barrier_value v;
  double sum = 0;
  for (size_t k = first; k < end; k++)
    if (hk_barrier_evaluate(&t->near[k], &t->contacts->law, t->x, &v)) sum += v.m * v.E;
  t->sums[chunk] = sum;
}

double hk_barrier_energy(const hk_barrier_contacts *c, const hk_view *view) {
  task t = begin(c, view);
  double sum = 0;
  view->host->parallel_for(view->host, c->found, HK_BARRIER_GRAIN, energy_chunk, &t);
  for (size_t k = 0; k * HK_BARRIER_GRAIN < c->found; k++) sum += t.sums[k];
  return isnan(sum) ? INFINITY : sum; /* 0 times infinity, of parallel edges that touch */
}

static void force_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  hk_barrier_value v;
  double touching = 0;
  for (size_t k = first; k < end; k++) {
    t->loads[12 * k] = NAN;
    if (!hk_barrier_evaluate(&t->near[k], &t->contacts->law, t->x, &v)) continue;
    touching += v.gap <= 0;
    hk_barrier_gradient(&v, t->loads + 12 * k);
  }
  t->sums[chunk] = touching;
}

hk_status hk_barrier_add(const hk_barrier_contacts *c, const hk_view *view, double *F) {
  task t = begin(c, view);
  view->host->parallel_for(view->host, c->found, HK_BARRIER_GRAIN, force_chunk, &t);
  for (size_t k = 0; k * HK_BARRIER_GRAIN < c->found; k++)
    if (t.sums[k] > 0) return HK_NOT_FINITE;
  for (size_t k = 0; k < c->found; k++)
    for (size_t e = 0; e < 12 && !isnan(t.loads[12 * k]); e++)
      F[3 * (size_t)t.near[k].pair.vertex[e / 3] + e % 3] -= t.loads[12 * k + e];
  return HK_OK;
}

/* ---- blocks ---- */

void hk_barrier_pattern(const hk_barrier_contacts *c, hk_pattern *pattern) {
  const hk_surface_pair *named = c->named.item;
  for (size_t k = 0; k < c->named.count; k++)
    for (int e = 0; e < 16; e++) pattern->block(pattern, named[k].vertex[e / 4], named[k].vertex[e % 4]);
}

/* Collects the pairs that act, in their order. False: one of them has no name. */
static bool collect(const task *t, uint32_t *acting, size_t *count) {
  hk_barrier_value v;
  for (size_t k = 0; k < t->contacts->found; k++) {
    if (!hk_barrier_evaluate(&t->near[k], &t->contacts->law, t->x, &v)) continue;
    if (t->near[k].name == UINT32_MAX) return false;
    acting[(*count)++] = (uint32_t)k;
  }
  return true;
}

static void hessian_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  hk_barrier_value v;
  (void)chunk;
  for (size_t k = first; k < end; k++) {
    const hk_barrier_pair *p = &t->near[t->acting[k]];
    hk_barrier_evaluate(p, &t->contacts->law, t->x, &v);
    hk_barrier_hessian(p, &v, t->definite, t->H + 144 * k);
  }
}

static void scatter(const double H[144], const size_t slot[16], double *K) {
  for (size_t b = 0; b < 16; b++)
    for (size_t e = 0; e < 9; e++) K[9 * slot[b] + e] += H[12 * (3 * (b / 4) + e / 3) + 3 * (b % 4) + e % 3];
}

hk_status hk_barrier_jacobian(const hk_barrier_contacts *c, const hk_view *view, const hk_blocks *into) {
  task t = begin(c, view);
  size_t count = 0, batch = HK_BARRIER_BATCH;
  t.definite = into->want & HK_WANT_DEFINITE;
  t.H = c->hessians.item;
  uint32_t *acting = c->acting.item;
  if (!collect(&t, acting, &count))
    return view->host->fail(view->host, HK_FAILED, "a contact without blocks: its `update` was not called");
  for (size_t at = 0; at < count; at += batch) {
    size_t some = count - at < batch ? count - at : batch;
    t.acting = acting + at;
    view->host->parallel_for(view->host, some, 64, hessian_chunk, &t);
    for (size_t k = 0; k < some; k++)
      scatter(t.H + 144 * k, into->slot + 16 * (size_t)t.near[t.acting[k]].name, into->K);
  }
  return HK_OK;
}
