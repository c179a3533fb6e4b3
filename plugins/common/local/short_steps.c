/* From rest at x, with the acceleration a(q) = a + w (F(q) - F(x)), where F are the stiff springs alone and a is that
 * of all forces at x, the particles move by d_p in p steps, d_1 = g_0 a(x),   d_{k+1} = d_k + f_k (d_k - d_{k-1}) + g_k
 * a(x + d_k), f_k = T_{k-1}/T_{k+1},   g_k = 2 h^2 T_k/(omega T_{k+1}),   T_k = T_k(delta) = cosh(k s/p)
 * (local_filter.h) and 2 d_p/h^2 is the acceleration of the long step: a itself where no stiff spring acts. What moves
 * evenly from rest, forwards and backwards in time, has no velocity in it. The forces of every short step sum to zero,
 * so that momentum is kept to rounding. */
#include "plugins/common/local/short_steps.h"

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
  double *restrict q = s->q + first, *restrict change = s->change + first, *restrict F = s->F + first, f = p->f,
                   g = p->g;
  const double *restrict a = s->a + first, *restrict w = s->inverse_mass + first;
  (void)chunk;
  for (size_t i = p->begin + begin; s->projector && i < p->begin + end; i++) filter(s, i);
  for (size_t e = 0; e < count; e++) {
    double d = f * change[e] + g * (a[e] + w[e] * F[e]);
    change[e] = d;
    q[e] += d;
    F[e] = 0;
  }
}

static void add_forces(hk_short_steps *s, const hk_host *host, const hk_short_part *part) {
  size_t at = 3 * part->begin;
  hk_spring_forces(&part->layout, host, s->q + at, s->q + at, s->F + at, NULL);
}

static void gather(hk_short_steps *s, const double *x, const double *a) {
  for (size_t i = 0; i < s->n; i++) {
    size_t from = 3 * (size_t)s->index[i];
    memcpy(s->q + 3 * i, x + from, 3 * sizeof *x);
    memcpy(s->a + 3 * i, a + from, 3 * sizeof *a);
  }
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
  int p = hk_local_count(h * h * part->modes.stiffest);
  double delta = hk_local_delta(p), scale = 2 * h * h / hk_local_omega(p), before = delta, T = 1;
  start_part(s, host, part);
  for (int k = 0; k < p; k++) { /* as d is even, T_{-1} = T_1 and the first step is half of what the rule says */
    double next = k == 0 ? delta : 2 * delta * T - before;
    pass step = {s, part->begin, k == 0 ? 0 : before / next, (k == 0 ? 0.5 : 1) * scale * T / next};
    if (k > 0) add_forces(s, host, part);
    host->parallel_for(host, part->n, GRAIN, advance, &step);
    before = T;
    T = next;
  }
}

void hk_short_steps_take(hk_short_steps *s, const hk_host *host, const double *x, double h, double *a) {
  gather(s, x, a);
  for (size_t k = 0; k < s->parts; k++) take_part(s, host, &s->part[k], h);
  for (size_t e = 0; e < 3 * s->n; e++) {
    size_t at = 3 * (size_t)s->index[e / 3] + e % 3;
    a[at] = 2 / (h * h) * (s->q[e] - x[at]);
  }
}
