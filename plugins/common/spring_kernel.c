/* Springs go through in blocks that stay in the first-level cache, in three passes: differences and dot products; the
 * scales, with square root and division at the processor's full width; forces added to both ends. Each pass is compiled
 * for several instruction sets and chosen at load time. All do the same operations in the same order, so a spring's
 * force is the same number in every path and on every processor. */
#include "plugins/common/spring_kernel.h"

#include <string.h>

#if defined(__x86_64__) && defined(__gnu_linux__)
#define VERSIONS __attribute__((target_clones("avx2", "default")))
#else
#define VERSIONS
#endif

enum { BLOCK = 256, LANES = 4 };

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef double half __attribute__((vector_size(16), aligned(8), may_alias));

/* Macros, because vectors must not be passed between functions compiled for different instruction sets. */
#define LOAD(p) (*(const vector *)(p))
#define STORE(p, value) (*(vector *)(p) = (value))
#define PICK __builtin_shufflevector

typedef struct block {
  double d[4 * BLOCK]; /* runs: interleaved as x is; lists: four numbers a spring, the last of no meaning */
  double l2[BLOCK];    /* d.d */
  double w[BLOCK];     /* u.d */
  double s[BLOCK];
} block __attribute__((aligned(64)));

/* Sums of three neighbours: (a0+a1+a2, a3+b0+b1, b2+b3+c0, c1+c2+c3), each as (x + y) + z. */
#define SUM3(into, a, b, c)                                                                                            \
  do {                                                                                                                 \
    vector x_ = PICK(PICK(PICK(a, b, 0, 1, 6, 3), c, 0, 5, 2, 3), c, 0, 3, 2, 1);                                      \
    vector y_ = PICK(PICK(PICK(b, a, 0, 5, 2, 3), c, 0, 1, 6, 3), c, 1, 0, 3, 2);                                      \
    vector z_ = PICK(PICK(PICK(c, b, 0, 5, 2, 3), a, 0, 1, 6, 3), a, 2, 1, 0, 3);                                      \
    STORE(into, x_ + y_ + z_);                                                                                         \
  } while (0)

VERSIONS static void run_differences(block *restrict b, size_t n, const double *restrict xi, const double *restrict xj,
                                     const double *restrict vi, const double *restrict vj, bool damped) {
  for (size_t e = 0; e < n; e += 4) {
    size_t q = 3 * e;
    vector d0 = LOAD(xj + q) - LOAD(xi + q), d1 = LOAD(xj + q + 4) - LOAD(xi + q + 4),
           d2 = LOAD(xj + q + 8) - LOAD(xi + q + 8);
    STORE(b->d + q, d0);
    STORE(b->d + q + 4, d1);
    STORE(b->d + q + 8, d2);
    vector q0 = d0 * d0, q1 = d1 * d1, q2 = d2 * d2;
    SUM3(b->l2 + e, q0, q1, q2);
    if (!damped) continue;
    q0 = d0 * (LOAD(vj + q) - LOAD(vi + q));
    q1 = d1 * (LOAD(vj + q + 4) - LOAD(vi + q + 4));
    q2 = d2 * (LOAD(vj + q + 8) - LOAD(vi + q + 8));
    SUM3(b->w + e, q0, q1, q2);
  }
}

VERSIONS static void run_forces(block *restrict b, size_t n, double *restrict Fi, double *restrict Fj) {
  for (size_t e = 0; e < n; e += 4) {
    size_t q = 3 * e;
    vector s = LOAD(b->s + e);
    vector f0 = LOAD(b->d + q) * PICK(s, s, 0, 0, 0, 1), f1 = LOAD(b->d + q + 4) * PICK(s, s, 1, 1, 2, 2),
           f2 = LOAD(b->d + q + 8) * PICK(s, s, 2, 3, 3, 3);
    STORE(b->d + q, f0);
    STORE(b->d + q + 4, f1);
    STORE(b->d + q + 8, f2);
    STORE(Fi + q, LOAD(Fi + q) + f0);
    STORE(Fi + q + 4, LOAD(Fi + q + 4) + f1);
    STORE(Fi + q + 8, LOAD(Fi + q + 8) + f2);
  }
  /* The two ends' ranges may overlap: only now, when the stores above are long done. */
  for (size_t q = 0; q < 3 * n; q++) Fj[q] -= b->d[q];
}

/* Rows of three numbers (and one that is not looked at) to columns. */
#define COLUMNS(r, X, Y, Z)                                                                                            \
  vector X, Y, Z;                                                                                                      \
  do {                                                                                                                 \
    vector a_ = PICK(r[0], r[1], 0, 4, 2, 6), b_ = PICK(r[2], r[3], 0, 4, 2, 6);                                       \
    vector c_ = PICK(r[0], r[1], 1, 5, 3, 7), d_ = PICK(r[2], r[3], 1, 5, 3, 7);                                       \
    X = PICK(a_, b_, 0, 1, 4, 5);                                                                                      \
    Z = PICK(a_, b_, 2, 3, 6, 7);                                                                                      \
    Y = PICK(c_, d_, 0, 1, 4, 5);                                                                                      \
  } while (0)

VERSIONS static void list_differences(block *restrict b, size_t n, const uint32_t (*restrict pair)[2],
                                      const double *restrict x, const double *restrict v, bool damped) {
  for (size_t e = 0; e < n; e += 4) {
    vector d[4], u[4];
    for (size_t r = 0; r < 4; r++) d[r] = LOAD(x + 3 * (size_t)pair[e + r][1]) - LOAD(x + 3 * (size_t)pair[e + r][0]);
    COLUMNS(d, dx, dy, dz);
    for (size_t r = 0; r < 4; r++) STORE(b->d + 4 * (e + r), d[r]);
    STORE(b->l2 + e, dx * dx + dy * dy + dz * dz);
    if (!damped) continue;
    for (size_t r = 0; r < 4; r++) u[r] = LOAD(v + 3 * (size_t)pair[e + r][1]) - LOAD(v + 3 * (size_t)pair[e + r][0]);
    COLUMNS(u, ux, uy, uz);
    STORE(b->w + e, dx * ux + dy * uy + dz * uz);
  }
}

/* x and y together, z alone, at both ends and always so: a wider store would hold up the next load of a neighbouring
 * particle, which it overlaps. */
static void list_forces(const block *restrict b, size_t n, const uint32_t (*restrict pair)[2], double *restrict F) {
  for (size_t e = 0; e < n; e++) {
    double *Fi = F + 3 * (size_t)pair[e][0], *Fj = F + 3 * (size_t)pair[e][1], fz = b->s[e] * b->d[4 * e + 2];
    half fxy = b->s[e] * *(const half *)(b->d + 4 * e);
    *(half *)Fi += fxy;
    Fi[2] += fz;
    *(half *)Fj -= fxy;
    Fj[2] -= fz;
  }
}

/* One spring; the passes below do the same operations. */
static inline double scale(double l2, double w, double k, double c, double L, double *p) {
  double safe = l2 > 0 ? l2 : 1, l = sqrt(safe), r = 1 / safe, cwr = c * w * r;
  *p = cwr * w;
  return k * (l - L) * l * r + cwr;
}

/* The scales of n springs, a multiple of four; returns the sum of c w^2 / l^2 in four interleaved parts, which are
 * added last: vectorisable, and the same order everywhere. */
VERSIONS static double scales_common(block *restrict b, size_t n, double k, double c, const double *restrict L) {
  double part[LANES] = {0}, p[LANES];
  for (size_t e = 0; e < n; e += LANES)
    for (size_t q = 0; q < LANES; q++) {
      b->s[e + q] = scale(b->l2[e + q], b->w[e + q], k, c, L[e + q], &p[q]);
      part[q] += p[q];
    }
  return (part[0] + part[1]) + (part[2] + part[3]);
}

VERSIONS static double scales_each(block *restrict b, size_t n, const double *restrict k, const double *restrict c,
                                   const double *restrict L) {
  double part[LANES] = {0}, p[LANES];
  for (size_t e = 0; e < n; e += LANES)
    for (size_t q = 0; q < LANES; q++) {
      b->s[e + q] = scale(b->l2[e + q], b->w[e + q], k[e + q], c[e + q], L[e + q], &p[q]);
      part[q] += p[q];
    }
  return (part[0] + part[1]) + (part[2] + part[3]);
}

static const double *spread(double *room, const double *list, bool each, size_t first, size_t n) {
  if (each) return list + first;
  for (size_t e = 0; e < n; e++) room[e] = *list;
  return room;
}

static double scales(block *b, size_t n, const hk_spring_layout *s, size_t first) {
  double k[BLOCK], c[BLOCK], L[BLOCK];
  if (!s->damped) memset(b->w, 0, n * sizeof *b->w);
  const double *rest = spread(L, s->L, s->each_L, first, n);
  if (!s->each_k && !s->each_c) return scales_common(b, n, *s->k, *s->c, rest);
  return scales_each(b, n, spread(k, s->k, s->each_k, first, n), spread(c, s->c, s->each_c, first, n), rest);
}

typedef struct task {
  const hk_spring_layout *layout;
  const double *x, *v;
  double *F;
  size_t first_group;
  bool wants_power;
} task;

static double single(const task *t, size_t begin, size_t count) {
  const hk_spring_layout *s = t->layout;
  double sum = 0;
  for (size_t e = begin; e < begin + count; e++) {
    const double *xi = t->x + 3 * (size_t)s->pair[e][0], *xj = t->x + 3 * (size_t)s->pair[e][1];
    const double *vi = t->v + 3 * (size_t)s->pair[e][0], *vj = t->v + 3 * (size_t)s->pair[e][1];
    double *Fi = t->F + 3 * (size_t)s->pair[e][0], *Fj = t->F + 3 * (size_t)s->pair[e][1], p;
    double dx = xj[0] - xi[0], dy = xj[1] - xi[1], dz = xj[2] - xi[2];
    double w = s->damped ? dx * (vj[0] - vi[0]) + dy * (vj[1] - vi[1]) + dz * (vj[2] - vi[2]) : 0;
    double f = scale(dx * dx + dy * dy + dz * dz, w, s->k[s->each_k ? e : 0], s->c[s->each_c ? e : 0],
                     s->L[s->each_L ? e : 0], &p);
    Fi[0] += f * dx;
    Fi[1] += f * dy;
    Fi[2] += f * dz;
    Fj[0] -= f * dx;
    Fj[1] -= f * dy;
    Fj[2] -= f * dz;
    sum += p;
  }
  return sum;
}

static double one_block(const task *t, block *b, hk_spring_kind kind, size_t begin, size_t n) {
  const hk_spring_layout *s = t->layout;
  size_t i = 3 * (size_t)s->pair[begin][0], j = 3 * (size_t)s->pair[begin][1];
  const uint32_t(*pair)[2] = (const uint32_t(*)[2])s->pair + begin;
  if (kind == HK_SPRING_RUN)
    run_differences(b, n, t->x + i, t->x + j, t->v + i, t->v + j, s->damped);
  else
    list_differences(b, n, pair, t->x, t->v, s->damped);
  double power = scales(b, n, s, begin);
  if (kind == HK_SPRING_RUN)
    run_forces(b, n, t->F + i, t->F + j);
  else
    list_forces(b, n, pair, t->F);
  return power;
}

static double one_run(const task *t, block *b, const hk_spring_run *run) {
  size_t whole = run->kind == HK_SPRING_SINGLE ? 0 : run->count / 4 * 4;
  double power = 0;
  for (size_t e = 0; e < whole; e += BLOCK)
    power += one_block(t, b, run->kind, run->begin + e, whole - e < BLOCK ? whole - e : BLOCK);
  return power + single(t, run->begin + whole, run->count - whole);
}

static void one_group(const task *t, size_t group) {
  block b;
  const hk_spring_layout *s = t->layout;
  double power = 0;
  for (size_t r = s->group[group]; r < s->group[group + 1]; r++) power += one_run(t, &b, &s->run[r]);
  s->group_power[group] = power;
}

static void groups(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  const task *t = context;
  for (size_t g = begin; g < end; g++) one_group(t, t->first_group + g);
}

void hk_spring_forces(const hk_spring_layout *s, const hk_host *host, const double *x, const double *v, double *F,
                      double *power) {
  task t = {s, x, v, F, 0, power != NULL};
  if (s->runs == 1 && s->run[0].kind == HK_SPRING_SINGLE) { /* a small scene: without a block on the stack */
    double p = single(&t, 0, s->count);
    if (power) *power -= p;
    return;
  }
  for (size_t r = 0; r < s->rounds; r++) {
    t.first_group = s->round[r];
    host->parallel_for(host, s->round[r + 1] - s->round[r], 1, groups, &t);
  }
  for (size_t g = 0; power && g < s->groups; g++) *power -= s->group_power[g];
}
