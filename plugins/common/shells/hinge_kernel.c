/* Blocks of hinges are gathered, computed in loops that compilers turn into vectors (hinge_lane.h), and laid down as
 * loads on their members, which corner_sums.h adds up. The wide path and the narrow one do the same operations, so
 * their results are bitwise equal. */
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

static void compute_narrow(block *o, bool damped) { damped ? compute(o, true) : compute(o, false); }

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void compute_wide(block *o, bool damped) {
  damped ? compute(o, true) : compute(o, false);
}
#define COMPUTE (__builtin_cpu_supports("avx2") ? compute_wide : compute_narrow)
#else
#define COMPUTE compute_narrow
#endif

typedef struct task {
  const hk_bending *b;
  const hk_view *view;
  const double *rest, *turned;
  void (*compute)(block *, bool damped);
} task;

/* The differences from a, of one array; lanes beyond get those of the first. */
static void gather(const hk_tuples *node, const double *from, size_t begin, size_t count, double into[3][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *member = hk_tuple(node, begin + (r < count ? r : 0));
    const double *a = from + 3 * (size_t)member[0];
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) into[m][c][r] = from[3 * (size_t)member[m + 1] + (size_t)c] - a[c];
  }
}

static double one_block(const task *t, size_t begin, size_t count) {
  const hk_elements *a = &t->b->element.acting;
  block o;
  double power = 0;
  bool damped = false;
  for (size_t r = 0; r < BLOCK; r++) {
    size_t k = begin + (r < count ? r : 0), q = t->b->number[k];
    o.k[r] = a->stiffness.value[k], o.c[r] = a->damping.value[k];
    o.rest[r] = t->rest[q], o.turned[r] = t->turned[q];
    damped = damped || o.c[r] != 0;
  }
  gather(&a->node, t->view->x, begin, count, o.d);
  if (damped) gather(&a->node, t->view->v, begin, count, o.u);
  t->compute(&o, damped);
  for (size_t r = 0; r < count; r++) {
    double(*into)[3] = t->b->load[begin + r];
    for (int c = 0; c < 3; c++) {
      into[0][c] = -(o.f[0][c][r] + o.f[1][c][r] + o.f[2][c][r]);
      for (int m = 0; m < 3; m++) into[m + 1][c] = o.f[m][c][r];
    }
  }
  for (size_t r = 0; r < count && damped; r++) power -= o.power[r];
  return power;
}

static void load_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  double power = 0;
  for (size_t k = begin; k < end; k += BLOCK) power += one_block(t, k, end - k < BLOCK ? end - k : BLOCK);
  t->b->power[chunk] = power;
}

static void sum_forces(const task *t, double *F) {
  const hk_host *host = t->view->host;
  size_t count = t->b->element.acting.node.count;
  host->parallel_for(host, count, HK_BENDING_GRAIN, load_chunk, (void *)(uintptr_t)t);
  hk_corner_sums_add(&t->b->sums, host, t->view->n, (const double(*)[3])t->b->load, F);
  for (size_t chunk = 0; chunk * HK_BENDING_GRAIN < count && t->view->power; chunk++)
    *t->view->power += t->b->power[chunk];
}

void hk_hinge_forces(const hk_bending *b, const double *rest, const double *turned, const hk_view *view, double *F) {
  const task t = {b, view, rest, turned, COMPUTE};
  sum_forces(&t, F);
}

void hk_hinge_forces_narrow(const hk_bending *b, const double *rest, const double *turned, const hk_view *view,
                            double *F) {
  const task t = {b, view, rest, turned, compute_narrow};
  sum_forces(&t, F);
}
