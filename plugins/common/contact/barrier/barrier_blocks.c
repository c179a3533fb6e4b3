/* The blocks of the pairs that act. The Hessians of a batch of pairs are computed by all threads, and then added by all
 * of them, each to rows of its own: every block gets its parts in the order of the pairs. */
#include "plugins/common/contact/barrier/barrier_pair.h"
#include "plugins/common/contact/barrier/barrier_sum.h"

/* Parts into which the rows are divided, in turn: as many threads can add. */
enum { PARTS = 16 };

typedef struct task {
  const hk_barrier_contacts *contacts;
  const hk_barrier_pair *near;
  const double *x;
  bool definite;
  size_t first, count; /* of the batch */
  hk_barrier_hessian *hessian;
  const hk_blocks *into;
  int lanes;
} task;

void hk_barrier_pattern(const hk_barrier_contacts *c, hk_pattern *pattern) {
  const hk_feature_pair *named = c->named.item;
  for (size_t k = 0; k < c->named.count; k++)
    for (int e = 0; e < 16; e++) pattern->block(pattern, named[k].vertex[e / 4], named[k].vertex[e % 4]);
}

static void hessian_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    const hk_barrier_value *v = hk_barrier_acting(t->contacts, t->first + k);
    hk_barrier_hessian_of(&t->near[v->near], v, t->x, t->definite, &t->hessian[k]);
  }
}

HK_INLINE void add_rows(const task *t, size_t part) {
  for (size_t k = 0; k < t->count; k++) {
    const hk_barrier_pair *p = &t->near[hk_barrier_acting(t->contacts, t->first + k)->near];
    const size_t *slot = t->into->slot + 16 * (size_t)p->name;
    for (int i = 0; i < 4; i++)
      if (p->pair.vertex[i] % PARTS == part) hk_barrier_hessian_row(&t->hessian[k], i, slot + 4 * i, t->into->K);
  }
}

HK_VERSIONS(static void, add_rows_of, (const task *t, size_t part), add_rows(t, part))

static void add_part(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)begin, (void)end;
  HK_WIDEST(t->lanes, add_rows_of)(t, chunk);
}

static bool all_named(const hk_barrier_contacts *c) {
  const hk_barrier_pair *near = c->near.item;
  for (size_t k = 0; k < c->acting_count; k++)
    if (near[hk_barrier_acting(c, k)->near].name == UINT32_MAX) return false;
  return true;
}

hk_status hk_barrier_jacobian(hk_barrier_contacts *c, const hk_view *view, const hk_blocks *into) {
  const hk_host *host = view->host;
  task t = {c, c->near.item, view->x, into->want & HK_WANT_DEFINITE, 0, 0, c->hessians.item, into, host->lanes};
  hk_barrier_values_at(c, view);
  if (!all_named(c)) return host->fail(host, HK_FAILED, "a contact without blocks: its `update` was not called");
  for (; t.first < c->acting_count; t.first += HK_BARRIER_BATCH) {
    t.count = c->acting_count - t.first < HK_BARRIER_BATCH ? c->acting_count - t.first : HK_BARRIER_BATCH;
    host->parallel_for(host, t.count, 64, hessian_chunk, &t);
    host->parallel_for(host, PARTS, 1, add_part, &t);
  }
  return HK_OK;
}
