/* Another order for a list of springs whose neighbours in the list are not neighbours in space: see edge_order.c. */
#ifndef HK_EDGE_ORDER_H
#define HK_EDGE_ORDER_H

#include "core/plugin.h"
#include <string.h>

/* Springs and their numbers, as they were given or in memory of the host. */
typedef struct hk_edge_order {
  hk_tuples edges;
  hk_per_tuple k, c, L;
} hk_edge_order;

enum {
  HK_RUN_MIN = 16, /* places: the call costs more than shorter runs save */
  HK_RUN_GAP = 8   /* places without a spring that a run goes on over: a vector's */
};

/* How many of the springs order[0], order[1], ... form a run (i+t, j+t) with rising t that begins with the first; with
 * the places without a spring it has *places. No gap is longer than what is before it, and two thirds of the places
 * have a spring: a place takes half the time of a spring in a list. */
static inline size_t hk_edge_run(const hk_tuples *edges, const uint32_t *order, size_t count, size_t *places);

/* Changes to a better order, where there is one; the numbers are copied with it. `particles`: n. False: no memory, the
 * order is as it was. */
static inline bool hk_edge_order_improve(hk_edge_order *, const hk_host *host, size_t particles);
/* Releases what replaced the lists of `given`. */
static inline void hk_edge_order_release(hk_edge_order *, const hk_host *host, const hk_edge_order *given);

/* ---- how ---- */

/* The order in which a script or a mesh lists springs decides which runs (i+t, j+t) are found in it. Where few springs
 * follow each other so, they are turned to have their lower end first, and sorted: runs of one difference j - i come
 * first, then the others by their ends, so that the lists that are made of them read neighbours together. Two sorts by
 * counting, of the ends and of the differences, are linear in springs and particles. A few springs may be missing in a
 * run: in rows of an unstructured mesh one in twenty is. */

/* How many places after spring e of a run another one is; 0: in no run with it. */
static inline size_t hk_edge_distance(const hk_tuples *edges, uint32_t e, uint32_t next) {
  const uint32_t *p = hk_tuple(edges, e), *q = hk_tuple(edges, next);
  return q[0] > p[0] && q[0] - p[0] == q[1] - p[1] ? q[0] - p[0] : 0;
}

static inline size_t hk_edge_run(const hk_tuples *edges, const uint32_t *order, size_t count, size_t *places) {
  size_t length = 1, together = 1, step;
  for (*places = 1; length < count; length++, *places += step) {
    step = hk_edge_distance(edges, order[length - 1], order[length]);
    if (step == 0 || step > HK_RUN_GAP + 1 || step > together + 1 || 2 * (*places + step) > 3 * (length + 1)) break;
    together = step == 1 ? together + 1 : 1;
  }
  return length;
}

typedef struct hk_edge_sorter {
  const hk_host *host;
  const hk_tuples *edges; /* the lower end first */
  size_t count;
  uint32_t *order, *scratch, *first; /* count, count, particles + 2 */
} hk_edge_sorter;

static inline uint32_t hk_edge_low(const hk_edge_sorter *s, uint32_t e) { return hk_tuple(s->edges, e)[0]; }

static inline uint32_t hk_edge_high(const hk_edge_sorter *s, uint32_t e) { return hk_tuple(s->edges, e)[1]; }

static inline uint32_t hk_edge_rise(const hk_edge_sorter *s, uint32_t e) {
  return hk_edge_high(s, e) - hk_edge_low(s, e);
}

/* Whether half of the springs follow the one before as they are. */
static inline bool hk_edges_line_up(const hk_tuples *edges) {
  size_t following = 0;
  for (size_t e = 1; e < edges->count; e++) {
    const uint32_t *before = hk_tuple(edges, e - 1), *now = hk_tuple(edges, e);
    following += now[0] == before[0] + 1 && now[1] == before[1] + 1;
  }
  return 2 * following >= edges->count;
}

/* A stable sort by counting. */
static inline void hk_edge_sort(hk_edge_sorter *s, uint32_t *list, size_t count, size_t keys,
                                uint32_t (*key)(const hk_edge_sorter *s, uint32_t e)) {
  memset(s->first, 0, (keys + 1) * sizeof *s->first);
  for (size_t k = 0; k < count; k++) s->first[key(s, list[k]) + 1]++;
  for (size_t k = 0; k < keys; k++) s->first[k + 1] += s->first[k];
  for (size_t k = 0; k < count; k++) s->scratch[s->first[key(s, list[k])]++] = list[k];
  memcpy(list, s->scratch, count * sizeof *list);
}

/* Moves what is in runs to the front; returns how many springs that are. */
static inline size_t hk_edge_take_runs(hk_edge_sorter *s) {
  size_t taken = 0, rest = 0;
  for (size_t k = 0, length, places; k < s->count; k += length) {
    length = hk_edge_run(s->edges, s->order + k, s->count - k, &places);
    bool run = places >= HK_RUN_MIN;
    memcpy(run ? s->scratch + taken : s->first + rest, s->order + k, length * sizeof *s->order);
    *(run ? &taken : &rest) += length;
  }
  memcpy(s->order, s->scratch, taken * sizeof *s->order);
  memcpy(s->order + taken, s->first, rest * sizeof *s->order);
  return taken;
}

static inline void hk_edge_sort_all(hk_edge_sorter *s, size_t particles) {
  for (size_t k = 0; k < s->count; k++) s->order[k] = (uint32_t)k;
  hk_edge_sort(s, s->order, s->count, particles, hk_edge_low);
  hk_edge_sort(s, s->order, s->count, particles, hk_edge_rise);
  size_t runs = hk_edge_take_runs(s);
  hk_edge_sort(s, s->order + runs, s->count - runs, particles, hk_edge_high);
  hk_edge_sort(s, s->order + runs, s->count - runs, particles, hk_edge_low);
}

static inline bool hk_edge_copy_numbers(const hk_edge_sorter *s, hk_per_tuple *numbers) {
  if (numbers->count <= 1) return true;
  double *value = s->host->allocate(s->host, numbers->count * sizeof *value);
  for (size_t k = 0; value && k < numbers->count; k++) value[k] = numbers->value[s->order[k]];
  if (value) numbers->value = value;
  return value;
}

/* In the new order. */
static inline bool hk_edge_copy_pairs(const hk_edge_sorter *s, hk_tuples *edges) {
  uint32_t *pair = s->host->allocate(s->host, (2 * s->count + 1) * sizeof *pair);
  for (size_t k = 0; pair && k < s->count; k++) memcpy(pair + 2 * k, hk_tuple(s->edges, s->order[k]), 2 * sizeof *pair);
  if (pair) edges->index = pair;
  return pair;
}

/* In the given order, the lower end first. NULL: no memory. */
static inline uint32_t *hk_edges_turned(const hk_host *host, const hk_tuples *edges) {
  uint32_t *pair = host->allocate(host, (2 * edges->count + 1) * sizeof *pair);
  for (size_t e = 0; pair && e < edges->count; e++) {
    const uint32_t *end = hk_tuple(edges, e);
    pair[2 * e] = end[0] < end[1] ? end[0] : end[1];
    pair[2 * e + 1] = end[0] < end[1] ? end[1] : end[0];
  }
  return pair;
}

static inline void hk_edge_order_release(hk_edge_order *o, const hk_host *host, const hk_edge_order *given) {
  if (o->edges.index != given->edges.index) host->release(host, (void *)(uintptr_t)o->edges.index);
  if (o->k.value != given->k.value) host->release(host, o->k.value);
  if (o->c.value != given->c.value) host->release(host, o->c.value);
  if (o->L.value != given->L.value) host->release(host, o->L.value);
  *o = *given;
}

static inline bool hk_edge_order_improve(hk_edge_order *o, const hk_host *host, size_t particles) {
  const hk_edge_order given = *o;
  const size_t count = o->edges.count, keys = particles + 2 > count ? particles + 2 : count;
  if (count < HK_RUN_MIN || hk_edges_line_up(&o->edges)) return true;
  const hk_tuples turned = {count, 2, hk_edges_turned(host, &o->edges)};
  hk_edge_sorter s = {.host = host, .edges = &turned, .count = count};
  s.order = host->allocate(host, count * sizeof *s.order);
  s.scratch = host->allocate(host, count * sizeof *s.scratch);
  s.first = host->allocate(host, keys * sizeof *s.first);
  bool fine = turned.index && s.order && s.scratch && s.first;
  if (fine) hk_edge_sort_all(&s, particles);
  fine = fine && hk_edge_copy_pairs(&s, &o->edges) && hk_edge_copy_numbers(&s, &o->k) &&
         hk_edge_copy_numbers(&s, &o->c) && hk_edge_copy_numbers(&s, &o->L);
  host->release(host, (void *)(uintptr_t)turned.index);
  host->release(host, s.order);
  host->release(host, s.scratch);
  host->release(host, s.first);
  if (!fine) hk_edge_order_release(o, host, &given);
  return fine;
}

#endif
