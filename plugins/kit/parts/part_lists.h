/* Elements in the order of the parts of a sum (core/plugin/parts.h), and all parts of a force one after the other. */
#ifndef HK_PART_LISTS_H
#define HK_PART_LISTS_H

#include "core/plugin.h"

#define HK_ALL_PARTS SIZE_MAX /* in place of the number of a part */

/* Particles that are not the host's, as one block. */
static inline hk_partition hk_partition_undivided(size_t n) {
  return (hk_partition){.n = n, .bits = 31, .blocks = 1, .width = 1, .domains = 1, .parts = 2};
}

/* The elements of part p are item[first[p]] ... item[first[p + 1] - 1], rising. Of elements with a particle where the
 * force does not act there is none. To be zeroed before the first use. */
typedef struct hk_part_lists {
  size_t count;
  hk_partition partition;
  size_t *first;  /* partition.parts + 1 */
  uint32_t *item; /* count */
} hk_part_lists;

/* To be called in `create` and `topology`. is_active: the view's. HK_NO_MEMORY: it can only be freed. */
static inline hk_status hk_part_lists_sort(hk_part_lists *, const hk_host *host, const hk_partition *,
                                           const hk_tuples *node, const bool *is_active);
static inline void hk_part_lists_free(hk_part_lists *, const hk_host *host);
/* What hk_force.parts has to do. */
static inline void hk_part_lists_touch(const hk_part_lists *, const hk_tuples *node, const hk_part_use *use);

/* Calls body(context, part) for every part p with first[p] < first[p + 1], on all threads: those of a domain in their
 * order, then those across domains, in rounds that share none. What bodies add to the particles of their part has the
 * same bits for any number of threads. */
static inline void hk_parts_each(const hk_host *host, const hk_partition *, const size_t *first,
                                 void (*body)(const void *context, size_t part), const void *context);

/* ---- how ---- */

/* A counting sort by part, and the loop over parts. Pairs of domains are put into rounds as in a tournament: in round r
 * of an odd number m, p and q meet where p + q = r modulo m, and whoever would meet himself meets number m. */

static inline bool hk_part_acts(const uint32_t *index, size_t arity, const bool *is_active) {
  bool all = true;
  for (size_t c = 0; is_active && c < arity; c++) all = all && is_active[index[c]];
  return all;
}

static inline hk_status hk_part_lists_sort(hk_part_lists *l, const hk_host *host, const hk_partition *p,
                                           const hk_tuples *node, const bool *is_active) {
  hk_part_lists_free(l, host);
  l->partition = *p;
  l->first = host->allocate(host, (p->parts + 2) * sizeof *l->first);
  l->item = host->allocate(host, (node->count + 1) * sizeof *l->item);
  if (!l->first || !l->item) return host->fail(host, HK_NO_MEMORY, "no memory for %zu elements", node->count);
  for (size_t e = 0; e < node->count; e++)
    if (hk_part_acts(hk_tuple(node, e), node->arity, is_active))
      l->first[hk_part_of(p, hk_tuple(node, e), node->arity) + 2]++;
  for (size_t k = 2; k < p->parts + 2; k++) l->first[k] += l->first[k - 1];
  for (size_t e = 0; e < node->count; e++)
    if (hk_part_acts(hk_tuple(node, e), node->arity, is_active))
      l->item[l->first[hk_part_of(p, hk_tuple(node, e), node->arity) + 1]++] = (uint32_t)e;
  l->count = l->first[p->parts];
  return HK_OK;
}

static inline void hk_part_lists_free(hk_part_lists *l, const hk_host *host) {
  host->release(host, l->first);
  host->release(host, l->item);
  *l = (hk_part_lists){0};
}

static inline void hk_part_lists_touch(const hk_part_lists *l, const hk_tuples *node, const hk_part_use *use) {
  for (size_t e = 0; e < l->count; e++) hk_part_touch(use, hk_tuple(node, l->item[e]), node->arity);
}

/* ---- all parts ---- */

typedef struct hk_part_task {
  const hk_partition *p;
  const size_t *first;
  void (*body)(const void *context, size_t part);
  const void *context;
  size_t part[HK_DOMAINS]; /* of the round */
} hk_part_task;

static inline void hk_part_domains(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_part_task *t = context;
  size_t last = end * t->p->width < t->p->blocks ? end * t->p->width : t->p->blocks;
  (void)chunk;
  for (size_t b = begin * t->p->width; b < last; b++)
    if (t->first[b] < t->first[b + 1]) t->body(t->context, b);
}

static inline void hk_part_round(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_part_task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) t->body(t->context, t->part[k]);
}

/* The parts of round r that have elements. */
static inline size_t hk_part_list_round(hk_part_task *t, size_t r, size_t m) {
  size_t count = 0;
  for (size_t p = 0; p < m; p++) {
    size_t q = (r + m - p) % m, low = p < q ? p : q, high = p < q ? q : p;
    if (p > q) continue; /* the pair has been met */
    if (p == q) low = p, high = m;
    if (high >= t->p->domains) continue;
    size_t part = t->p->blocks + high * (high - 1) / 2 + low;
    if (t->first[part] < t->first[part + 1]) t->part[count++] = part;
  }
  return count;
}

static inline void hk_parts_each(const hk_host *host, const hk_partition *p, const size_t *first,
                                 void (*body)(const void *context, size_t part), const void *context) {
  hk_part_task t = {.p = p, .first = first, .body = body, .context = context};
  host->parallel_for(host, p->domains, 1, hk_part_domains, &t);
  size_t m = p->domains % 2 ? p->domains : p->domains - 1; /* odd; domain m, if there is one, sits out the others */
  for (size_t r = 0; r < m && p->domains > 1; r++)
    host->parallel_for(host, hk_part_list_round(&t, r, m), 1, hk_part_round, &t);
  if (first[p->parts - 1] < first[p->parts]) body(context, p->parts - 1);
}

#endif
