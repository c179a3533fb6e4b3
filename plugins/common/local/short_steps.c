/* From rest at x, with the acceleration a(d) = a + w (F(x + d) - F(x)), where F are the stiff springs alone and a is
 * that of all forces at x, the particles move by d_p in p short steps (local_filter.h), and 2 d_p/h^2 is the
 * acceleration of the long step: a itself where no stiff spring acts. What moves evenly from rest, forwards and
 * backwards in time, has no velocity in it. The forces of every short step sum to zero, so that momentum is kept to
 * rounding, which is that of d, not of x. */
#include "plugins/common/local/short_steps.h"
#include "plugins/common/springs/layout_forces.h"

#include <string.h>

enum { GRAIN = 2048 };

typedef struct pass {
  const hk_short_steps *s;
  size_t begin;
  double f, g;
} pass;

static void filter(const hk_short_steps *s, size_t i) {
  const double *P = s->projector[i];
  double *F = s->F + 3 * i, b[3] = {F[0], F[1], F[2]};
  for (int r = 0; r < 3; r++) F[r] = P[3 * r] * b[0] + P[3 * r + 1] * b[1] + P[3 * r + 2] * b[2];
}

/* One short step of some particles, with the forces F at q, which are cleared. `a` is a - w F(x). */
static void advance(void *context, size_t begin, size_t end, size_t chunk) {
  const pass *p = context;
  const hk_short_steps *s = p->s;
  size_t first = 3 * (p->begin + begin), count = 3 * (end - begin);
  double *restrict q = s->q + first, *restrict d = s->d + first, *restrict change = s->change + first,
                   *restrict F = s->F + first, f = p->f, g = p->g;
  const double *restrict a = s->a + first, *restrict w = s->inverse_mass + first, *restrict x = s->x + first;
  (void)chunk;
  for (size_t i = p->begin + begin; s->projector && i < p->begin + end; i++) filter(s, i);
  for (size_t e = 0; e < count; e++) {
    double step = f * change[e] + g * (a[e] + w[e] * F[e]);
    change[e] = step;
    d[e] += step;
    q[e] = x[e] + d[e];
    F[e] = 0;
  }
}

static void add_forces(hk_short_steps *s, const hk_host *host, const hk_short_part *part) {
  size_t at = 3 * part->begin;
  hk_layout_forces(&part->layout, host, s->q + at, s->q + at, s->F + at, NULL);
}

static void gather(hk_short_steps *s, const double *x, const double *a) {
  for (size_t i = 0; i < s->n; i++) {
    size_t from = 3 * (size_t)s->index[i];
    memcpy(s->x + 3 * i, x + from, 3 * sizeof *x);
    memcpy(s->a + 3 * i, a + from, 3 * sizeof *a);
  }
  memcpy(s->q, s->x, 3 * s->n * sizeof *s->q);
  memset(s->d, 0, 3 * s->n * sizeof *s->d);
  memset(s->change, 0, 3 * s->n * sizeof *s->change);
  memset(s->F, 0, 3 * s->n * sizeof *s->F);
}

/* a -= w F(x). */
static void start_part(hk_short_steps *s, const hk_host *host, const hk_short_part *part) {
  add_forces(s, host, part);
  for (size_t i = part->begin; s->projector && i < part->begin + part->n; i++) filter(s, i);
  for (size_t e = 3 * part->begin; e < 3 * (part->begin + part->n); e++) s->a[e] -= s->inverse_mass[e] * s->F[e];
}

static void take_part(hk_short_steps *s, const hk_host *host, const hk_short_part *part, double h) {
  const hk_local_rule rule = hk_local_rule_of(part->stiffest, s->shift, h);
  hk_local_step step = hk_local_first(&rule);
  start_part(s, host, part);
  for (int k = 0; k < rule.count; k++) {
    pass now = {s, part->begin, step.f, step.g};
    if (k > 0) add_forces(s, host, part);
    host->parallel_for(host, part->n, GRAIN, advance, &now);
    hk_local_next(&rule, &step);
  }
}

static void scatter(const hk_short_steps *s, double h, double *a, double *v) {
  double by = 2 / (h * h), kick = h / 2;
  for (size_t i = 0; i < s->n; i++)
    for (size_t c = 0; c < 3; c++) {
      size_t at = 3 * (size_t)s->index[i] + c;
      double now = by * s->d[3 * i + c];
      if (v) v[at] += kick * (now - a[at]);
      a[at] = now;
    }
}

void hk_short_steps_take(hk_short_steps *s, const hk_host *host, const double *x, double h, double *a, double *v) {
  hk_short_lanes_take(&s->lanes, host, x, h, a, v);
  if (s->n == 0) return;
  gather(s, x, a);
  for (size_t k = 0; k < s->parts; k++)
    if (s->part[k].n) take_part(s, host, &s->part[k], h);
  scatter(s, h, a, v);
}
