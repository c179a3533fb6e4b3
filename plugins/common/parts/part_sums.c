/* Parts write to no particle in common while they are added at the same time (part_lists.h), and the powers of all
 * parts are added in their order: the same bits for any number of threads. */
#include "plugins/common/parts/part_sums.h"

hk_status hk_part_sums_sort(hk_part_sums *s, const hk_view *view, const hk_tuples *node, const bool *is_active) {
  const hk_host *host = view->host;
  const hk_partition *p = view->model->partition;
  host->release(host, s->power);
  s->power = host->allocate(host, p->parts * sizeof *s->power);
  if (!s->power) return host->fail(host, HK_NO_MEMORY, "no memory for %zu elements", node->count);
  return hk_part_lists_sort(&s->lists, host, p, node, is_active);
}

typedef struct task {
  const hk_part_sums *sums;
  const hk_view *view;
  hk_part_body body;
  const void *force;
  double *F;
} task;

static double sum_part(const task *t, size_t part) {
  const size_t *first = t->sums->lists.first + part;
  return t->body(t->force, t->view, t->sums->lists.item + first[0], first[1] - first[0], t->F);
}

static void add_part(const void *context, size_t part) {
  const task *t = context;
  t->sums->power[part] = sum_part(t, part);
}

static double sum_all(const task *t) {
  const hk_part_lists *l = &t->sums->lists;
  double power = 0;
  hk_parts_each(t->view->host, &l->partition, l->first, add_part, t);
  for (size_t part = 0; part < l->partition.parts; part++)
    if (l->first[part] < l->first[part + 1]) power += t->sums->power[part];
  return power;
}

void hk_part_sums_add(const hk_part_sums *s, const hk_view *view, size_t part, hk_part_body body, const void *force,
                      double *F) {
  const task t = {s, view, body, force, F};
  double power = part == HK_ALL_PARTS ? sum_all(&t) : sum_part(&t, part);
  if (view->power) *view->power += power;
}
