/* The forces of the springs of a layout (spring_layout.h), many at a time.
 *
 * A force with a law of its own defines HK_SPRING_TENSION(k, L, l) before it includes this header: the tension, N, of a
 * spring of length l, for numbers and for vectors of numbers, by +, -, * and / alone, as k (l - L) for Hooke's law or
 *     #define HK_SPRING_TENSION(k, L, l) ((k) * ((l) - (L)) * (1 + ((l) - (L)) * ((l) - (L)) * 25.))
 * (l and L may be evaluated several times). Its `add`, `add_part` and `touch` call the functions below and have the
 * speed of those of `springs`; energy, bounds and Jacobians of spring_blocks.h are Hooke's. */
#ifndef HK_SPRING_KERNEL_H
#define HK_SPRING_KERNEL_H

#include "core/plugin/vector_math.h"
#include "plugins/kit/springs/spring_layout.h"
#include "plugins/kit/springs/edge.h"

#ifndef HK_SPRING_TENSION
#define HK_SPRING_TENSION(k, L, l) ((k) * ((l) - (L)))
#endif

/* F += the forces; *power += the power of the damping, -sum c (u.d)^2/l^2, when `power` is not NULL. */
static inline void hk_spring_forces(const hk_spring_layout *, const hk_host *host, const double *x, const double *v,
                                    double *F, double *power);
/* The same of one part. */
static inline void hk_spring_part(const hk_spring_layout *, size_t part, const double *x, const double *v, double *F,
                                  double *power);

/* ---- how: loops in vectors ---- */

/* Ends HK_SPRING_FAR particles apart are far: what is added to one end has been stored when it is read as the other.
 * (Measured: from 16 on as fast as any, 12 a quarter slower.) */
enum { HK_SPRING_BLOCK = 256, HK_SPRING_FAR = 16 };

/* Nearer ends get their forces from a buffer, HK_SPRING_LAG springs later, when the processor has written them to the
 * cache, and with numbers of the buffer up to HK_SPRING_MARGIN before or behind those of their own springs. */
enum { HK_SPRING_LAG = 32, HK_SPRING_MARGIN = 3 * HK_SPRING_FAR };

/* `k + (e & each_k)` points to the coefficients of spring e and those that follow; `each` is 0 for a common coefficient
 * (HK_SPRING_WIDEST equal numbers), otherwise it has all bits set. */
typedef struct hk_spring_numbers {
  const double *k, *c, *L;
  size_t each_k, each_c, each_L;
} hk_spring_numbers;

/* Has the coefficients of springs read that are HK_SPRING_PREFETCH after spring e: the processor does not foresee by
 * itself where a path goes on in several lists, page by page. Distances of 64 to 512 springs are equally good. */
enum { HK_SPRING_PREFETCH = 128 };
static inline __attribute__((always_inline)) void hk_spring_fetch(const hk_spring_numbers *q, size_t e) {
  e += HK_SPRING_PREFETCH;
  __builtin_prefetch(q->k + (e & q->each_k));
  __builtin_prefetch(q->c + (e & q->each_c));
  __builtin_prefetch(q->L + (e & q->each_L));
}

/* Where springs are read and forces go. Of a run: the first particle of each end; of a list, with xi, vi and Fi alone:
 * the first particle of all. `present` has a bit for each spring of a run, the lowest of a byte first: where it is 0
 * there is none, and F gets zeros, unless the particles' distance overflows. */
typedef struct hk_spring_ways {
  hk_spring_numbers q;
  const uint8_t *present;
  const double *xi, *xj, *vi, *vj;
  double *Fi, *Fj;
} hk_spring_ways;

typedef double hk_spring_half __attribute__((vector_size(16), aligned(8), may_alias));

/* The force of a spring, to its first end, and its opposite to the second one. x and y together and z alone: a wider
 * store would overlap a neighbouring particle, whose load would wait for it. */
HK_INLINE void hk_spring_pull(double *F, const uint32_t pair[2], hk_spring_half xy, double z) {
  double *i = F + 3 * (size_t)pair[0], *j = F + 3 * (size_t)pair[1];
  *(hk_spring_half *)i += xy;
  i[2] += z;
  *(hk_spring_half *)j -= xy;
  j[2] -= z;
}

/* Whether one of n springs of a run is missing. */
static inline bool hk_spring_has_gaps(const uint8_t *present, size_t n) {
  uint64_t eight;
  size_t e = 0;
  bool gaps = n % 8 && (present[n / 8] & 15) != 15; /* n is a multiple of four */
  for (; e + 64 <= n; e += 64) gaps |= (memcpy(&eight, present + e / 8, sizeof eight), eight != UINT64_MAX);
  for (; e + 8 <= n; e += 8) gaps |= present[e / 8] != 0xff;
  return gaps;
}

/* For each width, HK_WIDEST(lanes, loop)(ways, ...): adds the forces of springs to F and returns the sum of c w^2/l^2,
 * W. All widths do the same operations in the same order, so results are bitwise equal.
 *   hk_spring_far_run(ways, n, damped)      the springs (i+t, j+t) of a run with ends HK_SPRING_FAR or more apart; n: a
 *                                           multiple of HK_SPRING_LANES. Springs e, e + 4, e + 8, ... are summed first
 *   hk_spring_near_run(ways, n, damped)     the same for ends that are nearer; n: at most HK_SPRING_BLOCK
 *   hk_spring_list_run(ways, pair, n, damped)  n pairs without the last particle: one number beyond a particle may be
 *                                           read; n as of a run. Forces are added spring after spring, to the first end
 *                                           and to the second one; W as of a run */
#define LOAD(p) (*(const VECTOR *)(p))
#define STORE(p, value) (*(VECTOR *)(p) = (value))
#define ADD(p, value) (*(VECTOR *)(p) += (value))
#define PICK __builtin_shufflevector
#define HK_LOOPS "plugins/kit/springs/spring_loops.h"
#include "core/plugin/each_width.h"
#undef LOAD
#undef STORE
#undef ADD
#undef PICK

/* ---- how: all springs ---- */

/* The springs of a layout, part by part: runs and lists by the widest vectors of this processor, the few remaining
 * springs one by one with the same operations. */

static inline double hk_spring_scale(double l2, double w, double k, double c, double L, double *p) {
  double safe = l2 > HK_SPRING_TINY ? l2 : 1, l = sqrt(safe), r = 1 / safe, cwr = c * w * r;
  *p += cwr * w;
  return HK_SPRING_TENSION(k, L, l) * l * r + cwr;
}

typedef struct hk_spring_task {
  const hk_spring_layout *layout;
  const double *x, *v;
  double *F;
} hk_spring_task;

static inline double hk_spring_singles(const hk_spring_task *t, const hk_spring_run *run) {
  const hk_spring_layout *s = t->layout;
  double sum = 0;
  for (size_t q = 0; q < run->count; q++) {
    uint32_t end[2];
    hk_spring_ends(s, run, q, end);
    size_t i = 3 * (size_t)end[0], j = 3 * (size_t)end[1], e = run->place + q;
    const double *xi = t->x + i, *xj = t->x + j, *vi = t->v + i, *vj = t->v + j;
    double *Fi = t->F + i, *Fj = t->F + j;
    double dx = xj[0] - xi[0], dy = xj[1] - xi[1], dz = xj[2] - xi[2];
    double w = s->damped ? dx * (vj[0] - vi[0]) + dy * (vj[1] - vi[1]) + dz * (vj[2] - vi[2]) : 0;
    double f = hk_spring_scale(dx * dx + dy * dy + dz * dz, w, s->k[s->each_k ? e : 0], s->c[s->each_c ? e : 0],
                               s->L[s->each_L ? e : 0], &sum);
    Fi[0] += f * dx;
    Fi[1] += f * dy;
    Fi[2] += f * dz;
    Fj[0] -= f * dx;
    Fj[1] -= f * dy;
    Fj[2] -= f * dz;
  }
  return sum;
}

static inline hk_spring_numbers hk_spring_numbers_from(const hk_spring_numbers *all, size_t e) {
  return (hk_spring_numbers){all->k + (e & all->each_k),
                             all->c + (e & all->each_c),
                             all->L + (e & all->each_L),
                             all->each_k,
                             all->each_c,
                             all->each_L};
}

/* n places of a run from its t-th on. */
static inline double hk_spring_one_block(const hk_spring_task *t, const hk_spring_numbers *all,
                                         const hk_spring_run *run, size_t from, size_t n) {
  const hk_spring_layout *s = t->layout;
  size_t i = 3 * (run->i + from), j = 3 * (run->j + from), apart = i < j ? j - i : i - j;
  const hk_spring_ways at = {hk_spring_numbers_from(all, run->place + from),
                             s->present + run->bits + from / 8,
                             t->x + i,
                             t->x + j,
                             t->v + i,
                             t->v + j,
                             t->F + i,
                             t->F + j};
  if (apart >= 3 * HK_SPRING_FAR) return HK_WIDEST(s->width, hk_spring_far_run)(&at, n, s->damped);
  return HK_WIDEST(s->width, hk_spring_near_run)(&at, n, s->damped);
}

static inline double hk_spring_one_list(const hk_spring_task *t, const hk_spring_numbers *all,
                                        const hk_spring_run *run) {
  const hk_spring_layout *s = t->layout;
  const hk_spring_ways at = {.q = hk_spring_numbers_from(all, run->place), .xi = t->x, .vi = t->v, .Fi = t->F};
  const uint32_t(*pair)[2] = (const uint32_t(*)[2])s->pair + run->pair;
  return HK_WIDEST(s->width, hk_spring_list_run)(&at, pair, run->count, s->damped);
}

static inline double hk_spring_one_run(const hk_spring_task *t, const hk_spring_numbers *q, const hk_spring_run *run) {
  double power = 0;
  if (run->kind == HK_SPRING_LIST) return hk_spring_one_list(t, q, run);
  if (run->kind == HK_SPRING_SINGLE) return hk_spring_singles(t, run);
  for (size_t e = 0; e < run->places; e += HK_SPRING_BLOCK)
    power += hk_spring_one_block(t, q, run, e, run->places - e < HK_SPRING_BLOCK ? run->places - e : HK_SPRING_BLOCK);
  return power;
}

static inline double hk_spring_one_part(const hk_spring_task *t, size_t part) {
  const hk_spring_layout *s = t->layout;
  const hk_spring_numbers q = {.k = s->k,
                               .c = s->c,
                               .L = s->L,
                               .each_k = s->each_k ? ~(size_t)0 : 0,
                               .each_c = s->each_c ? ~(size_t)0 : 0,
                               .each_L = s->each_L ? ~(size_t)0 : 0};
  double power = 0;
  for (size_t r = s->part[part]; r < s->part[part + 1]; r++) power += hk_spring_one_run(t, &q, &s->run[r]);
  return power;
}

static inline hk_spring_task hk_spring_begin(const hk_spring_layout *s, const double *x, const double *v, double *F) {
  return (hk_spring_task){s, x, v, F};
}

static inline void hk_spring_part(const hk_spring_layout *s, size_t part, const double *x, const double *v, double *F,
                                  double *power) {
  hk_spring_task t = hk_spring_begin(s, x, v, F);
  double p = hk_spring_one_part(&t, part);
  if (power) *power -= p;
}

static inline void hk_spring_sum_part(const void *context, size_t part) {
  const hk_spring_task *t = context;
  t->layout->power[part] = hk_spring_one_part(t, part);
}

static inline void hk_spring_forces(const hk_spring_layout *s, const hk_host *host, const double *x, const double *v,
                                    double *F, double *power) {
  if (s->count == 0) return;      /* also of a layout that was not built */
  if (s->partition.blocks == 1) { /* a small scene: no threads */
    hk_spring_part(s, 0, x, v, F, power);
    return;
  }
  hk_spring_task t = hk_spring_begin(s, x, v, F);
  hk_parts_each(host, &s->partition, s->part, hk_spring_sum_part, &t);
  for (size_t p = 0; power && p < s->partition.parts; p++)
    if (s->part[p] < s->part[p + 1]) *power -= s->power[p];
}

#endif
