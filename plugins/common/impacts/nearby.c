/* Two bounds by the moves of patches (patches.h). The list: a pair that is not in it was at least the skin apart on all
 * of the moves of the search, and at least as far as its patches' boxes, swept by them; while the two have come nearer
 * by less since, at the same part of the same step or else since its end, its gap is open. Pairs in the list: on the
 * way from a look to now their distance has changed by the sum over the steps of what their patches came nearer, at
 * most. */
#include "plugins/common/impacts/nearby.h"

#include "plugins/common/impacts/near_groups.h"

#include <string.h>

enum { PAIRS = 256 };

/* Relative, of distances: far above rounding, far below what shows. */
static const double margin = 1e-9;

static hk_status no_memory(const hk_nearby *s, size_t count, const char *what) {
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu %s", count, what);
}

hk_status hk_nearby_open(hk_nearby *s, const hk_host *host, const hk_view *view, const hk_surfaces *surfaces,
                         hk_nearby_found *found, double skin) {
  void *old[] = {s->last, s->moves, s->box, s->seen, s->by_home};
  for (int k = 0; k < 5; k++) host->release(host, old[k]);
  s->host = host;
  s->surfaces = surfaces;
  s->found = found;
  s->skin = skin;
  s->n = view->n;
  s->count = s->dues = s->groups = 0;
  s->listed = false;
  hk_status status = hk_patches_open(&s->patches, host, surfaces->mesh(surfaces->self), view);
  if (status != HK_OK) return status;
  size_t patches = s->patches.count + 1;
  s->last = host->allocate(host, (3 * s->n + 1) * sizeof *s->last);
  s->moves = host->allocate(host, patches * sizeof *s->moves);
  s->box = host->allocate(host, patches * sizeof *s->box);
  s->seen = host->allocate(host, patches * sizeof *s->seen);
  s->by_home = host->allocate(host, patches * sizeof *s->by_home);
  if (!s->last || !s->moves || !s->box || !s->seen || !s->by_home) return no_memory(s, s->n, "particles");
  memcpy(s->last, view->x, 3 * s->n * sizeof *s->last);
  return HK_OK;
}

static hk_status make_room(hk_nearby *s, size_t count) {
  const hk_host *host = s->host;
  if (count < s->room) return HK_OK;
  size_t room = count + count / 2 + 1;
  void *old[] = {s->pair, s->due, s->index, s->group_of, s->in_group, s->sorted, s->group, s->marks};
  for (int k = 0; k < 8; k++) host->release(host, old[k]);
  s->room = 0;
  s->pair = host->allocate(host, room * sizeof *s->pair);
  s->due = host->allocate(host, room * sizeof *s->due);
  s->index = host->allocate(host, room * sizeof *s->index);
  s->group_of = host->allocate(host, room * sizeof *s->group_of);
  s->in_group = host->allocate(host, room * sizeof *s->in_group);
  s->sorted = host->allocate(host, room * sizeof *s->sorted);
  s->group = host->allocate(host, (room + 1) * sizeof *s->group);
  s->marks = host->allocate(host, (room / 64 + 1) * sizeof *s->marks);
  if (!s->pair || !s->due || !s->index || !s->group_of || !s->in_group || !s->sorted || !s->group || !s->marks)
    return no_memory(s, count, "pairs");
  s->room = room;
  return HK_OK;
}

static hk_status list_pairs(hk_nearby *s) {
  hk_surface_pairs pairs = {0};
  s->count = s->groups = s->dues = 0;
  s->listed = false;
  hk_status status = s->surfaces->pairs(s->surfaces->self, s->found->from, s->found->to, s->reach + s->skin, &pairs);
  if (status == HK_OK) status = make_room(s, pairs.count);
  if (status != HK_OK) return status;
  s->count = pairs.count;
  if (s->count) memcpy(s->pair, pairs.pair, s->count * sizeof *s->pair);
  hk_near_groups_make(s);
  hk_near_boxes_make(s);
  s->listed = true;
  s->searches++;
  return HK_OK;
}

static hk_status search(hk_nearby *s, const double *x_from, const double *x_to) {
  memcpy(s->found->from, x_from, 3 * s->n * sizeof *x_from);
  memcpy(s->found->to, x_to, 3 * s->n * sizeof *x_to);
  s->found->good = s->fresh = true;
  return list_pairs(s);
}

/* path_to = path + by how much a move from a to b may bring the patches nearer. */
static void extend(hk_nearby *s, const double *a, const double *b) {
  hk_patches_measure(&s->patches, s->host, a, b, s->moves);
  for (hk_near_group *g = s->group; g < s->group + s->groups; g++)
    g->path_to = g->path + hk_patch_approach(&s->moves[g->a], &s->moves[g->b]) * (1 + margin);
}

static void settle(hk_nearby *s, const double *x) {
  for (size_t g = 0; g < s->groups; g++) s->group[g].path = s->group[g].path_to;
  memcpy(s->last, x, 3 * s->n * sizeof *x);
}

void hk_nearby_begin(hk_nearby *s, const double *x_from) {
  s->fresh = false;
  if (memcmp(s->last, x_from, 3 * s->n * sizeof *x_from) == 0) return;
  extend(s, s->last, x_from);
  settle(s, x_from);
}

/* Whether no pair that is not listed can have come below the reach. */
static bool still_apart(hk_nearby *s, const double *x) {
  hk_patches_measure(&s->patches, s->host, s->found->to, x, s->moves);
  return hk_near_boxes_apart(s, s->skin * (1 - margin));
}

hk_status hk_nearby_reach(hk_nearby *s, const double *x_from, const double *x_to) {
  hk_status status = HK_OK;
  bool complete = s->found->good;
  if (complete && !s->listed) status = list_pairs(s);
  complete = complete && status == HK_OK && still_apart(s, x_to) && (s->fresh || still_apart(s, x_from));
  if (!complete && status == HK_OK) status = search(s, x_from, x_to);
  if (status != HK_OK) return status;
  extend(s, x_from, x_to);
  hk_near_groups_mark(s);
  return HK_OK;
}

void hk_nearby_end(hk_nearby *s, const double *x_to) { settle(s, x_to); }

void hk_nearby_put_off(hk_nearby *s, size_t k, double gap) {
  s->due[k] = s->group[s->group_of[k]].path + (gap - s->reach) * (1 - margin);
}

typedef struct sifting {
  hk_nearby *s;
  const double *x;
} sifting;

static void sift_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const sifting *w = context;
  (void)chunk;
  for (size_t d = begin; d < end; d++) {
    const hk_surface_pair *pair = &w->s->pair[w->s->index[d]];
    double x[12];
    for (size_t i = 0; i < 12; i++) x[i] = w->x[3 * (size_t)pair->vertex[i / 3] + i % 3];
    double gap = sqrt(hk_nearest_of_pair(pair->kind, x).squared) - pair->offset;
    if (gap > w->s->reach) hk_nearby_put_off(w->s, w->s->index[d], gap);
  }
}

void hk_nearby_sift(hk_nearby *s, const double *x) {
  sifting w = {s, x};
  size_t kept = 0;
  s->host->parallel_for(s->host, s->dues, PAIRS, sift_chunk, &w);
  for (size_t d = 0; d < s->dues; d++) {
    uint32_t k = s->index[d];
    if (!(s->due[k] > s->group[s->group_of[k]].path_to)) s->index[kept++] = k;
  }
  s->dues = kept;
}
