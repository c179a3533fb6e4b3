/* Forces on each particle alone: with the loop over some particles, a force has `add` and `add_part`. */
#ifndef HK_PARTICLE_SUMS_H
#define HK_PARTICLE_SUMS_H

#include "plugins/kit/parts/part_lists.h"

/* Adds to F the force on those that it acts on from `begin` to below `end` (view->active[begin] ..., or these particles
 * where there is no list), and returns their power, W. */
typedef double (*hk_range_body)(const void *force, const hk_view *view, size_t begin, size_t end, double *F);

/* F += one part, as hk_force.add_part does it, or HK_ALL_PARTS, on several threads, as hk_force.add; view->power gets
 * their power, the same bits for any number of threads. `force`: the argument of `body`. */
static inline void hk_particle_sums_add(const hk_view *view, size_t part, hk_range_body body, const void *force,
                                        double *F);

/* Particle number k of those that a force acts on. */
static inline size_t hk_acting_particle(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

/* ---- how ---- */

/* Ranges of particles, whose powers are added in their order. */

enum {
  HK_PARTICLE_GRAIN = 2048,
  HK_PARTICLE_CHUNKS = 64
}; /* particles of a chunk, at least, some 10 us; chunks, at most */

typedef struct hk_particle_sums_task {
  const hk_view *view;
  hk_range_body body;
  const void *force;
  double *F;
  double power[HK_PARTICLE_CHUNKS];
} hk_particle_sums_task;

static inline void hk_particle_sums_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  hk_particle_sums_task *t = context;
  t->power[chunk] = t->body(t->force, t->view, begin, end, t->F);
}

static inline double hk_particle_sums_all(const hk_view *view, hk_range_body body, const void *force, double *F) {
  hk_particle_sums_task t;
  double power = 0;
  size_t grain = view->acting / HK_PARTICLE_CHUNKS + 1;
  if (grain < HK_PARTICLE_GRAIN) grain = HK_PARTICLE_GRAIN;
  t.view = view, t.body = body, t.force = force, t.F = F;
  view->host->parallel_for(view->host, view->acting, grain, hk_particle_sums_chunk, &t);
  for (size_t c = 0; c * grain < view->acting; c++) power += t.power[c];
  return power;
}

static inline double hk_particle_sums_part(const hk_view *view, size_t part, hk_range_body body, const void *force,
                                           double *F) {
  size_t begin, end;
  hk_part_acting(view, part, &begin, &end);
  return body(force, view, begin, end, F);
}

static inline void hk_particle_sums_add(const hk_view *view, size_t part, hk_range_body body, const void *force,
                                        double *F) {
  double power = part == HK_ALL_PARTS ? hk_particle_sums_all(view, body, force, F)
                                      : hk_particle_sums_part(view, part, body, force, F);
  if (view->power) *view->power += power;
}

#endif
