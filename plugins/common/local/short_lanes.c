/* The loops over lanes are written for the compiler's vectors, and are compiled for the widest ones of x86-64 as well.
 * No sum is over lanes, so that results are the same for any width. */
#include "plugins/common/local/short_lanes.h"
#include "plugins/kit/springs/edge.h"

#include <string.h>

enum { LANES = HK_SHORT_LANES, PARTICLES = HK_SHORT_PARTICLES, SPRINGS = HK_SHORT_SPRINGS, GRAIN = 8 };

typedef struct task {
  const hk_short_lanes *s;
  const double *x;
  double *a, *v;
  double h;
  int lanes;
} task;

/* Of one batch: displacements from x and their last changes, accelerations without stiff springs, forces of these, and
 * the springs' vectors at x. */
typedef struct work {
  hk_short_row d[PARTICLES][3], change[PARTICLES][3], a[PARTICLES][3], F[PARTICLES][3], span[SPRINGS][3];
} __attribute__((aligned(64))) work;

HK_INLINE void gather(const hk_short_batch *b, const task *t, work *m) {
  hk_short_row x[PARTICLES][3];
  for (size_t i = 0; i < b->shape.n; i++)
    for (size_t c = 0; c < 3; c++)
      for (size_t r = 0; r < LANES; r++) {
        size_t at = 3 * (size_t)b->index[i][r] + c;
        x[i][c][r] = t->x[at];
        m->a[i][c][r] = t->a[at];
        m->d[i][c][r] = m->change[i][c][r] = m->F[i][c][r] = 0;
      }
  for (size_t e = 0; e < b->shape.springs; e++)
    for (size_t c = 0; c < 3; c++)
      for (size_t r = 0; r < LANES; r++) m->span[e][c][r] = x[b->shape.pair[e][1]][c][r] - x[b->shape.pair[e][0]][c][r];
}

/* f = k (1 - L/l) along the spring; what is below HK_SPRING_TINY is lost in any other squared length, and without
 * length there is no force. Rows of x, y and z follow each other. */
HK_INLINE void add_row(const double *restrict k, const double *restrict tension, const double *restrict span,
                       const double *restrict di, const double *restrict dj, double *restrict Fi, double *restrict Fj) {
  enum { Y = LANES, Z = 2 * LANES };
  for (size_t r = 0; r < LANES; r++) {
    double dx = span[r] + (dj[r] - di[r]), dy = span[Y + r] + (dj[Y + r] - di[Y + r]),
           dz = span[Z + r] + (dj[Z + r] - di[Z + r]);
    double f = k[r] - tension[r] / sqrt(dx * dx + dy * dy + dz * dz + HK_SPRING_TINY);
    Fi[r] += f * dx;
    Fi[Y + r] += f * dy;
    Fi[Z + r] += f * dz;
    Fj[r] -= f * dx;
    Fj[Y + r] -= f * dy;
    Fj[Z + r] -= f * dz;
  }
}

HK_INLINE void add_spring(const hk_short_batch *b, size_t e, work *m) {
  const size_t i = b->shape.pair[e][0], j = b->shape.pair[e][1];
  add_row(b->k[e], b->tension[e], m->span[e][0], m->d[i][0], m->d[j][0], m->F[i][0], m->F[j][0]);
}

HK_INLINE void add_forces(const hk_short_batch *b, work *m) {
  for (size_t e = 0; e < b->shape.springs; e++) add_spring(b, e, m);
}

/* a -= w F(x). */
HK_INLINE void take_out(const hk_short_batch *b, work *m) {
  for (size_t i = 0; i < b->shape.n; i++)
    for (size_t c = 0; c < 3; c++)
      for (size_t r = 0; r < LANES; r++) m->a[i][c][r] -= b->w[i][r] * m->F[i][c][r];
}

HK_INLINE void advance(const hk_short_batch *b, work *m, double f, double g) {
  for (size_t i = 0; i < b->shape.n; i++)
    for (size_t c = 0; c < 3; c++)
      for (size_t r = 0; r < LANES; r++) {
        double change = f * m->change[i][c][r] + g * (m->a[i][c][r] + b->w[i][r] * m->F[i][c][r]);
        m->change[i][c][r] = change;
        m->d[i][c][r] += change;
        m->F[i][c][r] = 0;
      }
}

HK_INLINE void scatter(const hk_short_batch *b, const task *t, const work *m) {
  double by = 2 / (t->h * t->h), kick = t->h / 2;
  for (size_t i = 0; i < b->shape.n; i++)
    for (size_t r = 0; r < b->filled; r++)
      for (size_t c = 0; c < 3; c++) {
        size_t at = 3 * (size_t)b->index[i][r] + c;
        double a = by * m->d[i][c][r];
        if (t->v) t->v[at] += kick * (a - t->a[at]);
        t->a[at] = a;
      }
}

HK_INLINE void take_batch(const hk_short_batch *b, const task *t) {
  work m;
  gather(b, t, &m);
  add_forces(b, &m);
  take_out(b, &m);
  hk_local_step step = hk_local_first(&b->rule);
  for (int k = 0; k < b->rule.count; k++) {
    if (k > 0) add_forces(b, &m);
    advance(b, &m, step.f, step.g);
    hk_local_next(&b->rule, &step);
  }
  scatter(b, t, &m);
}

HK_VERSIONS(static void, take_one, (const hk_short_batch *b, const task *t), take_batch(b, t))

static void take_some(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  void (*take)(const hk_short_batch *, const task *) = HK_WIDEST(t->lanes, take_one);
  (void)chunk;
  for (size_t k = begin; k < end; k++) take(&t->s->batch[k], t);
}

void hk_short_lanes_take(hk_short_lanes *s, const hk_host *host, const double *x, double h, double *a, double *v) {
  for (size_t k = 0; k < s->batches && s->h != h; k++)
    s->batch[k].rule = hk_local_rule_of(s->batch[k].stiffest, s->shift, h);
  s->h = h;
  if (s->batches) host->parallel_for(host, s->batches, GRAIN, take_some, &(task){s, x, a, v, h, host->lanes});
}
