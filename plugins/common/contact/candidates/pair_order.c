/* See pair_order.h. Positions of pairs are sorted, not pairs: by counting into a bucket for each kind and first
 * particle, and each bucket, of some twenty pairs, by merging. The time is in proportion to the pairs but for buckets
 * of many, which take k log k. */
#include "plugins/common/contact/candidates/pair_order.h"

#include "plugins/common/space/reserve.h"

#include <string.h>

enum { RUN = 16, BUCKETS_GRAIN = 256 };

typedef struct task {
  const hk_feature_pair *pair;
  const uint32_t *start;
  uint32_t *order, *spare;
} task;

static size_t bucket_of(const hk_feature_pair *p, size_t n) { return p->kind * n + p->vertex[0]; }

static void insert(const hk_feature_pair *pair, uint32_t *order, size_t count) {
  for (size_t k = 1; k < count; k++) {
    uint32_t item = order[k];
    size_t at = k;
    for (; at && hk_pair_compare(&pair[item], &pair[order[at - 1]]) < 0; at--) order[at] = order[at - 1];
    order[at] = item;
  }
}

static void merge(const hk_feature_pair *pair, const uint32_t *from, size_t middle, size_t end, uint32_t *to) {
  size_t a = 0, b = middle;
  for (size_t k = 0; k < end; k++)
    to[k] = b == end || (a < middle && hk_pair_compare(&pair[from[a]], &pair[from[b]]) <= 0) ? from[a++] : from[b++];
}

static void sort_bucket(const hk_feature_pair *pair, uint32_t *order, uint32_t *spare, size_t count) {
  for (size_t k = 0; k < count; k += RUN) insert(pair, order + k, count - k < RUN ? count - k : RUN);
  for (size_t run = RUN; run < count; run *= 2) {
    for (size_t k = 0; k < count; k += 2 * run) {
      size_t end = count - k < 2 * run ? count - k : 2 * run;
      merge(pair, order + k, end < run ? end : run, end, spare + k);
    }
    memcpy(order, spare, count * sizeof *order);
  }
}

static void sort_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++)
    sort_bucket(t->pair, t->order + t->start[k], t->spare + t->start[k], t->start[k + 1] - t->start[k]);
}

/* On return start[k] is where bucket k begins. */
static void fill_buckets(const hk_feature_pair *pair, size_t count, size_t n, uint32_t *start, uint32_t *order) {
  memset(start, 0, (2 * n + 2) * sizeof *start);
  for (size_t k = 0; k < count; k++) start[bucket_of(&pair[k], n) + 2]++;
  for (size_t k = 0; k < 2 * n; k++) start[k + 2] += start[k + 1];
  for (size_t k = 0; k < count; k++) order[start[bucket_of(&pair[k], n) + 1]++] = (uint32_t)k;
}

static size_t drop_twins(const hk_feature_pair *pair, uint32_t *order, size_t count) {
  size_t kept = 0;
  for (size_t k = 0; k < count; k++)
    if (!kept || hk_pair_compare(&pair[order[kept - 1]], &pair[order[k]]) != 0) order[kept++] = order[k];
  return kept;
}

hk_status hk_pairs_sort(hk_pair_sorter *s, const hk_host *host, const hk_feature_pair *pair, size_t count, size_t n,
                        size_t *kept) {
  if (count >= UINT32_MAX) return host->fail(host, HK_FAILED, "%zu pairs are more than can be numbered", count);
  hk_status status = hk_reserve_array(host, &s->start, 2 * n + 2);
  if (status == HK_OK) status = hk_reserve_array(host, &s->order, count);
  if (status == HK_OK) status = hk_reserve_array(host, &s->spare, count);
  if (status != HK_OK) return status;
  task t = {pair, s->start.item, s->order.item, s->spare.item};
  fill_buckets(pair, count, n, s->start.item, t.order);
  host->parallel_for(host, 2 * n, BUCKETS_GRAIN, sort_chunk, &t);
  *kept = drop_twins(pair, t.order, count);
  return HK_OK;
}
