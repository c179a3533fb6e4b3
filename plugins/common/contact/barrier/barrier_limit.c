/* The part of a move that is safe: until the first pair comes nearer than a tenth of its present gap, by continuous
 * collision detection (geometry/ccd.h). Pairs whose points do not move that far are not asked. */
#include "plugins/common/contact/barrier/barrier_contacts.h"
#include "plugins/common/contact/geometry/ccd.h"

#include <float.h>

/* Of the present gap: what is left of it by a move, and the tolerance of the contact's time. The smaller they are, the
 * longer are the moves, and the more they cost. */
static const double left = 0.1, tolerance = 0.1;

typedef struct move {
  const hk_barrier_pair *near;
  const double *x, *dx;
  double *least; /* of the chunks */
} move;

/* The safe part for one pair; `most`: that of others, beyond which nothing needs to be known. */
static double limit_of(const hk_barrier_pair *p, const double *x, const double *dx, double most) {
  double x0[12], x1[12], t = 1;
  if (p->least >= left * p->pair.gap && p->least > 0) return most;
  if (!(p->pair.gap > 0)) return 0;
  hk_pair_gather(&p->pair, x, x0);
  hk_pair_gather(&p->pair, dx, x1);
  for (int e = 0; e < 12; e++) x1[e] = x0[e] + most * x1[e];
  bool hit = hk_ccd(p->pair.kind, x0, x1, p->pair.offset + left * p->pair.gap, tolerance * p->pair.gap, &t);
  return hit ? most * t : most;
}

static void limit_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const move *m = context;
  double least = 1;
  for (size_t k = begin; k < end; k++) least = limit_of(&m->near[k], m->x, m->dx, least);
  m->least[chunk] = least;
}

double hk_barrier_limit(hk_barrier_contacts *c, const hk_view *from, const double *dx) {
  double least = 1;
  move m = {c->near.item, from->x, dx, c->sums.item};
  from->host->parallel_for(from->host, c->found, HK_BARRIER_GRAIN, limit_chunk, &m);
  for (size_t k = 0; k * HK_BARRIER_GRAIN < c->found; k++) least = fmin(least, m.least[k]);
  return fmax(least, DBL_MIN); /* a pair in contact allows no move at all; the contract asks for more than 0 */
}
