#include "plugins/common/space/gather.h"

#include <string.h>

enum { LEAST = 64 /* records: room of a new list */, ROWS = 1024 /* that a thread copies at a time */ };

typedef struct pass {
  hk_gather *gather;
  void (*body)(void *context, size_t begin, size_t end, size_t chunk);
  void *context;
} pass;

static hk_status no_memory(const hk_host *host) {
  return host->fail(host, HK_NO_MEMORY, "no memory for a list of pairs");
}

static bool reserve(hk_gather *g, const hk_host *host, size_t rows, size_t chunks) {
  if (chunks > g->chunks) {
    hk_gathered *list = host->allocate(host, chunks * sizeof *list);
    if (!list) return false;
    if (g->chunks) memcpy(list, g->list, g->chunks * sizeof *list);
    host->release(host, g->list);
    g->list = list;
    g->chunks = chunks;
  }
  if (rows > g->row_room) {
    host->release(host, g->row);
    g->row = host->allocate(host, rows * sizeof *g->row);
    g->row_room = g->row ? rows : 0;
  }
  return rows <= g->row_room;
}

static void run_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const pass *p = context;
  hk_gathered *l = &p->gather->list[chunk];
  if (l->complete) return;
  l->count = 0;
  p->body(p->context, begin, end, chunk);
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

hk_status hk_gather_run(hk_gather *g, const hk_host *host, size_t rows, size_t count, size_t grain,
                        void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  pass p = {g, body, context};
  size_t chunks = (count + grain - 1) / grain;
  g->count = g->rows = 0;
  if (!reserve(g, host, rows, chunks)) return no_memory(host);
  if (rows) memset(g->row, 0, rows * sizeof *g->row);
  for (size_t k = 0; k < chunks; k++) g->list[k].complete = false;
  for (bool complete = false; !complete;) {
    host->parallel_for(host, count, grain, run_chunk, &p);
    if (!lengthen(g, host, chunks, &complete)) return no_memory(host);
  }
  g->rows = rows;
  return HK_OK;
}

/* ---- joining ---- */

static void copy_rows(void *context, size_t begin, size_t end, size_t part) {
  hk_gather *g = context;
  (void)part;
  for (size_t r = begin; r < end; r++)
    if (g->row[r].count)
      memcpy((char *)g->record + g->row[r].at * g->record_size, hk_gather_records(g, r),
             g->row[r].count * g->record_size);
}

hk_status hk_gather_join(hk_gather *g, const hk_host *host) {
  g->count = 0;
  for (size_t r = 0; r < g->rows; g->count += g->row[r++].count) g->row[r].at = g->count;
  if (g->count > g->room) {
    size_t room = g->count + g->count / 2;
    host->release(host, g->record);
    g->record = host->allocate(host, room * g->record_size);
    g->room = g->record ? room : 0;
  }
  if (g->count > g->room) {
    g->count = 0;
    return no_memory(host);
  }
  host->parallel_for(host, g->rows, ROWS, copy_rows, g);
  return HK_OK;
}

void hk_gather_free(hk_gather *g, const hk_host *host) {
  for (size_t k = 0; k < g->chunks; k++) host->release(host, g->list[k].record);
  host->release(host, g->list);
  host->release(host, g->row);
  host->release(host, g->record);
  *g = (hk_gather){.record_size = g->record_size};
}
