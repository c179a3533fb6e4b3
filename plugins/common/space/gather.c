#include "plugins/common/space/gather.h"

#include <string.h>

enum { LEAST = 64 /* records: room of a new list */ };

typedef struct pass {
  hk_gather *gather;
  size_t total, grain;
  void (*body)(void *context, size_t begin, size_t end, size_t chunk);
  void *context;
  size_t *start;
} pass;

static bool reserve_lists(hk_gather *g, const hk_host *host, size_t chunks) {
  if (chunks <= g->chunks) return true;
  hk_gathered *list = host->allocate(host, chunks * sizeof *list);
  if (!list) return false;
  if (g->chunks) memcpy(list, g->list, g->chunks * sizeof *list);
  host->release(host, g->list);
  g->list = list;
  g->chunks = chunks;
  return true;
}

static void run_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  pass *r = context;
  hk_gathered *l = &r->gather->list[chunk];
  if (l->complete) return;
  l->count = 0;
  r->body(r->context, begin, end, chunk);
}

/* Room for what was counted and half as much, where a list was too short. */
static bool lengthen(hk_gather *g, const hk_host *host, size_t chunks, bool *complete) {
  *complete = true;
  for (size_t k = 0; k < chunks; k++) {
    hk_gathered *l = &g->list[k];
    l->complete = l->count <= l->room;
    if (l->complete) continue;
    size_t room = l->count + l->count / 2 + LEAST;
    host->release(host, l->record);
    l->record = host->allocate(host, room * g->record_size);
    l->room = l->record ? room : 0;
    if (!l->record) return false;
    *complete = false;
  }
  return true;
}

static void copy_chunk(void *context, size_t begin, size_t end, size_t part) {
  const pass *r = context;
  hk_gather *g = r->gather;
  (void)part;
  for (size_t k = begin; k < end; k++)
    if (g->list[k].count)
      memcpy((char *)g->record + r->start[k] * g->record_size, g->list[k].record, g->list[k].count * g->record_size);
}

static bool join(pass *r, const hk_host *host, size_t chunks) {
  hk_gather *g = r->gather;
  g->count = 0;
  r->start = host->allocate(host, chunks * sizeof *r->start);
  if (!r->start) return false;
  for (size_t k = 0; k < chunks; g->count += g->list[k++].count) r->start[k] = g->count;
  if (g->count > g->room) {
    size_t room = g->count + g->count / 2;
    host->release(host, g->record);
    g->record = host->allocate(host, room * g->record_size);
    g->room = g->record ? room : 0;
  }
  bool fine = g->count <= g->room;
  if (fine) host->parallel_for(host, chunks, 8, copy_chunk, r);
  host->release(host, r->start);
  return fine;
}

hk_status hk_gather_run(hk_gather *g, const hk_host *host, size_t count, size_t grain,
                        void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  pass r = {.gather = g, .total = count, .grain = grain, .body = body, .context = context};
  size_t chunks = (count + grain - 1) / grain;
  bool fine = reserve_lists(g, host, chunks), complete = false;
  g->count = 0;
  for (size_t k = 0; fine && k < chunks; k++) g->list[k].complete = false;
  while (fine && !complete) {
    host->parallel_for(host, count, grain, run_chunk, &r);
    fine = lengthen(g, host, chunks, &complete);
  }
  fine = fine && join(&r, host, chunks);
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for a list of pairs");
}

void hk_gather_free(hk_gather *g, const hk_host *host) {
  for (size_t k = 0; k < g->chunks; k++) host->release(host, g->list[k].record);
  host->release(host, g->list);
  host->release(host, g->record);
  *g = (hk_gather){.record_size = g->record_size};
}
