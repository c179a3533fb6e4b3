/* Jacobian blocks of damped springs, by the layout of spring_kernel.h. With n = d/l the force on j is
 * f = -(k (l - L) + c u.n) n, so for x = x_j - x_i
 *     -df/dx = (k - b) n n^T + b I + (c/l) n (u - (u.n) n)^T,   b = k (1 - L/l) + (c/l) u.n,   -df/dv = c n n^T.
 * The last term of df/dx, due to the rotation of the damping's direction, is the only unsymmetric term:
 * HK_WANT_SYMMETRIC omits it. The other terms have the eigenvalues k, b, b; HK_WANT_DEFINITE replaces a negative b by
 * 0. In a method that linearises once a step the tension k (l - L) in b is the one that its last linearisation foretold
 * (hk_blocks): the multiplier in place of k C, as in Tournier and others 2015, Stable constrained dynamics, ACM TOG 34.
 * At l = 0 there is no direction: the block is k I when L = 0, otherwise 0. */
#ifndef HK_SPRING_BLOCKS_H
#define HK_SPRING_BLOCKS_H

#include "plugins/kit/springs/spring_kernel.h"
#include "plugins/kit/springs/edge.h"
#include "plugins/kit/springs/edge_stiffness.h"

/* Names four blocks per spring, (i,i), (i,j), (j,i), (j,j), in the layout's order. */
static inline void hk_spring_pattern(const hk_spring_layout *, hk_pattern *pattern);
/* Adds the blocks. Parts run in parallel where they share no particle and thus no block. */
static inline void hk_spring_blocks(const hk_spring_layout *, const hk_host *host, const double *x, const double *v,
                                    const hk_blocks *into);

/* J, 1/2 k (l - L)^2, summed in the layout's order, like the bound: neighbours are near in memory. */
static inline double hk_spring_energy(const hk_spring_layout *, const double *x);
/* As hk_force.stiffness_bound, see edge_stiffness.c. */
static inline void hk_spring_stiffness_bound(const hk_spring_layout *, const hk_view *, hk_stiffness_part,
                                             double (*block)[6]);

/* ---- how ---- */

/* See spring_blocks.h. Each spring takes one square root and adds nine numbers to four blocks; springs are added to a
 * block in the order of the layout, for any number of threads. */

static inline void hk_spring_pattern(const hk_spring_layout *s, hk_pattern *p) {
  for (size_t r = 0; r < s->runs; r++)
    for (size_t t = 0; t < s->run[r].places; t++) {
      uint32_t end[2];
      if (!hk_spring_ends(s, &s->run[r], t, end)) continue;
      for (int b = 0; b < 4; b++) p->block(p, end[b / 2], end[b % 2]);
    }
}

typedef struct hk_spring_blocks_task {
  const hk_spring_layout *s;
  const double *x, *v;
  const hk_blocks *into;
} hk_spring_blocks_task;

/* The numbers of one block at a time, two by two: two of the blocks may be one. */
static inline void hk_spring_add_block(double *to, const hk_spring_half pair[4], double last) {
  for (int q = 0; q < 4; q++) *(hk_spring_half *)(to + 2 * q) += pair[q];
  to[8] += last;
}

static inline void hk_spring_subtract_block(double *to, const hk_spring_half pair[4], double last) {
  for (int q = 0; q < 4; q++) *(hk_spring_half *)(to + 2 * q) -= pair[q];
  to[8] -= last;
}

static inline void hk_spring_add_four(double *into, const size_t slot[4], const double block[9]) {
  const hk_spring_half pair[4] = {
      {block[0], block[1]}, {block[2], block[3]}, {block[4], block[5]}, {block[6], block[7]}};
  hk_spring_add_block(into + 9 * slot[0], pair, block[8]);
  hk_spring_subtract_block(into + 9 * slot[1], pair, block[8]);
  hk_spring_subtract_block(into + 9 * slot[2], pair, block[8]);
  hk_spring_add_block(into + 9 * slot[3], pair, block[8]);
}

static inline void hk_spring_add_zero_length(const hk_spring_blocks_task *t, size_t e, double k, double L) {
  double block[9] = {k, 0, 0, 0, k, 0, 0, 0, k};
  if (L == 0) hk_spring_add_four(t->into->K, t->into->slot + 4 * e, block);
}

/* k times the elongation that the last linearisation predicted. */
static inline double hk_spring_predicted(const hk_blocks *into, size_t i, size_t j, double k, double L) {
  double ll = 0, along = 0;
  for (int a = 0; a < 3; a++) {
    double d = into->linearised[j + a] - into->linearised[i + a];
    ll += d * d;
    along += d * (into->reached[j + a] - into->reached[i + a]);
  }
  return ll > 0 ? k * (along / sqrt(ll) - L) : 0;
}

/* Spring e of the layout; `place`: of its coefficients. */
static inline void hk_spring_add_blocks(const hk_spring_blocks_task *t, size_t e, size_t place, const uint32_t end[2]) {
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
    hk_spring_add_zero_length(t, e, k, L);
    return;
  }
  double r = 1 / sqrt(ll);
  for (int a = 0; a < 3; a++) un += u[a] * (n[a] *= r);
  double b = (t->into->linearised ? hk_spring_predicted(t->into, i, j, k, L) * r : k * (1 - L * r)) + c * r * un;
  if (b < 0 && t->into->want & HK_WANT_DEFINITE) b = 0;
  bool turning = !(t->into->want & HK_WANT_SYMMETRIC) && c != 0;
  for (int q = 0; q < 9; q++) {
    double nn = n[q / 3] * n[q % 3];
    K[q] = (k - b) * nn + (q % 4 == 0 ? b : 0);
    if (turning) K[q] += c * r * (n[q / 3] * u[q % 3] - un * nn);
    D[q] = c * nn;
  }
  hk_spring_add_four(t->into->K, t->into->slot + 4 * e, K);
  if (c != 0) hk_spring_add_four(t->into->D, t->into->slot + 4 * e, D);
}

static inline void hk_spring_blocks_part(const void *context, size_t part) {
  const hk_spring_blocks_task *t = context;
  for (size_t r = t->s->part[part]; r < t->s->part[part + 1]; r++) {
    const hk_spring_run *run = &t->s->run[r];
    size_t e = run->begin;
    for (size_t q = 0; q < run->places; q++) {
      uint32_t end[2];
      if (hk_spring_ends(t->s, run, q, end)) hk_spring_add_blocks(t, e++, run->place + q, end);
    }
  }
}

static inline void hk_spring_blocks(const hk_spring_layout *s, const hk_host *host, const double *x, const double *v,
                                    const hk_blocks *into) {
  hk_spring_blocks_task t = {s, x, v, into};
  hk_parts_each(host, &s->partition, s->part, hk_spring_blocks_part, &t);
}

/* ---- the energy and the bound ---- */

/* Calls use(context, ends, numbers) for every spring, in the order of the layout. */
static inline void hk_spring_each(const hk_spring_layout *s, void *context,
                                  void (*use)(void *context, const uint32_t end[2], hk_edge_numbers q)) {
  for (size_t r = 0; r < s->runs; r++)
    for (size_t t = 0; t < s->run[r].places; t++) {
      uint32_t end[2];
      size_t p = s->run[r].place + t;
      if (hk_spring_ends(s, &s->run[r], t, end))
        use(context, end, (hk_edge_numbers){s->k[s->each_k ? p : 0], s->c[s->each_c ? p : 0], s->L[s->each_L ? p : 0]});
    }
}

typedef struct hk_spring_energy_sum {
  const double *x;
  double energy;
} hk_spring_energy_sum;

static inline void hk_spring_add_energy(void *context, const uint32_t end[2], hk_edge_numbers q) {
  hk_spring_energy_sum *of = context;
  double d[3], stretch = hk_edge_difference(of->x, end, d) - q.rest;
  of->energy += q.k * stretch * stretch / 2;
}

static inline double hk_spring_energy(const hk_spring_layout *s, const double *x) {
  hk_spring_energy_sum of = {x, 0};
  hk_spring_each(s, &of, hk_spring_add_energy);
  return of.energy;
}

typedef struct hk_spring_bound {
  const hk_view *view;
  hk_stiffness_part part;
  double (*block)[6];
} hk_spring_bound;

static inline void hk_spring_add_bound(void *context, const uint32_t end[2], hk_edge_numbers q) {
  const hk_spring_bound *of = context;
  hk_edge_stiffness_one(of->view, end, q, false, of->part, of->block);
}

static inline void hk_spring_stiffness_bound(const hk_spring_layout *s, const hk_view *view, hk_stiffness_part part,
                                             double (*block)[6]) {
  hk_spring_bound of = {view, part, block};
  hk_spring_each(s, &of, hk_spring_add_bound);
}

#endif
