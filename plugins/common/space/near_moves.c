/* A first pass, on several threads, looks whether any particle of a part is near; parts with one are then gone through
 * in order. */
#include "plugins/common/space/near_moves.h"

enum { PARTS = 64, GRAIN = 1024 };

typedef struct sieve {
  const hk_near_moves *moves;
  bool near[PARTS];
} sieve;

static void sift(void *context, size_t begin, size_t end, size_t part) {
  sieve *s = context;
  const hk_near_moves *m = s->moves;
  const double *axis = m->axis, *center = m->center, ways2 = m->ways * m->ways;
  bool near = false, line = axis[0] != 0 || axis[1] != 0 || axis[2] != 0;
  for (size_t k = begin; k < end; k++) {
    size_t i = m->to->active ? m->to->active[k] : k;
    const double *x = m->to->x + 3 * i, *from = m->x_from + 3 * i;
    double dx = x[0] - from[0], dy = x[1] - from[1], dz = x[2] - from[2];
    double rx = x[0] - center[0], ry = x[1] - center[1], rz = x[2] - center[2];
    double along = line ? axis[0] * rx + axis[1] * ry + axis[2] * rz : 0;
    near |= ways2 * (dx * dx + dy * dy + dz * dz) > rx * rx + ry * ry + rz * rz - along * along;
  }
  s->near[part] = near;
}

static void visit_one(const hk_near_moves *m, uint32_t i,
                      void (*each)(void *context, uint32_t i, const double r[3], const double dr[3]), void *context) {
  double r[3], end[3], dr[3];
  hk_from_line(m->center, m->axis, m->x_from + 3 * (size_t)i, r);
  hk_from_line(m->center, m->axis, m->to->x + 3 * (size_t)i, end);
  for (int c = 0; c < 3; c++) dr[c] = end[c] - r[c];
  if (hk_nearest_square(r, dr) < INFINITY) each(context, i, r, dr);
}

void hk_near_moves_visit(const hk_near_moves *m,
                         void (*each)(void *context, uint32_t i, const double r[3], const double dr[3]),
                         void *context) {
  sieve s = {.moves = m};
  size_t acting = m->to->acting, grain = acting / PARTS < GRAIN ? GRAIN : acting / PARTS + 1;
  m->to->host->parallel_for(m->to->host, acting, grain, sift, &s);
  for (size_t part = 0; part * grain < acting; part++)
    for (size_t k = part * grain; s.near[part] && k < acting && k < (part + 1) * grain; k++)
      visit_one(m, m->to->active ? m->to->active[k] : (uint32_t)k, each, context);
}
