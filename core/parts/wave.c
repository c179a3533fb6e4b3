/* Several steps of one evaluation each in one sweep over the particles, a wave: the first step goes through the blocks,
 * and each later one follows the step before as closely as the forces' reach allows. A step then finds the particles as
 * the step before has left them, in the cache, and threads that work on different steps wait for each other at blocks,
 * not at the end of every step.
 *
 * Within a step the parts follow in an order that is the same for any number of threads and of steps in a wave: block
 * by block, and what acts across domains p < q after the last block of q that such elements touch. A part never touches
 * a block above its own, so that a block is complete in a step once no later part reaches down to it. A step may add a
 * part when the step before has completed the part's own block: all blocks below it are then complete, too, and what
 * the step before has still to add touches none of them. */
#include "core/parts/work.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* ---- the order ---- */

void hk_wave_close(hk_wave *w) {
  free(w->item);
  *w = (hk_wave){0};
}

/* The highest block of a domain with an element that reaches below `first`; `first` where there is none. */
static size_t highest_across(const hk_window *reach, size_t first, size_t last) {
  size_t b = last;
  while (b-- > first)
    if (reach->lowest[b] < first) return b;
  return first;
}

/* The parts of domains p < q with elements. */
static void list_across(hk_wave *w, const hk_window *window, size_t q, size_t block) {
  for (size_t p = 0; p < q; p++) {
    size_t part = window->partition.blocks + q * (q - 1) / 2 + p;
    if (window->lowest[part] != UINT32_MAX)
      w->item[w->items++] = (hk_wave_item){.part = (uint32_t)part, .block = (uint32_t)block};
  }
}

static void list_items(hk_wave *w, const hk_window *window, const hk_window *reach) {
  const hk_partition *p = &window->partition;
  for (size_t q = 0; q < p->domains; q++) {
    size_t first = q * p->width, last = first + p->width < p->blocks ? first + p->width : p->blocks;
    size_t across = highest_across(reach, first, last);
    for (size_t b = first; b < last; b++) {
      w->item[w->items++] = (hk_wave_item){.part = (uint32_t)b, .block = (uint32_t)b};
      if (b == across) list_across(w, window, q, b);
    }
  }
}

/* How many blocks are complete after each item. */
static void find_done(hk_wave *w, const hk_window *window) {
  uint32_t reach = UINT32_MAX;
  for (size_t i = w->items; i-- > 0;) {
    hk_wave_item *item = &w->item[i];
    item->done = reach < item->block + 1 ? reach : item->block + 1;
    if (window->lowest[item->part] < reach) reach = window->lowest[item->part];
  }
}

/* Which item of the step before has to be complete before each. */
static void find_after(hk_wave *w) {
  size_t most = 0;
  for (size_t i = 0, j = 0; j < w->items; j++) {
    while (w->item[i].done <= w->item[j].block) i++;
    w->item[j].after = (uint32_t)i;
    if (i - j > most) most = i - j;
  }
  w->depth = w->items / (most + 1);
}

bool hk_wave_arrange(hk_wave *w, const hk_window *window, const hk_window *reach) {
  const hk_partition *p = &window->partition;
  hk_wave_close(w);
  if (window->lowest[p->parts - 1] != UINT32_MAX) return true; /* elements of more than two domains: no wave */
  w->item = malloc(p->parts * sizeof *w->item);
  if (!w->item) return false;
  list_items(w, window, reach);
  find_done(w, window);
  find_after(w);
  return true;
}

/* ---- a wave ---- */

enum { WIDEST = 8 };

/* A band of steps is taken by one thread, which goes through the items of its first step and takes the others along. */
typedef struct band {
  atomic_size_t complete; /* items of its last step */
  char apart[64 - sizeof(size_t)];
} band;

typedef struct wave {
  hk_parts *parts;
  hk_part_work work[HK_LEVELS];
  hk_sweep sweep[HK_LEVELS];
  size_t next[HK_LEVELS];     /* items */
  size_t finished[HK_LEVELS]; /* blocks */
  size_t levels, width;       /* steps; of a band */
  band band[HK_LEVELS];
} wave;

static void finish_until(wave *w, size_t level, size_t done) {
  const hk_partition *p = &w->parts->window.partition;
  const hk_part_work *t = &w->work[level];
  double clock = hk_part_clock(t);
  for (; w->finished[level] < done; w->finished[level]++)
    hk_part_finish(t, w->finished[level] << p->bits, hk_part_end(p, w->finished[level]), level);
  hk_part_note_time(t, w->parts->forces->count, level, clock);
}

/* The next item of a step. */
static void take_item(wave *w, size_t level) {
  const hk_partition *p = &w->parts->window.partition;
  const hk_wave_item *item = &w->parts->wave.item[w->next[level]++];
  const hk_part_work *t = &w->work[level];
  if (item->part < p->blocks) {
    double clock = hk_part_clock(t);
    hk_part_prepare(t, (size_t)item->block << p->bits, hk_part_end(p, item->block));
    hk_part_note_time(t, w->parts->forces->count, level, clock);
  }
  hk_part_add(t, item->part, level);
  w->parts->slot[level].at_work = NULL;
  finish_until(w, level, item->done);
}

/* Until the last step of the band before is far enough for item i. Who is still at work there is named meanwhile. */
static void wait_for(const wave *w, size_t b, size_t i) {
  if (b == 0) return;
  size_t after = w->parts->wave.item[i].after;
  for (bool first = true; atomic_load_explicit(&w->band[b - 1].complete, memory_order_acquire) <= after; first = false)
    if (first)
      hk_part_leave(&w->work[b * w->width], b * w->width);
    else
      sched_yield();
}

static void take_band(wave *w, size_t b) {
  const hk_wave *order = &w->parts->wave;
  size_t first = b * w->width, end = first + w->width < w->levels ? first + w->width : w->levels;
  for (size_t i = 0; i < order->items; i++) {
    wait_for(w, b, i);
    take_item(w, first);
    for (size_t level = first + 1; level < end; level++)
      while (w->next[level] < order->items && order->item[w->next[level]].after < w->next[level - 1])
        take_item(w, level);
    atomic_store_explicit(&w->band[b].complete, w->next[end - 1], memory_order_release);
  }
  for (size_t level = first; level < end; level++) hk_part_leave(&w->work[level], level);
}

static void take_bands(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t b = begin; b < end; b++) take_band(context, b);
}

/* The wall time of the sampled level, as one of `count`, goes to the forces in proportion to their part of it. */
static void account(hk_parts *p, size_t count, size_t sampled, double wall) {
  double all = 0;
  for (size_t k = 0; sampled < count && k <= p->forces->count; k++) all += p->seconds[k * HK_SLOTS + sampled];
  for (size_t k = 0; k < p->forces->count; k++) {
    hk_instance *force = p->forces->item[k];
    if (!hk_part_taken(p, k)) continue;
    force->calls += count;
    if (!(all > 0)) continue;
    force->seconds += wall / (double)count * p->seconds[k * HK_SLOTS + sampled] / all;
    force->sampled++;
  }
}

static void begin_levels(wave *w, hk_level *level, size_t sampled) {
  const hk_instance *volatile *acting = w->parts->shared->acting;
  const hk_instance *outer = acting ? *acting : NULL;
  memset(w->parts->slot, 0, w->levels * sizeof *w->parts->slot);
  for (size_t k = 0; k < w->levels; k++) {
    w->sweep[k] = (hk_sweep){.t = level[k].t, .x = level[k].x, .v = level[k].v, .a = level[k].a};
    w->sweep[k].pass = &level[k].pass;
    w->sweep[k].sampled = k == sampled;
    w->work[k] = (hk_part_work){.parts = w->parts, .w = &w->sweep[k], .slots = w->levels, .outer = outer};
  }
  for (size_t k = 0; k <= w->parts->forces->count && sampled < w->levels; k++)
    w->parts->seconds[k * HK_SLOTS + sampled] = 0;
}

/* Steps of a band. In a wide one more steps share the data that one thread has in its cache; more and narrower ones let
 * threads begin and end together. Measured on sheets of 1e4 to 1e6 particles; results do not depend on it. */
static size_t band_width(const hk_parts *p, size_t count) {
  size_t most = count < p->wave.depth ? count : p->wave.depth;
  size_t width = most / (4 * (size_t)hk_threads_count(p->shared->threads));
  return width < 1 ? 1 : width < WIDEST ? width : WIDEST;
}

hk_status hk_wave_run(hk_parts *p, hk_level *level, size_t count, size_t sampled) {
  wave w = {.parts = p, .levels = count, .width = band_width(p, count)};
  double begin = sampled < count ? hk_clock() : 0;
  uint64_t bad = 0;
  begin_levels(&w, level, sampled);
  hk_threads_for(p->shared->threads, (count + w.width - 1) / w.width, 1, take_bands, &w);
  for (size_t k = 0; k < count; k++) {
    level[k].power = p->slot[k].power;
    bad |= p->slot[k].bad;
  }
  account(p, count, sampled, sampled < count ? hk_clock() - begin : 0);
  return bad ? HK_NOT_FINITE : HK_OK;
}
