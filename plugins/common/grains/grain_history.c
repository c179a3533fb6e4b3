#include "plugins/common/grains/grain_history.h"

#include "plugins/common/space/reserve.h"

#include <string.h>

/* A damaged checkpoint may state more than there are. */
static bool counts(const hk_grain_history *h) { return h->count >= 0 && (uint64_t)h->count <= h->touches.count; }

static bool lives(const hk_model *m, uint32_t id) { return hk_model_find(m, id) < m->n; }

static hk_status damaged(const hk_grain_history *h, const hk_view *view) {
  return view->host->fail(
      view->host, HK_FAILED,
      "%lld contacts are remembered, and the list of %zu has not that many, or names particles that "
      "are not there: the checkpoint is damaged; write it again",
      (long long)h->count, h->touches.count);
}

static void forget_the_dead(hk_grain_history *h, const hk_model *m) {
  hk_grain_touch *touch = h->touches.item;
  int64_t kept = 0;
  for (int64_t k = 0; k < h->count; k++)
    if (lives(m, touch[k].self) && (!h->others_die || lives(m, touch[k].other))) touch[kept++] = touch[k];
  h->count = kept;
}

hk_status hk_grain_history_adapt(hk_grain_history *h, const hk_view *view, bool others_die) {
  const hk_host *host = view->host;
  host->release(host, h->row);
  host->release(host, h->next_row);
  h->row = host->allocate(host, (view->n + 1) * sizeof *h->row);
  h->next_row = host->allocate(host, (view->n + 1) * sizeof *h->next_row);
  h->indexed = NULL;
  h->others_die = others_die;
  if (!h->row || !h->next_row)
    return host->fail(host, HK_NO_MEMORY, "no memory for contacts of %zu particles", view->n);
  if (!counts(h)) return damaged(h, view);
  forget_the_dead(h, view->model);
  return HK_OK;
}

/* The touches are in the order of the particles, which births and deaths keep. */
void hk_grain_history_index(hk_grain_history *h, const hk_view *view) {
  const hk_grain_touch *touch = h->touches.item;
  size_t k = 0, count = counts(h) ? (size_t)h->count : 0;
  if (h->indexed && h->indexed == touch && h->indexed_count == h->count) return;
  for (size_t i = 0; i < view->n; i++) {
    h->row[i] = k;
    while (k < count && touch[k].self == view->model->id[i]) k++;
  }
  h->row[view->n] = k;
  h->indexed = touch;
  h->indexed_count = h->count;
  h->whole = counts(h) && k == count;
  for (size_t e = 0; h->others_die && h->whole && e < count; e++) h->whole = lives(view->model, touch[e].other);
}

hk_status hk_grain_history_check(hk_grain_history *h, const hk_view *view) {
  hk_grain_history_index(h, view);
  return h->whole ? HK_OK : damaged(h, view);
}

hk_status hk_grain_history_reserve(hk_grain_history *h, const hk_view *view) {
  h->next_row[0] = 0;
  for (size_t i = 0; i < view->n; i++) h->next_row[i + 1] += h->next_row[i];
  return hk_reserve_array(view->host, &h->next, h->next_row[view->n]);
}

void hk_grain_history_commit(hk_grain_history *h, size_t n, double t) {
  hk_array touches = h->touches;
  size_t *row = h->row;
  h->count = (int64_t)h->next_row[n];
  h->touches = h->next;
  h->next = touches;
  h->row = h->next_row;
  h->next_row = row;
  h->t = t;
  h->indexed = h->touches.item;
  h->indexed_count = h->count;
}
