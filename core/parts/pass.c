/* One pass over the particles: block by block they are prepared, the forces add their parts, and blocks that nothing
 * touches any more are finished, while their data are in the cache. Domains run at the same time; what acts across them
 * follows in rounds, and then the blocks that had to wait for it. Each domain and each part across domains has a slot
 * for what it sums, and slots are added in their order, so that results do not depend on the number of threads. */
#include "core/parts/parts.h"

#include <stdlib.h>
#include <string.h>

enum { GRAIN = 4096, LANES = 4 };

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
  free(p->chosen);
  free(p->slot);
  free(p->seconds);
}

hk_status hk_parts_arrange(hk_parts *p, hk_error *error) {
  if (!hk_window_begin(&p->window, &p->state->partition))
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the blocks of %zu particles", p->state->model.n);
  hk_part_use use = hk_window_use(&p->window);
  for (size_t k = 0; k < p->forces->count; k++) {
    const hk_instance *force = p->forces->item[k];
    p->chosen[k] = goes_by_parts(force);
    if (!p->chosen[k] || !force->plugin->force->parts) continue;
    const hk_instance *outer = hk_enter(force);
    force->plugin->force->parts(force->self, &p->view[k], &use);
    hk_leave(force, outer);
  }
  hk_window_end(&p->window);
  return HK_OK;
}

/* ---- before and after the forces ---- */

typedef struct task {
  hk_parts *parts;
  const hk_sweep *w;
  size_t first;             /* position in `cross` of the round */
  size_t slots;             /* in use: one for each domain; with parts across domains, two, and one for each of them */
  const hk_instance *outer; /* who asked for the pass */
} task;

static void prepare(const task *t, size_t begin, size_t end) {
  const hk_sweep *w = t->w;
  if (w->pass && w->pass->prepare) w->pass->prepare(w->pass->context, begin, end);
  hk_pins_impose(t->parts->pins, begin, end, w->x, w->v);
  memset(w->a + 3 * begin, 0, 3 * (end - begin) * sizeof *w->a);
}

/* The top bit of (exponent + 1) is set by an exponent of all ones, NaN or infinity. */
static inline uint64_t not_finite(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return (bits & 0x7ff0000000000000u) + 0x0010000000000000u;
}

/* Divides by mass, four particles side by side; returns whether some F is not finite. F itself is checked, so that a
 * force on a fixed particle is included. */
static inline __attribute__((always_inline)) uint64_t divide_fours(const double *restrict inverse, double *F,
                                                                   size_t begin, size_t end) {
  uint64_t bad[3 * LANES] = {0};
  size_t i = begin;
  for (; i + LANES <= end; i += LANES) {
    double *restrict a = F + 3 * i, w[3 * LANES];
    for (size_t l = 0; l < 3 * LANES; l++) w[l] = inverse[i + l / 3];
    for (size_t l = 0; l < 3 * LANES; l++) {
      bad[l] |= not_finite(a[l]);
      a[l] *= w[l];
    }
  }
  for (size_t c = 3 * i; c < 3 * end; c++) {
    bad[0] |= not_finite(F[c]);
    F[c] *= inverse[c / 3];
  }
  for (size_t l = 1; l < 3 * LANES; l++) bad[0] |= bad[l];
  return bad[0] >> 63;
}

static uint64_t divide_narrow(const double *inverse, double *F, size_t begin, size_t end) {
  return divide_fours(inverse, F, begin, end);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static uint64_t divide_wide(const double *inverse, double *F, size_t begin,
                                                            size_t end) {
  return divide_fours(inverse, F, begin, end);
}
#define DIVIDE (__builtin_cpu_supports("avx2") ? divide_wide : divide_narrow)
#else
#define DIVIDE divide_narrow
#endif

static void finish(const task *t, size_t begin, size_t end, size_t at) {
  const hk_sweep *w = t->w;
  const hk_pins *pins = t->parts->pins;
  hk_pass_slot *slot = &t->parts->slot[at];
  if (pins->has_paths) slot->power += hk_pins_power(pins, begin, end, w->a, w->v);
  slot->bad |= DIVIDE(t->parts->state->inverse_mass, w->a, begin, end);
  if (pins->has_slides) hk_pins_slide(pins, begin, end, w->a);
  if (w->pass && w->pass->finish && !w->unfinished) w->pass->finish(w->pass->context, begin, end);
}

static void prepare_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  prepare(context, begin, end);
}

static void finish_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_pass *pass = ((const task *)context)->w->pass;
  (void)chunk;
  pass->finish(pass->context, begin, end);
}

void hk_parts_prepare(hk_parts *p, const hk_sweep *w) {
  task t = {.parts = p, .w = w};
  hk_threads_for(p->shared->threads, p->state->model.n, GRAIN, prepare_chunk, &t);
}

void hk_parts_finish(hk_parts *p, const hk_sweep *w) {
  task t = {.parts = p, .w = w};
  if (w->pass && w->pass->finish) hk_threads_for(p->shared->threads, p->state->model.n, GRAIN, finish_chunk, &t);
}

/* ---- the forces ---- */

/* For messages about a plugin that crashes or does not return, beside other threads in which others are at work. */
static void enter(const task *t, size_t at, const hk_instance *force) {
  const hk_instance *volatile *acting = t->parts->shared->acting;
  t->parts->slot[at].at_work = force;
  hk_acting_here = force;
  if (acting) __atomic_store_n(acting, force, __ATOMIC_RELAXED);
}

/* Who is still at work in another thread is named now. */
static void leave(const task *t, size_t at) {
  const hk_instance *volatile *acting = t->parts->shared->acting, *other = t->outer;
  t->parts->slot[at].at_work = NULL;
  hk_acting_here = NULL;
  if (!acting) return;
  for (size_t k = 0; k < t->slots; k++)
    if (t->parts->slot[k].at_work) other = t->parts->slot[k].at_work;
  __atomic_store_n(acting, other, __ATOMIC_RELAXED);
}

static bool takes_part(const hk_parts *p, size_t k) { return p->chosen[k] && p->acts[k] && p->takes[k]; }

/* s, since when time is measured; 0: it is not. */
static double begin_clock(const task *t) { return t->w->sampled ? hk_clock() : 0; }

/* The time since `begin` goes to force k, or, at the end of the list, to the host and the method. */
static double note_time(const task *t, size_t k, size_t at, double begin) {
  if (!t->w->sampled) return 0;
  double now = hk_clock();
  t->parts->seconds[k * HK_SLOTS + at] += now - begin;
  return now;
}

/* One part of all forces; `at` is its slot. Those without `parts` have no elements across domains. */
static void add_part(const task *t, size_t part, size_t at) {
  const hk_parts *p = t->parts;
  const hk_sweep *w = t->w;
  bool across = part >= p->window.partition.blocks;
  double clock = begin_clock(t);
  for (size_t k = 0; k < p->forces->count; k++) {
    const hk_instance *force = p->forces->item[k];
    if (!takes_part(p, k) || (across && !force->plugin->force->parts)) continue;
    hk_view view = p->view[k];
    view.t = w->t, view.x = w->x, view.v = w->v, view.y = w->y;
    view.power = &p->slot[at].power;
    enter(t, at, force);
    force->plugin->force->add_part(force->self, &view, part, w->a);
    clock = note_time(t, k, at, clock);
  }
}

static size_t end_of(const hk_partition *p, size_t block) {
  size_t end = (block + 1) << p->bits;
  return end < p->n ? end : p->n;
}

/* The complete blocks from *next to `until`, without the late ones. */
static void finish_blocks(const task *t, size_t *next, size_t until, size_t at) {
  const hk_window *window = &t->parts->window;
  for (; *next < until; ++*next)
    if (!window->late[*next]) finish(t, *next << window->partition.bits, end_of(&window->partition, *next), at);
}

static void sweep_block(const task *t, size_t block, size_t *next, size_t at) {
  const hk_window *window = &t->parts->window;
  size_t own = t->parts->forces->count;
  double clock = begin_clock(t);
  if (!t->w->prepared) prepare(t, block << window->partition.bits, end_of(&window->partition, block));
  note_time(t, own, at, clock);
  add_part(t, block, at);
  clock = begin_clock(t);
  finish_blocks(t, next, window->done[block], at);
  note_time(t, own, at, clock);
}

static void sweep_domains(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_partition *p = &t->parts->window.partition;
  (void)chunk;
  for (size_t domain = begin; domain < end; domain++) {
    size_t first = domain * p->width, last = first + p->width < p->blocks ? first + p->width : p->blocks, next = first;
    for (size_t b = first; b < last; b++) sweep_block(t, b, &next, domain);
    leave(t, domain);
  }
}

static void add_across(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_window *window = &t->parts->window;
  (void)chunk;
  for (size_t k = t->first + begin; k < t->first + end; k++) {
    size_t at = 2 * window->partition.domains + k;
    add_part(t, window->cross[k], at);
    leave(t, at);
  }
}

static void finish_late(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_window *window = &t->parts->window;
  const hk_partition *p = &window->partition;
  size_t last = end * p->width < p->blocks ? end * p->width : p->blocks, at = p->domains + chunk;
  double clock = begin_clock(t);
  for (size_t b = begin * p->width; b < last; b++)
    if (window->late[b]) finish(t, b << p->bits, end_of(p, b), at);
  note_time(t, t->parts->forces->count, at, clock);
}

/* ---- the whole ---- */

static double sum(const double *list, size_t count) {
  double all = 0;
  for (size_t e = 0; e < count; e++) all += list[e];
  return all;
}

/* The wall time of the pass goes to the forces in proportion to the threads' time in them. */
static void account(const task *t, double wall) {
  const hk_parts *p = t->parts;
  size_t forces = p->forces->count;
  double all = t->w->sampled ? sum(p->seconds, (forces + 1) * HK_SLOTS) : 0;
  for (size_t k = 0; k < forces; k++) {
    hk_instance *force = p->forces->item[k];
    if (!takes_part(p, k)) continue;
    force->calls++;
    if (!t->w->sampled) continue;
    force->seconds += all > 0 ? wall * sum(p->seconds + k * HK_SLOTS, HK_SLOTS) / all : 0;
    force->sampled++;
  }
}

static void run(task *t) {
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
  task t = {.parts = p, .w = w, .slots = window->rounds ? 2 * domains + window->round[window->rounds] : domains};
  double begin = begin_clock(&t);
  uint64_t bad = 0;
  t.outer = p->shared->acting ? *p->shared->acting : NULL;
  memset(p->slot, 0, t.slots * sizeof *p->slot);
  if (w->sampled) memset(p->seconds, 0, (p->forces->count + 1) * HK_SLOTS * sizeof *p->seconds);
  run(&t);
  for (size_t k = 0; k < t.slots; k++) {
    *power += p->slot[k].power;
    bad |= p->slot[k].bad;
  }
  account(&t, begin_clock(&t) - begin);
  return bad ? HK_NOT_FINITE : HK_OK;
}
