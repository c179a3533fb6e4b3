/* One pass over the particles: block by block they are prepared, the forces add their parts, and blocks that nothing
 * touches any more are finished, while their data are in the cache. Domains run at the same time; what acts across them
 * follows in rounds, and then the blocks that had to wait for it. Each domain and each part across domains has a slot
 * for what it sums, and slots are added in their order, so that results do not depend on the number of threads. */
#include "core/parts/work.h"

#include <stdlib.h>
#include <string.h>

enum { GRAIN = 4096 };

/* ---- which forces are asked for parts ---- */

/* Its work is computed from the F of that force alone. */
bool hk_work_unaccounted(const hk_instance *force) {
  const hk_force *functions = force->plugin->force;
  return functions->energy ? force->spec->timed_count > 0 : !(functions->flags & HK_POWER);
}

static bool publishes(const hk_plugin *plugin) {
  bool any = false;
  for (const hk_field *f = plugin->fields; f && f->name; f++) any |= (f->flags & HK_PUBLISHED) != 0;
  return any;
}

static bool goes_by_parts(const hk_instance *force) {
  const hk_force *functions = force->plugin->force;
  return force->started && functions->add_part && !functions->rates && !publishes(force->plugin) &&
         !hk_work_unaccounted(force);
}

bool hk_parts_open(hk_parts *p) {
  p->chosen = calloc(p->forces->count + 1, sizeof *p->chosen);
  p->slot = calloc(HK_SLOTS, sizeof *p->slot);
  p->seconds = calloc((p->forces->count + 1) * HK_SLOTS, sizeof *p->seconds);
  return p->chosen && p->slot && p->seconds;
}

void hk_parts_close(hk_parts *p) {
  hk_window_close(&p->window);
  hk_wave_close(&p->wave);
  free(p->chosen);
  free(p->slot);
  free(p->seconds);
}

/* What all forces touch, in a partition like that of the state or as if it had one domain. */
static bool ask(hk_parts *p, hk_window *window, const hk_partition *partition) {
  if (!hk_window_begin(window, partition)) return false;
  hk_part_use use = hk_window_use(window);
  for (size_t k = 0; k < p->forces->count; k++) {
    const hk_instance *force = p->forces->item[k];
    if (!p->chosen[k] || !force->plugin->force->parts) continue;
    const hk_instance *outer = hk_enter(force);
    force->plugin->force->parts(force->self, &p->view[k], &use);
    hk_leave(force, outer);
  }
  return true;
}

static bool arrange_wave(hk_parts *p) {
  hk_partition whole = p->state->partition;
  hk_window reach = {0};
  whole.width = whole.blocks, whole.domains = 1, whole.parts = whole.blocks + 1;
  bool fine = ask(p, &reach, &whole) && hk_wave_arrange(&p->wave, &p->window, &reach);
  hk_window_close(&reach);
  return fine;
}

hk_status hk_parts_arrange(hk_parts *p, hk_error *error) {
  for (size_t k = 0; k < p->forces->count; k++) p->chosen[k] = goes_by_parts(p->forces->item[k]);
  bool fine = ask(p, &p->window, &p->state->partition);
  if (fine) hk_window_end(&p->window);
  if (!fine || !arrange_wave(p))
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the blocks of %zu particles", p->state->model.n);
  return HK_OK;
}

/* ---- before and after the forces ---- */

static void prepare_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  hk_part_prepare(context, begin, end);
}

static void finish_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_pass *pass = ((const hk_part_work *)context)->w->pass;
  (void)chunk;
  pass->finish(pass->context, begin, end);
}

void hk_parts_prepare(hk_parts *p, const hk_sweep *w) {
  hk_part_work t = {.parts = p, .w = w};
  hk_threads_for(p->shared->threads, p->state->model.n, GRAIN, prepare_chunk, &t);
}

void hk_parts_finish(hk_parts *p, const hk_sweep *w) {
  hk_part_work t = {.parts = p, .w = w};
  if (w->pass && w->pass->finish) hk_threads_for(p->shared->threads, p->state->model.n, GRAIN, finish_chunk, &t);
}

/* ---- the blocks of a domain, and what acts across domains ---- */

/* The complete blocks from *next to `until`, without the late ones. */
static void finish_blocks(const hk_part_work *t, size_t *next, size_t until, size_t at) {
  const hk_window *window = &t->parts->window;
  for (; *next < until; ++*next)
    if (!window->late[*next])
      hk_part_finish(t, *next << window->partition.bits, hk_part_end(&window->partition, *next), at);
}

static void sweep_block(const hk_part_work *t, size_t block, size_t *next, size_t at) {
  const hk_window *window = &t->parts->window;
  size_t own = t->parts->forces->count;
  double clock = hk_part_clock(t);
  if (!t->w->prepared) hk_part_prepare(t, block << window->partition.bits, hk_part_end(&window->partition, block));
  hk_part_note_time(t, own, at, clock);
  hk_part_add(t, block, at);
  clock = hk_part_clock(t);
  finish_blocks(t, next, window->done[block], at);
  hk_part_note_time(t, own, at, clock);
}

static void sweep_domains(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_part_work *t = context;
  const hk_partition *p = &t->parts->window.partition;
  (void)chunk;
  for (size_t domain = begin; domain < end; domain++) {
    size_t first = domain * p->width, last = first + p->width < p->blocks ? first + p->width : p->blocks, next = first;
    for (size_t b = first; b < last; b++) sweep_block(t, b, &next, domain);
    hk_part_leave(t, domain);
  }
}

static void add_across(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_part_work *t = context;
  const hk_window *window = &t->parts->window;
  (void)chunk;
  for (size_t k = t->first + begin; k < t->first + end; k++) {
    size_t at = 2 * window->partition.domains + k;
    hk_part_add(t, window->cross[k], at);
    hk_part_leave(t, at);
  }
}

static void finish_late(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_part_work *t = context;
  const hk_window *window = &t->parts->window;
  const hk_partition *p = &window->partition;
  size_t last = end * p->width < p->blocks ? end * p->width : p->blocks, at = p->domains + chunk;
  double clock = hk_part_clock(t);
  for (size_t b = begin * p->width; b < last; b++)
    if (window->late[b]) hk_part_finish(t, b << p->bits, hk_part_end(p, b), at);
  hk_part_note_time(t, t->parts->forces->count, at, clock);
}

/* ---- the whole ---- */

static double sum(const double *list, size_t count) {
  double all = 0;
  for (size_t e = 0; e < count; e++) all += list[e];
  return all;
}

/* The wall time of the pass goes to the forces in proportion to the threads' time in them. */
static void account(const hk_part_work *t, double wall) {
  const hk_parts *p = t->parts;
  size_t forces = p->forces->count;
  double all = t->w->sampled ? sum(p->seconds, (forces + 1) * HK_SLOTS) : 0;
  for (size_t k = 0; k < forces; k++) {
    hk_instance *force = p->forces->item[k];
    if (!hk_part_taken(p, k)) continue;
    force->calls++;
    if (!t->w->sampled) continue;
    force->seconds += all > 0 ? wall * sum(p->seconds + k * HK_SLOTS, HK_SLOTS) / all : 0;
    force->sampled++;
  }
}

static void run(hk_part_work *t) {
  const hk_window *window = &t->parts->window;
  hk_threads *threads = t->parts->shared->threads;
  hk_threads_for(threads, window->partition.domains, 1, sweep_domains, t);
  for (size_t r = 0; r < window->rounds; r++) {
    t->first = window->round[r];
    hk_threads_for(threads, window->round[r + 1] - t->first, 1, add_across, t);
  }
  if (window->rounds) hk_threads_for(threads, window->partition.domains, 1, finish_late, t);
}

hk_status hk_parts_run(hk_parts *p, const hk_sweep *w, double *power) {
  const hk_window *window = &p->window;
  size_t domains = window->partition.domains;
  hk_part_work t = {
      .parts = p, .w = w, .slots = window->rounds ? 2 * domains + window->round[window->rounds] : domains};
  double begin = hk_part_clock(&t);
  uint64_t bad = 0;
  t.outer = p->shared->acting ? *p->shared->acting : NULL;
  memset(p->slot, 0, t.slots * sizeof *p->slot);
  if (w->sampled) memset(p->seconds, 0, (p->forces->count + 1) * HK_SLOTS * sizeof *p->seconds);
  run(&t);
  for (size_t k = 0; k < t.slots; k++) {
    *power += p->slot[k].power;
    bad |= p->slot[k].bad;
  }
  account(&t, hk_part_clock(&t) - begin);
  return bad ? HK_NOT_FINITE : HK_OK;
}
