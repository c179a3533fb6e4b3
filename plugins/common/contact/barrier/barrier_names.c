/* Which pairs have blocks in the matrix: see barrier_contacts.h. Both lists rise, so that they are walked side by side.
 */
#include "plugins/common/contact/barrier/barrier_contacts.h"

typedef struct task {
  const hk_feature_pair *named;
  size_t count;
  hk_barrier_pair *near;
  double part;        /* of the move, beyond which nothing goes */
  double distance;    /* m, of the barrier */
  uint32_t *nameless; /* of the chunks: pairs that may act and have no name */
} task;

/* m: on the first part of the move the gap is nowhere less. */
static double least_on(const hk_barrier_pair *p, double part) { return p->pair.gap - part * (p->pair.gap - p->least); }

/* The first place of a rising list whose pair is not before this one. */
static size_t place_of(const hk_feature_pair *list, size_t count, const hk_feature_pair *pair) {
  size_t low = 0, high = count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (hk_pair_compare(&list[middle], pair) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void tell_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  size_t at = place_of(t->named, t->count, &t->near[begin].pair);
  uint32_t nameless = 0;
  for (size_t k = begin; k < end; k++) {
    hk_barrier_pair *p = &t->near[k];
    int order = -1;
    for (; at < t->count && (order = hk_pair_compare(&t->named[at], &p->pair)) < 0;) at++;
    p->name = at < t->count && order == 0 ? (uint32_t)at : UINT32_MAX;
    nameless += p->name == UINT32_MAX && least_on(p, t->part) < t->distance;
  }
  t->nameless[chunk] = nameless;
}

/* Tells every pair its name. False: one that may act on the move has none. */
static bool tell(hk_barrier_contacts *c, double part) {
  task t = {c->named.item, c->named.count, c->near.item, part, c->law.distance, c->kept_of.item};
  bool all = true;
  c->host->parallel_for(c->host, c->found, HK_BARRIER_GRAIN, tell_chunk, &t);
  for (size_t k = 0; k * HK_BARRIER_GRAIN < c->found; k++) all &= t.nameless[k] == 0;
  return all;
}

/* Names the candidates of the move, with a margin. */
static hk_status name(hk_barrier_contacts *c, double part) {
  const hk_barrier_pair *near = c->near.item;
  hk_status status = c->host->resize(c->host, &c->named, c->found);
  if (status != HK_OK) return status;
  hk_feature_pair *named = c->named.item;
  size_t count = 0;
  for (size_t k = 0; k < c->found; k++)
    if (least_on(&near[k], part) < (1 + HK_BARRIER_MARGIN) * c->law.distance) named[count++] = near[k].pair;
  return c->host->resize(c->host, &c->named, count);
}

hk_status hk_barrier_update_names(hk_barrier_contacts *c, double part, bool *changed) {
  if (tell(c, part)) return HK_OK;
  *changed = true;
  hk_status status = name(c, part);
  if (status == HK_OK) tell(c, part);
  return status;
}
