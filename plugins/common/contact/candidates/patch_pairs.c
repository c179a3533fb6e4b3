/* Boxes are made for the patches that are asked for. An item of one patch is compared with those of the other that come
 * near its whole box. */
#include "plugins/common/contact/surfaces/surface_patches.h"

enum { GRAIN = 4, PAIRS = 4 };

typedef struct task {
  hk_broad_phase *search;
  hk_surface_patch_set *patches;
  const hk_patch_pair *pair;
  hk_gather *into;
} task;

static void box_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    uint32_t p = t->patches->list[k];
    hk_box whole = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t e = t->patches->first[p]; e < t->patches->first[p + 1]; e++) {
      uint32_t place = t->search->place_of[t->patches->item[e]];
      hk_broad_phase_box(t->search, place);
      for (int c = 0; c < 3; c++) {
        whole.low[c] = fmin(whole.low[c], t->search->box[place].low[c]);
        whole.high[c] = fmax(whole.high[c], t->search->box[place].high[c]);
      }
    }
    t->patches->whole[p] = whole;
  }
}

static void use(hk_surface_patch_set *p, uint32_t patch, size_t *count) {
  if (p->used[patch]) return;
  p->used[patch] = true;
  p->list[(*count)++] = patch;
}

static void make_boxes(const task *t, const hk_host *host, size_t pairs) {
  size_t count = 0;
  for (size_t k = 0; k < pairs; k++) {
    use(t->patches, t->pair[k].a, &count);
    use(t->patches, t->pair[k].b, &count);
  }
  host->parallel_for(host, count, GRAIN, box_chunk, (void *)(uintptr_t)t);
  for (size_t k = 0; k < count; k++) t->patches->used[t->patches->list[k]] = false;
}

static hk_box widened(const hk_box *box, double by) {
  hk_box wide = *box;
  for (int c = 0; c < 3; c++) wide.low[c] -= by, wide.high[c] += by;
  return wide;
}

/* The places of a patch's items whose boxes come near another one. */
static size_t near_items(const task *t, uint32_t patch, const hk_box *with, uint32_t place[HK_PATCH_MOST]) {
  size_t count = 0;
  for (size_t e = t->patches->first[patch]; e < t->patches->first[patch + 1]; e++) {
    uint32_t k = t->search->place_of[t->patches->item[e]];
    if (hk_box_overlap(&t->search->box[k], with)) place[count++] = k;
  }
  return count;
}

/* An item with others of the other patch, or of its own that follow it. */
static void try_item(const hk_pair_output *o, uint32_t place, const uint32_t *other, size_t others) {
  const hk_broad_phase *s = o->search;
  hk_item_query seeker = hk_item_query_of(s, place);
  hk_box wide = widened(&s->box[place], hk_broad_phase_distance(s, 0));
  for (size_t q = 0; q < others; q++) {
    bool moves = place < s->moving || other[q] < s->moving;
    if (!moves || !hk_box_overlap(&s->box[other[q]], &wide)) continue;
    if (!hk_item_query_misses(s, &seeker, other[q])) hk_items_compare(o, place, other[q]);
  }
}

static void try_within(const task *t, const hk_pair_output *o, uint32_t patch) {
  uint32_t place[HK_PATCH_MOST];
  size_t count = near_items(t, patch, &t->patches->whole[patch], place);
  for (size_t i = 0; i < count; i++) {
    bool moves = place[i] < o->search->moving,
         two = o->search->items.item[o->search->order[place[i]]].triangle[1] != UINT32_MAX;
    if (moves && two) hk_items_compare(o, place[i], place[i]);
    try_item(o, place[i], place + i + 1, count - i - 1);
  }
}

static void try_between(const task *t, const hk_pair_output *o, const hk_patch_pair *pair) {
  uint32_t place[HK_PATCH_MOST], other[HK_PATCH_MOST];
  double distance = hk_broad_phase_distance(t->search, 0);
  hk_box a = widened(&t->patches->whole[pair->a], distance), b = widened(&t->patches->whole[pair->b], distance);
  size_t count = near_items(t, pair->a, &b, place), others = near_items(t, pair->b, &a, other);
  for (size_t i = 0; i < count; i++) try_item(o, place[i], other, others);
}

static void search_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  hk_pair_output o = {.search = t->search, .into = t->into, .gaps = true, .chunk = chunk};
  for (size_t k = begin; k < end; k++) {
    hk_gather_row(t->into, chunk, k);
    if (t->pair[k].a == t->pair[k].b)
      try_within(t, &o, t->pair[k].a);
    else
      try_between(t, &o, &t->pair[k]);
  }
}

hk_status hk_patch_pairs_find(hk_broad_phase *s, hk_surface_patch_set *p, const hk_host *host,
                              const hk_surface_move *move, const hk_patch_pair *pair, size_t count, hk_gather *near) {
  task t = {s, p, pair, near};
  hk_status status = hk_broad_phase_move(s, host, move);
  if (status != HK_OK) return status;
  make_boxes(&t, host, count);
  return hk_gather_run(near, host, count, count, PAIRS, search_chunk, &t);
}
