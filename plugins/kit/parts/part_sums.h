/* Forces that are sums over elements of a few particles, part by part: with the loop over some of its elements, a force
 * has `add`, `add_part` and `parts`. */
#ifndef HK_PART_SUMS_H
#define HK_PART_SUMS_H

#include "plugins/kit/parts/part_lists.h"

/* Adds to F what the elements item[0] ... item[count - 1] exert, in this order, and returns their power, W. */
typedef double (*hk_part_body)(const void *force, const hk_view *view, const uint32_t *item, size_t count, double *F);

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_part_sums {
  hk_part_lists lists;
  double *power; /* W, of the parts in one `add` */
} hk_part_sums;

/* To be called in `create` and `topology`; is_active: as of hk_part_lists_sort. HK_NO_MEMORY. */
static inline hk_status hk_part_sums_sort(hk_part_sums *, const hk_view *view, const hk_tuples *node,
                                          const bool *is_active);
/* F += one part, as hk_force.add_part does it, or HK_ALL_PARTS, on several threads, as hk_force.add; view->power gets
 * their power. `force`: the argument of `body`. */
static inline void hk_part_sums_add(const hk_part_sums *, const hk_view *view, size_t part, hk_part_body body,
                                    const void *force, double *F);

/* ---- how ---- */

/* Parts write to no particle in common while they are added at the same time (part_lists.h), and the powers of all
 * parts are added in their order: the same bits for any number of threads. */

static inline hk_status hk_part_sums_sort(hk_part_sums *s, const hk_view *view, const hk_tuples *node,
                                          const bool *is_active) {
  const hk_host *host = view->host;
  const hk_partition *p = view->model->partition;
  host->release(host, s->power);
  s->power = host->allocate(host, p->parts * sizeof *s->power);
  if (!s->power) return host->fail(host, HK_NO_MEMORY, "no memory for %zu elements", node->count);
  return hk_part_lists_sort(&s->lists, host, p, node, is_active);
}

typedef struct hk_part_sums_task {
  const hk_part_sums *sums;
  const hk_view *view;
  hk_part_body body;
  const void *force;
  double *F;
} hk_part_sums_task;

static inline double hk_part_sums_one(const hk_part_sums_task *t, size_t part) {
  const size_t *first = t->sums->lists.first + part;
  return t->body(t->force, t->view, t->sums->lists.item + first[0], first[1] - first[0], t->F);
}

static inline void hk_part_sums_store(const void *context, size_t part) {
  const hk_part_sums_task *t = context;
  t->sums->power[part] = hk_part_sums_one(t, part);
}

static inline double hk_part_sums_all(const hk_part_sums_task *t) {
  const hk_part_lists *l = &t->sums->lists;
  double power = 0;
  hk_parts_each(t->view->host, &l->partition, l->first, hk_part_sums_store, t);
  for (size_t part = 0; part < l->partition.parts; part++)
    if (l->first[part] < l->first[part + 1]) power += t->sums->power[part];
  return power;
}

static inline void hk_part_sums_add(const hk_part_sums *s, const hk_view *view, size_t part, hk_part_body body,
                                    const void *force, double *F) {
  const hk_part_sums_task t = {s, view, body, force, F};
  double power = part == HK_ALL_PARTS ? hk_part_sums_all(&t) : hk_part_sums_one(&t, part);
  if (view->power) *view->power += power;
}

#endif
