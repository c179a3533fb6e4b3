#include "plugins/common/liquid/liquid_balance.h"
#include "plugins/kit/vector3.h"

enum { TURNS = 64 };

static const double touching = 1e-6; /* of the way: so near is on the surface */

void hk_liquid_balance_count(hk_liquid_balance *b, const hk_liquid_particles *p, size_t n, bool first,
                             double *counted) {
  double stayed = 0, came = 0;
  int64_t number = 0;
  for (size_t k = 0; k < p->count; k++) {
    double *own = &counted[p->index[k]];
    number += *own > 0;
    stayed += *own;
    if (!(*own > 0)) came += *own = p->mass[p->index[k]];
    *own = -*own; /* of those that are the liquid now */
  }
  for (size_t i = 0; i < n; i++) counted[i] = fmax(0, -counted[i]);
  if (!first && number < b->number) b->went += b->held - stayed;
  if (!first) b->came += came;
  b->held = stayed + came;
  b->number = (int64_t)p->count;
}

void hk_liquid_balance_leak(hk_liquid_balance *b, const hk_liquid *l, const hk_liquid_particles *p, bool again) {
  double leaked = 0;
  for (size_t k = 0; k < p->count; k++)
    if (l->through[k]) leaked += p->mass[p->index[k]];
  if (!again) b->leaked_before = b->leaked;
  b->leaked = b->leaked_before + leaked;
}

/* Steps as long as the surface is away: sphere tracing. A particle that was pushed out of the obstacle before begins on
 * its surface. */
bool hk_liquid_passes(const hk_obstacle *o, const double from[3], const double to[3]) {
  double p[3], q[3], way[3], in[3], out[3], done = 0;
  hk_body_point(&o->motion.start, from, p);
  hk_body_point(&o->motion.end, to, q);
  hk_subtract(way, q, p);
  double length = hk_length(way);
  if (hk_shape_distance(&o->shape, q, out) >= length) return false;
  double gap = hk_shape_distance(&o->shape, p, in);
  if (hk_dot(in, out) >= 0 || gap < -touching * length) return false;
  for (int turn = 0; turn < TURNS && gap > touching * length && done < length; turn++) {
    double n[3];
    done += gap;
    hk_add_scaled(p, gap / length, way);
    gap = hk_shape_distance(&o->shape, p, n);
  }
  return done < length && gap <= touching * length;
}

double hk_liquid_volume(const hk_liquid *l) {
  const hk_liquid_grid *g = &l->grid;
  double sum = 0;
  for (size_t k = 0; k < hk_liquid_rows(g, 0); k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + g->cells[hk_liquid_inner(g)]; i++)
      sum += hk_liquid_open_cell(g, i) * fmax(0, fmin(1, 0.5 - g->distance[i]));
  }
  return l->walled ? sum * hk_liquid_cell_volume(g) : NAN;
}
