/* Indices change when particles die and ids do not: so members are kept by id, and looked up again after every change.
 * Invariant: the loads of a particle are summed in the order of the tuples, whatever thread sums them. */
#include "plugins/common/elements/living_tuples.h"

#include "plugins/kit/vector3.h"

enum { GATHER = 2048 }; /* particles of a chunk, some 30 us */

static hk_status no_memory(const hk_view *view, size_t count, const char *what) {
  return view->host->fail(view->host, HK_NO_MEMORY, "no memory for %zu %s", count, what);
}

hk_status hk_living_tuples_create(hk_living_tuples *l, const hk_view *view, const hk_tuples *node, const char *what) {
  const hk_host *host = view->host;
  size_t corners = node->count * node->arity;
  l->count = node->count;
  l->id = host->allocate(host, (corners + 1) * sizeof *l->id);
  l->number = host->allocate(host, (node->count + 1) * sizeof *l->number);
  l->acting = (hk_tuples){0, node->arity, host->allocate(host, (corners + 1) * sizeof *l->id)};
  if (!l->id || !l->number || !l->acting.index) return no_memory(view, node->count, what);
  for (size_t c = 0; c < corners; c++) l->id[c] = view->model->id[node->index[c]];
  return HK_OK;
}

hk_status hk_living_tuples_load(hk_living_tuples *l, const hk_view *view, const char *what) {
  const hk_host *host = view->host;
  size_t corners = l->count * l->acting.arity;
  l->load = host->allocate(host, (corners + 1) * sizeof *l->load);
  l->corner = host->allocate(host, (corners + 1) * sizeof *l->corner);
  return l->load && l->corner ? HK_OK : no_memory(view, l->count, what);
}

/* Sorts the members of the acting tuples by particle. */
static hk_status sort_corners(hk_living_tuples *l, const hk_view *view) {
  const hk_host *host = view->host;
  size_t corners = l->acting.count * l->acting.arity;
  host->release(host, l->first);
  l->first = host->allocate(host, (view->n + 2) * sizeof *l->first);
  if (!l->first) return no_memory(view, view->n, "particles of elements");
  for (size_t c = 0; c < corners; c++) l->first[l->acting.index[c] + 2]++;
  for (size_t i = 2; i < view->n + 2; i++) l->first[i] += l->first[i - 1];
  for (size_t c = 0; c < corners; c++) l->corner[l->first[l->acting.index[c] + 1]++] = (uint32_t)c;
  return HK_OK;
}

hk_status hk_living_tuples_find(hk_living_tuples *l, const hk_view *view) {
  uint32_t *index = (uint32_t *)(uintptr_t)l->acting.index;
  unsigned arity = l->acting.arity;
  size_t kept = 0;
  for (size_t k = 0; k < l->count; k++) {
    bool acts = true;
    for (unsigned m = 0; m < arity; m++) {
      size_t i = hk_model_find(view->model, l->id[arity * k + m]);
      acts = acts && i < view->n && (!view->is_active || view->is_active[i]);
      index[arity * kept + m] = (uint32_t)i;
    }
    if (acts) l->number[kept++] = (uint32_t)k;
  }
  l->acting.count = kept;
  return l->load ? sort_corners(l, view) : HK_OK;
}

typedef struct task {
  const hk_living_tuples *l;
  double *F;
} task;

static void gather_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_living_tuples *l = t->l;
  (void)chunk;
  for (size_t i = begin; i < end; i++)
    for (size_t c = l->first[i]; c < l->first[i + 1]; c++) hk_add_scaled(t->F + 3 * i, 1, l->load[l->corner[c]]);
}

void hk_living_tuples_gather(const hk_living_tuples *l, const hk_view *view, double *F) {
  task t = {l, F};
  if (l->acting.count > 0) view->host->parallel_for(view->host, view->n, GATHER, gather_chunk, &t);
}
