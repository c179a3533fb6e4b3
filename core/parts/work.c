/* What a pass does with one block of particles or one part of the forces. */
#include "core/parts/work.h"

#include <string.h>

enum { LANES = 4 };

/* ---- before and after the forces ---- */

void hk_part_prepare(const hk_part_work *t, size_t begin, size_t end) {
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

void hk_part_finish(const hk_part_work *t, size_t begin, size_t end, size_t at) {
  const hk_sweep *w = t->w;
  const hk_pins *pins = t->parts->pins;
  hk_pass_slot *slot = &t->parts->slot[at];
  if (pins->has_paths) slot->power += hk_pins_power(pins, begin, end, w->a, w->v);
  slot->bad |= DIVIDE(t->parts->state->inverse_mass, w->a, begin, end);
  if (pins->has_slides) hk_pins_slide(pins, begin, end, w->a);
  if (w->pass && w->pass->finish && !w->unfinished) w->pass->finish(w->pass->context, begin, end);
}

/* ---- the forces ---- */

/* For messages about a plugin that crashes or does not return, beside other threads in which others are at work. */
static void enter(const hk_part_work *t, size_t at, const hk_instance *force) {
  const hk_instance *volatile *acting = t->parts->shared->acting;
  t->parts->slot[at].at_work = force;
  hk_acting_here = force;
  if (acting) __atomic_store_n(acting, force, __ATOMIC_RELAXED);
}

/* Who is still at work in another thread is named now. */
void hk_part_leave(const hk_part_work *t, size_t at) {
  const hk_instance *volatile *acting = t->parts->shared->acting, *other = t->outer;
  t->parts->slot[at].at_work = NULL;
  hk_acting_here = NULL;
  if (!acting) return;
  for (size_t k = 0; k < t->slots; k++)
    if (t->parts->slot[k].at_work) other = t->parts->slot[k].at_work;
  __atomic_store_n(acting, other, __ATOMIC_RELAXED);
}

bool hk_part_taken(const hk_parts *p, size_t k) { return p->chosen[k] && p->acts[k] && p->takes[k]; }

/* s, since when time is measured; 0: it is not. */
double hk_part_clock(const hk_part_work *t) { return t->w->sampled ? hk_clock() : 0; }

/* The time since `begin` goes to force k, or, at the end of the list, to the host and the method. */
double hk_part_note_time(const hk_part_work *t, size_t k, size_t at, double begin) {
  if (!t->w->sampled) return 0;
  double now = hk_clock();
  t->parts->seconds[k * HK_SLOTS + at] += now - begin;
  return now;
}

/* One part of all forces; `at` is its slot. Those without `parts` have no elements across domains. */
void hk_part_add(const hk_part_work *t, size_t part, size_t at) {
  const hk_parts *p = t->parts;
  const hk_sweep *w = t->w;
  bool across = part >= p->window.partition.blocks;
  double clock = hk_part_clock(t);
  for (size_t k = 0; k < p->forces->count; k++) {
    const hk_instance *force = p->forces->item[k];
    if (!hk_part_taken(p, k) || (across && !force->plugin->force->parts)) continue;
    hk_view view = p->view[k];
    view.t = w->t, view.x = w->x, view.v = w->v, view.y = w->y;
    view.power = &p->slot[at].power;
    enter(t, at, force);
    force->plugin->force->add_part(force->self, &view, part, w->a);
    clock = hk_part_note_time(t, k, at, clock);
  }
}
