/* Blocks of hinges are gathered, computed in loops that compilers turn into vectors (hinge_lane.h), and scattered one
 * after the other, part by part (part_sums.h). Every width of vectors does the same operations, so their
 * results are bitwise equal. */
#include "plugins/common/shells/hinge_kernel.h"
#include "plugins/common/shells/hinge_lane.h"

enum { BLOCK = 64 };

typedef struct block {
  double d[3][3][BLOCK], u[3][3][BLOCK]; /* e, p, q, m, and their rates, m/s */
  double k[BLOCK], c[BLOCK], rest[BLOCK], turned[BLOCK];
  double f[3][3][BLOCK]; /* N, on b, c, d */
  double power[BLOCK];   /* W, taken by damping */
} block;

HK_HINGE_INLINE void compute(block *o, bool damped) {
  for (int r = 0; r < BLOCK; r++) {
    const double e[3] = {o->d[0][0][r], o->d[0][1][r], o->d[0][2][r]};
    const double p[3] = {o->d[1][0][r], o->d[1][1][r], o->d[1][2][r]};
    const double q[3] = {o->d[2][0][r], o->d[2][1][r], o->d[2][2][r]};
    hk_hinge_lane h = hk_hinge_measure(e, p, q);
    double angle = hk_hinge_unwrap(hk_hinge_lane_angle(&h, q), o->turned[r]);
    double z = o->k[r] * (angle - o->rest[r]), on = h.fine ? -h.length : 0, x = on / h.mm, y = on / h.nn;
    if (damped) {
      double rate = 0;
      for (int c = 0; c < 3; c++) {
        double gc = x * h.m[c], gd = y * h.n[c], gb = -h.s * gc - h.t * gd;
        rate += gb * o->u[0][c][r] + gc * o->u[1][c][r] + gd * o->u[2][c][r];
      }
      z += o->c[r] * rate;
      o->power[r] = o->c[r] * rate * rate;
    }
    x *= -z, y *= -z;
    for (int c = 0; c < 3; c++) {
      double fc = x * h.m[c], fd = y * h.n[c];
      o->f[0][c][r] = -h.s * fc - h.t * fd, o->f[1][c][r] = fc, o->f[2][c][r] = fd;
    }
  }
}

HK_VERSIONS(static void, compute_many, (block * o, bool damped), damped ? compute(o, true) : compute(o, false))

typedef struct task {
  const hk_bending *b;
  const double *rest, *turned;
} task;

/* The differences from a, of one array; lanes beyond get those of the first. */
static void gather(const hk_tuples *node, const double *from, const uint32_t *item, size_t count,
                   double into[3][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *member = hk_tuple(node, item[r < count ? r : 0]);
    const double *a = from + 3 * (size_t)member[0];
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) into[m][c][r] = from[3 * (size_t)member[m + 1] + (size_t)c] - a[c];
  }
}

/* Returns whether a hinge is damped. */
static bool take(const task *t, const uint32_t *item, size_t count, block *o) {
  const hk_elements *a = &t->b->element.acting;
  bool damped = false;
  for (size_t r = 0; r < BLOCK; r++) {
    size_t k = item[r < count ? r : 0], q = t->b->number[k];
    o->k[r] = a->stiffness.value[k], o->c[r] = a->damping.value[k];
    o->rest[r] = t->rest[q], o->turned[r] = t->turned[q];
    damped = damped || o->c[r] != 0;
  }
  return damped;
}

static void scatter(const hk_tuples *node, const block *o, const uint32_t *item, size_t count, double *F) {
  for (size_t r = 0; r < count; r++) {
    const uint32_t *member = hk_tuple(node, item[r]);
    for (size_t c = 0; c < 3; c++) {
      F[3 * (size_t)member[0] + c] -= o->f[0][c][r] + o->f[1][c][r] + o->f[2][c][r];
      for (size_t m = 0; m < 3; m++) F[3 * (size_t)member[m + 1] + c] += o->f[m][c][r];
    }
  }
}

static double one_block(const task *t, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  const hk_tuples *node = &t->b->element.acting.node;
  block o;
  double power = 0;
  bool damped = take(t, item, count, &o);
  gather(node, view->x, item, count, o.d);
  if (damped) gather(node, view->v, item, count, o.u);
  HK_WIDEST(view->host->lanes, compute_many)(&o, damped);
  scatter(node, &o, item, count, F);
  for (size_t r = 0; r < count && damped; r++) power -= o.power[r];
  return power;
}

static double add_items(const void *context, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  double power = 0;
  for (size_t k = 0; k < count; k += BLOCK)
    power += one_block(context, view, item + k, count - k < BLOCK ? count - k : BLOCK, F);
  return power;
}

void hk_hinge_forces(const hk_bending *b, const double *rest, const double *turned, const hk_view *view, size_t part,
                     double *F) {
  const task t = {b, rest, turned};
  hk_part_sums_add(&b->sums, view, part, add_items, &t, F);
}
