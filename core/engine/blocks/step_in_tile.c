/* What a step in a tile does with one block of particles or one part of the forces. */
#include "core/engine/blocks/step_in_tile.h"

#include <string.h>

/* ---- forces become accelerations ---- */

enum { EIGHT = 8 };

#define HK_LOOPS "core/engine/blocks/divide_loop.h"
#include "core/plugin/each_width.h"

/* F *= inverse, n numbers, 1/kg, for the particles begin to end - 1; whether all F were finite: F itself is looked at,
 * so that a force on a fixed particle is included. */
static bool divide(int lanes, const double *inverse, double *F, size_t begin, size_t end) {
  size_t single = end - (end - begin) % EIGHT;
  double bad = 0;
  bool finite = single == begin || HK_WIDEST(lanes, divide_eights)(inverse, F, begin, single);
  for (size_t c = 3 * single; c < 3 * end; c++) {
    bad += F[c] * 0;
    F[c] *= inverse[c / 3];
  }
  return finite && bad == 0;
}

/* ---- before and after the forces ---- */

/* The particle after the last one of a block. */
static size_t end_of(const hk_partition *p, size_t block) {
  size_t end = (block + 1) << p->bits;
  return end < p->n ? end : p->n;
}

void hk_step_prepare(const hk_tiles *tiles, const hk_step_in_tile *s, size_t begin, size_t end) {
  if (s->fused && s->fused->before) s->fused->before(s->fused->context, begin, end);
  if (tiles->pins->has_paths || tiles->pins->has_slides) hk_pins_impose(tiles->pins, begin, end, s->x, s->v);
  memset(s->a + 3 * begin, 0, 3 * (end - begin) * sizeof *s->a);
}

void hk_step_prepare_block(const hk_tiles *tiles, const hk_step_in_tile *s, size_t block, size_t at) {
  const hk_partition *p = &tiles->front.partition;
  double clock = hk_step_clock(s);
  hk_step_prepare(tiles, s, block << p->bits, end_of(p, block));
  hk_step_note_time(tiles, s, tiles->forces->count, at, clock);
}

double hk_step_power(const double *F, const double *v, size_t begin, size_t end) {
  double part[8] = {0}; /* several sums, so that none waits for the one before it */
  size_t e = begin;
  for (; e + 8 <= end; e += 8)
    for (size_t r = 0; r < 8; r++) part[r] += F[e + r] * v[e + r];
  for (; e < end; e++) part[(e - begin) % 8] += F[e] * v[e];
  return ((part[0] + part[4]) + (part[1] + part[5])) + ((part[2] + part[6]) + (part[3] + part[7]));
}

/* Forces that come by parts have added nothing to it yet: they touch none but lower blocks. */
void hk_step_count(const hk_tiles *tiles, const hk_step_in_tile *s, size_t block, size_t at) {
  const hk_partition *p = &tiles->front.partition;
  if (s->counts) tiles->sum[at].power += hk_step_power(s->a, s->v, 3 * (block << p->bits), 3 * end_of(p, block));
}

/* So many particles are divided, corrected and begun for the next step at once, while their numbers are in the
 * first-level cache. Measured with 64, 128 and 256: equally fast. */
enum { AT_ONCE = 128 };

static void finish_few(const hk_tiles *tiles, const hk_step_in_tile *s, size_t begin, size_t end, hk_tile_sum *sum) {
  const hk_pins *pins = tiles->pins;
  sum->bad |= !divide(tiles->shared->lanes, tiles->state->inverse_mass, s->a, begin, end);
  if (pins->has_slides) hk_pins_slide(pins, begin, end, s->a);
  if (s->fused && s->fused->after && !s->unfinished) s->fused->after(s->fused->context, begin, end);
  if (s->next) hk_step_prepare(tiles, s->next, begin, end);
}

void hk_step_finish(const hk_tiles *tiles, const hk_step_in_tile *s, size_t block, size_t at) {
  const hk_partition *p = &tiles->front.partition;
  const hk_pins *pins = tiles->pins;
  const size_t begin = block << p->bits, end = end_of(p, block);
  hk_tile_sum *sum = &tiles->sum[at];
  if (pins->has_paths) sum->power += hk_pins_power(pins, begin, end, s->a, s->v);
  for (size_t i = begin; i < end; i += AT_ONCE) finish_few(tiles, s, i, i + AT_ONCE < end ? i + AT_ONCE : end, sum);
}

/* ---- the forces ---- */

/* For messages about a plugin that crashes or does not return, beside other threads in which others are at work. */
static void enter(const hk_tiles *tiles, size_t at, const hk_instance *force) {
  const hk_instance *volatile *acting = tiles->shared->acting;
  tiles->sum[at].at_work = force;
  hk_acting_here = force;
  if (acting) __atomic_store_n(acting, force, __ATOMIC_RELAXED);
}

void hk_tile_leave(const hk_tiles *tiles, size_t at) {
  const hk_instance *volatile *acting = tiles->shared->acting, *other = tiles->client;
  tiles->sum[at].at_work = NULL;
  hk_acting_here = NULL;
  for (size_t k = 0; k < tiles->sums; k++)
    if (tiles->sum[k].at_work) other = tiles->sum[k].at_work;
  if (acting) __atomic_store_n(acting, other, __ATOMIC_RELAXED);
}

bool hk_tile_takes(const hk_tiles *tiles, size_t k) { return tiles->chosen[k] && tiles->acts[k] && tiles->takes[k]; }

double hk_step_clock(const hk_step_in_tile *s) { return s->sampled ? hk_clock() : 0; }

double hk_step_note_time(const hk_tiles *tiles, const hk_step_in_tile *s, size_t k, size_t at, double begin) {
  if (!s->sampled) return 0;
  double now = hk_clock();
  tiles->seconds[k * HK_TILE_SUMS + at] += now - begin;
  return now;
}

void hk_step_add(const hk_tiles *tiles, const hk_step_in_tile *s, size_t part, size_t at) {
  bool interface = part >= tiles->front.partition.blocks;
  double clock = hk_step_clock(s);
  for (size_t k = 0; k < tiles->forces->count; k++) {
    const hk_instance *force = tiles->forces->item[k];
    if (!hk_tile_takes(tiles, k) || (interface && !tiles->between[k])) continue;
    hk_view view = tiles->view[k];
    view.t = s->t, view.x = s->x, view.v = s->v, view.y = s->y;
    view.power = &tiles->sum[at].power;
    enter(tiles, at, force);
    force->plugin->force->add_part(force->self, &view, part, s->a);
    clock = hk_step_note_time(tiles, s, k, at, clock);
  }
}
