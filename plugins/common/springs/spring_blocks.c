/* See spring_blocks.h. Each spring takes one square root and adds nine numbers to four blocks; springs are added to a
 * block in the order of the layout, for any number of threads. */
#include "plugins/common/springs/spring_blocks.h"
#include "plugins/common/springs/edge.h"
#include "plugins/common/springs/edge_stiffness.h"

void hk_spring_pattern(const hk_spring_layout *s, hk_pattern *p) {
  for (size_t r = 0; r < s->runs; r++)
    for (size_t t = 0; t < s->run[r].places; t++) {
      uint32_t end[2];
      if (!hk_spring_ends(s, &s->run[r], t, end)) continue;
      for (int b = 0; b < 4; b++) p->block(p, end[b / 2], end[b % 2]);
    }
}

typedef struct task {
  const hk_spring_layout *s;
  const double *x, *v;
  const hk_blocks *into;
} task;

/* The numbers of one block at a time, so that they are added as vectors: two of the blocks may be one. */
static void add(double *into, const size_t slot[4], const double block[restrict 9]) {
  for (int b = 0; b < 4; b++) {
    double *restrict to = into + 9 * slot[b], sign = b == 0 || b == 3 ? 1 : -1;
    for (int q = 0; q < 9; q++) to[q] += sign * block[q];
  }
}

static void add_zero_length(const task *t, size_t e, double k, double L) {
  double block[9] = {k, 0, 0, 0, k, 0, 0, 0, k};
  if (L == 0) add(t->into->K, t->into->slot + 4 * e, block);
}

/* k times the elongation that the last linearisation foretold. */
static double foretold(const hk_blocks *into, size_t i, size_t j, double k, double L) {
  double ll = 0, along = 0;
  for (int a = 0; a < 3; a++) {
    double d = into->linearised[j + a] - into->linearised[i + a];
    ll += d * d;
    along += d * (into->reached[j + a] - into->reached[i + a]);
  }
  return ll > 0 ? k * (along / sqrt(ll) - L) : 0;
}

/* Spring e of the layout; `place`: of its coefficients. */
static void spring(const task *t, size_t e, size_t place, const uint32_t end[2]) {
  const hk_spring_layout *s = t->s;
  size_t i = 3 * (size_t)end[0], j = 3 * (size_t)end[1];
  double k = s->k[s->each_k ? place : 0], c = s->c[s->each_c ? place : 0], L = s->L[s->each_L ? place : 0];
  double n[3], u[3], K[9], D[9], ll = 0, un = 0;
  for (int a = 0; a < 3; a++) {
    n[a] = t->x[j + a] - t->x[i + a];
    u[a] = t->v[j + a] - t->v[i + a];
    ll += n[a] * n[a];
  }
  if (!(ll > 0)) {
    add_zero_length(t, e, k, L);
    return;
  }
  double r = 1 / sqrt(ll);
  for (int a = 0; a < 3; a++) un += u[a] * (n[a] *= r);
  double b = (t->into->linearised ? foretold(t->into, i, j, k, L) * r : k * (1 - L * r)) + c * r * un;
  if (b < 0 && t->into->want & HK_WANT_DEFINITE) b = 0;
  bool turning = !(t->into->want & HK_WANT_SYMMETRIC) && c != 0;
  for (int q = 0; q < 9; q++) {
    double nn = n[q / 3] * n[q % 3];
    K[q] = (k - b) * nn + (q % 4 == 0 ? b : 0);
    if (turning) K[q] += c * r * (n[q / 3] * u[q % 3] - un * nn);
    D[q] = c * nn;
  }
  add(t->into->K, t->into->slot + 4 * e, K);
  if (c != 0) add(t->into->D, t->into->slot + 4 * e, D);
}

static void add_part(const void *context, size_t part) {
  const task *t = context;
  for (size_t r = t->s->part[part]; r < t->s->part[part + 1]; r++) {
    const hk_spring_run *run = &t->s->run[r];
    size_t e = run->begin;
    for (size_t q = 0; q < run->places; q++) {
      uint32_t end[2];
      if (hk_spring_ends(t->s, run, q, end)) spring(t, e++, run->place + q, end);
    }
  }
}

void hk_spring_blocks(const hk_spring_layout *s, const hk_host *host, const double *x, const double *v,
                      const hk_blocks *into) {
  task t = {s, x, v, into};
  hk_parts_each(host, &s->partition, s->part, add_part, &t);
}

/* ---- the energy and the bound ---- */

/* Calls use(context, ends, numbers) for every spring, in the order of the layout. */
static void each_spring(const hk_spring_layout *s, void *context,
                        void (*use)(void *context, const uint32_t end[2], hk_edge_numbers q)) {
  for (size_t r = 0; r < s->runs; r++)
    for (size_t t = 0; t < s->run[r].places; t++) {
      uint32_t end[2];
      size_t p = s->run[r].place + t;
      if (hk_spring_ends(s, &s->run[r], t, end))
        use(context, end, (hk_edge_numbers){s->k[s->each_k ? p : 0], s->c[s->each_c ? p : 0], s->L[s->each_L ? p : 0]});
    }
}

typedef struct sum {
  const double *x;
  double energy;
} sum;

static void add_energy(void *context, const uint32_t end[2], hk_edge_numbers q) {
  sum *of = context;
  double d[3], stretch = hk_edge_difference(of->x, end, d) - q.rest;
  of->energy += q.k * stretch * stretch / 2;
}

double hk_spring_energy(const hk_spring_layout *s, const double *x) {
  sum of = {x, 0};
  each_spring(s, &of, add_energy);
  return of.energy;
}

typedef struct bound {
  const hk_view *view;
  hk_stiffness_part part;
  double (*block)[6];
} bound;

static void add_bound(void *context, const uint32_t end[2], hk_edge_numbers q) {
  const bound *of = context;
  hk_edge_stiffness_one(of->view, end, q, false, of->part, of->block);
}

void hk_spring_stiffness_bound(const hk_spring_layout *s, const hk_view *view, hk_stiffness_part part,
                               double (*block)[6]) {
  bound of = {view, part, block};
  each_spring(s, &of, add_bound);
}
