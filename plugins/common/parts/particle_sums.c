/* Ranges of particles, whose powers are added in their order. */
#include "plugins/common/parts/particle_sums.h"

enum { GRAIN = 2048, CHUNKS = 64 }; /* particles of a chunk, at least, some 10 us; chunks, at most */

typedef struct task {
  const hk_view *view;
  hk_range_body body;
  const void *force;
  double *F;
  double power[CHUNKS];
} task;

static void add_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  task *t = context;
  t->power[chunk] = t->body(t->force, t->view, begin, end, t->F);
}

static double add_all(const hk_view *view, hk_range_body body, const void *force, double *F) {
  task t;
  double power = 0;
  size_t grain = view->acting / CHUNKS + 1;
  if (grain < GRAIN) grain = GRAIN;
  t.view = view, t.body = body, t.force = force, t.F = F;
  view->host->parallel_for(view->host, view->acting, grain, add_chunk, &t);
  for (size_t c = 0; c * grain < view->acting; c++) power += t.power[c];
  return power;
}

static double add_part(const hk_view *view, size_t part, hk_range_body body, const void *force, double *F) {
  size_t begin, end;
  hk_part_acting(view, part, &begin, &end);
  return body(force, view, begin, end, F);
}

void hk_particle_sums_add(const hk_view *view, size_t part, hk_range_body body, const void *force, double *F) {
  double power = part == HK_ALL_PARTS ? add_all(view, body, force, F) : add_part(view, part, body, force, F);
  if (view->power) *view->power += power;
}
