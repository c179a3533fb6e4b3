/* Several steps in a tile: the first step goes through the blocks, and each later one follows the step before as
 * closely as the forces' reach allows (front.c). A step then finds the particles as the step before has left them, in
 * the cache, and threads that work on different steps wait for each other at blocks, not at the end of every step. A
 * block that a step finishes is begun for the step after it at once, whichever strip takes that: nothing of the step
 * touches it any more. */
#include "core/engine/blocks/step_in_tile.h"

#include <sched.h>
#include <stdatomic.h>

enum { WIDEST = 8 };

/* One thread goes through the items of the first step of a strip and takes its other steps along. */
typedef struct strip {
  atomic_size_t done; /* items of its last step */
  char apart[64 - sizeof(size_t)];
} strip;

typedef struct work {
  hk_tiles *tiles;
  const hk_step_in_tile *step;
  size_t next[HK_TILE_STEPS];     /* items */
  size_t finished[HK_TILE_STEPS]; /* blocks */
  size_t steps, width;            /* in the tile; in a strip */
  strip strip[HK_TILE_STEPS];
} work;

static void finish_until(work *w, size_t k, size_t complete) {
  double clock = hk_step_clock(&w->step[k]);
  for (; w->finished[k] < complete; w->finished[k]++) hk_step_finish(w->tiles, &w->step[k], w->finished[k], k);
  hk_step_note_time(w->tiles, &w->step[k], w->tiles->forces->count, k, clock);
}

/* The next item of step k. */
static void take_item(work *w, size_t k) {
  const hk_partition *p = &w->tiles->front.partition;
  const hk_tile_item *item = &w->tiles->order.item[w->next[k]++];
  const hk_step_in_tile *step = &w->step[k];
  if (item->part < p->blocks && !step->prepared) hk_step_prepare_block(w->tiles, step, item->block, k);
  hk_step_add(w->tiles, step, item->part, k);
  w->tiles->sum[k].at_work = NULL;
  finish_until(w, k, item->complete);
}

/* Until the last step of the strip before is far enough for item i. Who is still at work there is named meanwhile. */
static void wait_for(const work *w, size_t s, size_t i) {
  if (s == 0) return;
  size_t after = w->tiles->order.item[i].after;
  for (bool first = true; atomic_load_explicit(&w->strip[s - 1].done, memory_order_acquire) <= after; first = false)
    if (first)
      hk_tile_leave(w->tiles, s * w->width);
    else
      sched_yield();
}

static void take_strip(work *w, size_t s) {
  const hk_tile_order *order = &w->tiles->order;
  size_t first = s * w->width, end = first + w->width < w->steps ? first + w->width : w->steps;
  for (size_t i = 0; i < order->items; i++) {
    wait_for(w, s, i);
    take_item(w, first);
    for (size_t k = first + 1; k < end; k++)
      while (w->next[k] < order->items && order->item[w->next[k]].after < w->next[k - 1]) take_item(w, k);
    atomic_store_explicit(&w->strip[s].done, w->next[end - 1], memory_order_release);
  }
  for (size_t k = first; k < end; k++) hk_tile_leave(w->tiles, k);
}

static void take_strips(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t s = begin; s < end; s++) take_strip(context, s);
}

/* Steps of a strip. In a wide one more steps share the data that one thread has in its cache; more and narrower ones
 * let threads begin and end together. Measured on sheets of 1e4 to 1e6 particles; results do not depend on it. */
static size_t strip_width(const hk_tiles *tiles, size_t steps) {
  size_t most = steps < tiles->order.depth ? steps : tiles->order.depth;
  size_t width = most / (4 * (size_t)hk_threads_count(tiles->shared->threads));
  return width < 1 ? 1 : width < WIDEST ? width : WIDEST;
}

void hk_tile_by_strips(hk_tiles *tiles, const hk_step_in_tile *step, size_t steps) {
  work w = {.tiles = tiles, .step = step, .steps = steps, .width = strip_width(tiles, steps)};
  hk_threads_for(tiles->shared->threads, (steps + w.width - 1) / w.width, 1, take_strips, &w);
}
