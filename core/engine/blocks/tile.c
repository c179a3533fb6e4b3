/* Tiles: the evaluations of one step, domain by domain, or of several in one sweep over the particles (strips.c).
 *
 * The only step of a tile goes block by block: the particles are prepared, the forces add their parts, and blocks that
 * nothing touches any more are finished, while their data are in the cache. Domains run at the same time; interface
 * blocks follow in rounds, and then the blocks that were deferred because of them. Each domain and each interface block
 * has sums of its own, which are added in their order, so that results do not depend on the number of threads. */
#include "core/engine/blocks/step_in_tile.h"

#include <string.h>

enum { GRAIN = 4096 };

/* ---- before and after the forces, all particles ---- */

typedef struct chunks {
  const hk_tiles *tiles;
  const hk_step_in_tile *step;
} chunks;

static void prepare_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const chunks *c = context;
  (void)chunk;
  hk_step_prepare(c->tiles, c->step, begin, end);
}

static void finish_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_fused *fused = ((const chunks *)context)->step->fused;
  (void)chunk;
  fused->after(fused->context, begin, end);
}

void hk_tiles_prepare(hk_tiles *tiles, const hk_step_in_tile *s) {
  hk_threads_for(tiles->shared->threads, tiles->state->model.n, GRAIN, prepare_chunk, &(chunks){tiles, s});
}

void hk_tiles_finish(hk_tiles *tiles, const hk_step_in_tile *s) {
  if (s->fused && s->fused->after)
    hk_threads_for(tiles->shared->threads, tiles->state->model.n, GRAIN, finish_chunk, &(chunks){tiles, s});
}

/* ---- one step ---- */

typedef struct work {
  hk_tiles *tiles;
  const hk_step_in_tile *step;
  size_t first; /* position in `interface` of the round */
} work;

/* The complete blocks from *next to `until`, without the deferred ones. */
static void finish_blocks(const work *w, size_t *next, size_t until, size_t at) {
  for (; *next < until; ++*next)
    if (!w->tiles->front.deferred[*next] && !w->tiles->state->model.riders)
      hk_step_finish(w->tiles, w->step, *next, at);
}

static void take_block(const work *w, size_t block, size_t *next, size_t at) {
  const hk_front *front = &w->tiles->front;
  if (!w->step->prepared) hk_step_prepare_block(w->tiles, w->step, block, at);
  hk_step_count(w->tiles, w->step, block, at);
  hk_step_add(w->tiles, w->step, block, at);
  double clock = hk_step_clock(w->step);
  finish_blocks(w, next, front->complete[block], at);
  hk_step_note_time(w->tiles, w->step, w->tiles->forces->count, at, clock);
}

static void take_domains(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  const hk_partition *p = &w->tiles->front.partition;
  (void)chunk;
  for (size_t domain = begin; domain < end; domain++) {
    size_t first = domain * p->width, last = first + p->width < p->blocks ? first + p->width : p->blocks, next = first;
    for (size_t b = first; b < last; b++) take_block(w, b, &next, domain);
    hk_tile_leave(w->tiles, domain);
  }
}

static void take_interfaces(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  const hk_front *front = &w->tiles->front;
  (void)chunk;
  for (size_t k = w->first + begin; k < w->first + end; k++) {
    size_t at = 2 * front->partition.domains + k;
    hk_step_add(w->tiles, w->step, front->interface[k], at);
    hk_tile_leave(w->tiles, at);
  }
}

static void finish_deferred(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  const hk_front *front = &w->tiles->front;
  const hk_partition *p = &front->partition;
  size_t last = end * p->width < p->blocks ? end * p->width : p->blocks, at = p->domains + chunk;
  double clock = hk_step_clock(w->step);
  for (size_t b = begin * p->width; b < last; b++)
    if (front->deferred[b] && !w->tiles->state->model.riders) hk_step_finish(w->tiles, w->step, b, at);
  hk_step_note_time(w->tiles, w->step, w->tiles->forces->count, at, clock);
}

static void take_by_domains(hk_tiles *tiles, const hk_step_in_tile *step) {
  const hk_front *front = &tiles->front;
  hk_threads *threads = tiles->shared->threads;
  work w = {.tiles = tiles, .step = step};
  hk_threads_for(threads, front->partition.domains, 1, take_domains, &w);
  for (size_t r = 0; r < front->rounds; r++) {
    w.first = front->round[r];
    hk_threads_for(threads, front->round[r + 1] - w.first, 1, take_interfaces, &w);
  }
  if (front->rounds) hk_threads_for(threads, front->partition.domains, 1, finish_deferred, &w);
}

/* ---- the evaluations ---- */

static double seconds_of(const hk_tiles *tiles, size_t force) {
  double all = 0;
  for (size_t at = 0; at < tiles->sums; at++) all += tiles->seconds[force * HK_TILE_SUMS + at];
  return all;
}

/* The wall time of a step goes to the forces in proportion to the threads' time in them. */
static void account(const hk_tiles *tiles, size_t steps, bool sampled, double wall) {
  size_t forces = tiles->forces->count;
  double all = 0;
  for (size_t k = 0; sampled && k <= forces; k++) all += seconds_of(tiles, k);
  for (size_t k = 0; k < forces; k++) {
    hk_instance *force = tiles->forces->item[k];
    if (!hk_tile_takes(tiles, k)) continue;
    force->calls += steps;
    if (!(all > 0)) continue;
    force->seconds += wall / (double)steps * seconds_of(tiles, k) / all;
    force->sampled++;
  }
}

static bool any_sampled(const hk_step_in_tile *step, size_t steps) {
  bool any = false;
  for (size_t k = 0; k < steps; k++) any |= step[k].sampled;
  return any;
}

static double begin_tile(hk_tiles *tiles, size_t sums, bool sampled) {
  tiles->client = tiles->shared->acting ? *tiles->shared->acting : NULL;
  tiles->sums = sums;
  memset(tiles->sum, 0, sums * sizeof *tiles->sum);
  if (sampled) memset(tiles->seconds, 0, (tiles->forces->count + 1) * HK_TILE_SUMS * sizeof *tiles->seconds);
  return sampled ? hk_clock() : 0;
}

static hk_status end_tile(hk_tiles *tiles, size_t steps, bool sampled, double begin) {
  uint64_t bad = 0;
  if (tiles->shared->acting) *tiles->shared->acting = tiles->client; /* not one that left beside another thread */
  for (size_t k = 0; k < tiles->sums; k++) bad |= tiles->sum[k].bad;
  account(tiles, steps, sampled, sampled ? hk_clock() - begin : 0);
  return bad ? HK_NOT_FINITE : HK_OK;
}

static void finish_all(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  const hk_partition *p = &w->tiles->front.partition;
  (void)chunk;
  for (size_t domain = begin; domain < end; domain++)
    for (size_t b = domain * p->width; b < p->blocks && b < (domain + 1) * p->width; b++)
      hk_step_finish(w->tiles, w->step, b, domain);
}

/* What acts on riders acts on their carriers, once all of it is there. */
static void carry_over(hk_tiles *tiles, const hk_step_in_tile *step) {
  work w = {.tiles = tiles, .step = step};
  hk_riders_gather(&tiles->state->model, step->a);
  hk_threads_for(tiles->shared->threads, tiles->front.partition.domains, 1, finish_all, &w);
}

hk_status hk_tile_evaluate(hk_tiles *tiles, const hk_step_in_tile *step, double *power) {
  const hk_front *front = &tiles->front;
  size_t domains = front->partition.domains;
  double begin = begin_tile(tiles, front->rounds ? 2 * domains + front->round[front->rounds] : domains, step->sampled);
  take_by_domains(tiles, step);
  if (tiles->state->model.riders) carry_over(tiles, step);
  for (size_t k = 0; k < tiles->sums; k++) *power += tiles->sum[k].power;
  return end_tile(tiles, 1, step->sampled, begin);
}

hk_status hk_tile_evaluate_several(hk_tiles *tiles, const hk_step_in_tile *step, size_t steps, double *power) {
  bool sampled = any_sampled(step, steps);
  double begin = begin_tile(tiles, steps, sampled);
  hk_tile_by_strips(tiles, step, steps);
  for (size_t k = 0; k < steps; k++) power[k] += tiles->sum[k].power;
  return end_tile(tiles, steps, sampled, begin);
}
