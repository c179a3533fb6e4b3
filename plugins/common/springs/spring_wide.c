/* Four springs at a time, in one pass: differences and dot products, the scales with square root and division on full
 * vectors, and the addition of forces to both ends. For x86-64 with AVX2. */
#include "plugins/common/springs/spring_path.h"

#include <math.h>

#if defined(__x86_64__)

#define WIDE __attribute__((target("avx2")))
#define INLINE WIDE __attribute__((always_inline)) static inline

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(32), aligned(8), may_alias));

/* Macros, because vectors must not be passed between functions compiled for different instruction sets. */
#define LOAD(p) (*(const vector *)(p))
#define STORE(p, value) (*(vector *)(p) = (value))
#define PICK __builtin_shufflevector

/* Sums of three neighbours: (a0+a1+a2, a3+b0+b1, b2+b3+c0, c1+c2+c3), each as (x + y) + z. */
#define SUM3(into, a, b, c)                                                                                            \
  do {                                                                                                                 \
    vector x_ = PICK(PICK(PICK(a, b, 0, 1, 6, 3), c, 0, 5, 2, 3), c, 0, 3, 2, 1);                                      \
    vector y_ = PICK(PICK(PICK(b, a, 0, 5, 2, 3), c, 0, 1, 6, 3), c, 1, 0, 3, 2);                                      \
    vector z_ = PICK(PICK(PICK(c, b, 0, 5, 2, 3), a, 0, 1, 6, 3), a, 2, 1, 0, 3);                                      \
    into = x_ + y_ + z_;                                                                                               \
  } while (0)

/* s from l2 = d.d and w = u.d of springs e..e+3; adds c w^2/l^2 to `part`. The other paths do the same operations. */
#define SCALES(s, part, l2, w, e, q)                                                                                   \
  do {                                                                                                                 \
    const vector one_ = {1, 1, 1, 1};                                                                                  \
    mask m_ = (mask)(l2 > HK_SPRING_TINY);                                                                             \
    vector safe_ = (vector)((m_ & (mask)l2) | (~m_ & (mask)one_));                                                     \
    vector l_ = {sqrt(safe_[0]), sqrt(safe_[1]), sqrt(safe_[2]), sqrt(safe_[3])}, r_ = 1 / safe_;                      \
    vector cwr_ = LOAD((q)->c + ((e) & (q)->each_c)) * w * r_;                                                         \
    part += cwr_ * w;                                                                                                  \
    s = LOAD((q)->k + ((e) & (q)->each_k)) * (l_ - LOAD((q)->L + ((e) & (q)->each_L))) * l_ * r_ + cwr_;               \
  } while (0)

#define RUN_SPRINGS(q, e, s, part, d0, d1, d2)                                                                         \
  do {                                                                                                                 \
    hk_spring_fetch(q, e);                                                                                             \
    size_t at_ = 3 * (e);                                                                                              \
    vector l2_, w_ = {0};                                                                                              \
    d0 = LOAD(xj + at_) - LOAD(xi + at_);                                                                              \
    d1 = LOAD(xj + at_ + 4) - LOAD(xi + at_ + 4);                                                                      \
    d2 = LOAD(xj + at_ + 8) - LOAD(xi + at_ + 8);                                                                      \
    vector q0_ = d0 * d0, q1_ = d1 * d1, q2_ = d2 * d2;                                                                \
    SUM3(l2_, q0_, q1_, q2_);                                                                                          \
    if (damped) {                                                                                                      \
      q0_ = d0 * (LOAD(vj + at_) - LOAD(vi + at_));                                                                    \
      q1_ = d1 * (LOAD(vj + at_ + 4) - LOAD(vi + at_ + 4));                                                            \
      q2_ = d2 * (LOAD(vj + at_ + 8) - LOAD(vi + at_ + 8));                                                            \
      SUM3(w_, q0_, q1_, q2_);                                                                                         \
    }                                                                                                                  \
    SCALES(s, part, l2_, w_, e, q);                                                                                    \
    d0 *= PICK(s, s, 0, 0, 0, 1);                                                                                      \
    d1 *= PICK(s, s, 1, 1, 2, 2);                                                                                      \
    d2 *= PICK(s, s, 2, 3, 3, 3);                                                                                      \
  } while (0)

#define ADD(p, value) STORE(p, LOAD(p) + (value))

/* A run whose ends are far apart: stores to one end are complete long before the other end loads these particles. */
WIDE static double far_run(const hk_spring_numbers *q, size_t n, const double *restrict xi, const double *restrict xj,
                           const double *restrict vi, const double *restrict vj, double *Fi, double *Fj, bool damped) {
  vector part = {0};
  for (size_t e = 0; e < n; e += HK_SPRING_LANES) {
    vector s, d0, d1, d2;
    RUN_SPRINGS(q, e, s, part, d0, d1, d2);
    ADD(Fi + 3 * e, d0);
    ADD(Fi + 3 * e + 4, d1);
    ADD(Fi + 3 * e + 8, d2);
    ADD(Fj + 3 * e, -d0);
    ADD(Fj + 3 * e + 4, -d1);
    ADD(Fj + 3 * e + 8, -d2);
  }
  return (part[0] + part[1]) + (part[2] + part[3]);
}

/* A run whose ends overlap: forces are stored in a buffer and added to one end after the other. */
WIDE static double near_run(const hk_spring_numbers *q, size_t n, const double *restrict xi, const double *restrict xj,
                            const double *restrict vi, const double *restrict vj, double *Fi, double *Fj, bool damped) {
  vector part = {0};
  double f[3 * HK_SPRING_BLOCK] __attribute__((aligned(64)));
  for (size_t e = 0; e < n; e += HK_SPRING_LANES) {
    vector s, d0, d1, d2;
    RUN_SPRINGS(q, e, s, part, d0, d1, d2);
    STORE(f + 3 * e, d0);
    STORE(f + 3 * e + 4, d1);
    STORE(f + 3 * e + 8, d2);
    ADD(Fi + 3 * e, d0);
    ADD(Fi + 3 * e + 4, d1);
    ADD(Fi + 3 * e + 8, d2);
  }
  for (size_t e = 0; e < 3 * n; e += HK_SPRING_LANES) ADD(Fj + e, -LOAD(f + e));
  return (part[0] + part[1]) + (part[2] + part[3]);
}

/* ---- lists ---- */

/* The rows of four particles, three numbers and an unused one each, to columns; `end`: the first or the second of each
 * pair. */
#define COLUMNS(x, pair, end, X, Y, Z)                                                                                 \
  do {                                                                                                                 \
    vector r_[4];                                                                                                      \
    for (size_t k_ = 0; k_ < 4; k_++) r_[k_] = LOAD((x) + 3 * (size_t)(pair)[k_][end]);                                \
    vector a_ = PICK(r_[0], r_[1], 0, 4, 2, 6), b_ = PICK(r_[2], r_[3], 0, 4, 2, 6);                                   \
    vector c_ = PICK(r_[0], r_[1], 1, 5, 3, 7), d_ = PICK(r_[2], r_[3], 1, 5, 3, 7);                                   \
    X = PICK(a_, b_, 0, 1, 4, 5);                                                                                      \
    Z = PICK(a_, b_, 2, 3, 6, 7);                                                                                      \
    Y = PICK(c_, d_, 0, 1, 4, 5);                                                                                      \
  } while (0)

#define STORE_PULLS(xy, z, X, Y, Z)                                                                                    \
  do {                                                                                                                 \
    STORE((xy)[0], PICK(X, Y, 0, 4, 1, 5));                                                                            \
    STORE((xy)[2], PICK(X, Y, 2, 6, 3, 7));                                                                            \
    STORE(z, Z);                                                                                                       \
  } while (0)

#define KEEP(m, value) ((vector)((m) & (mask)(value)))

/* The forces of the four bundles from number `at` on of a slice that begins at `pair`; e: its first spring. Lanes
 * beyond a slot have any numbers, and none in the sums. */
INLINE void half_slice(const hk_spring_numbers *q, size_t e, size_t at, const uint32_t (*pair)[2], const uint8_t *lanes,
                       const double *x, const double *v, bool damped, hk_spring_pulls *p, vector *part) {
  vector xi, yi, zi, vxi = {0}, vyi = {0}, vzi = {0}, sx = {0}, sy = {0}, sz = {0};
  COLUMNS(x, pair + at, 0, xi, yi, zi);
  if (damped) COLUMNS(v, pair + at, 0, vxi, vyi, vzi);
  for (size_t t = 0; lanes[t] > at; e += lanes[t], pair += lanes[t], t++) {
    const int64_t n = lanes[t] - (int64_t)at;
    const mask here = (mask){0, 1, 2, 3} < (mask){n, n, n, n};
    vector dx, dy, dz, ux, uy, uz, s, w = {0}, power = {0};
    if (at == 0) {
      __builtin_prefetch(pair + HK_SPRING_AHEAD);
      hk_spring_fetch(q, e);
    }
    COLUMNS(x, pair + at, 1, dx, dy, dz);
    dx -= xi, dy -= yi, dz -= zi;
    if (damped) {
      COLUMNS(v, pair + at, 1, ux, uy, uz);
      ux -= vxi, uy -= vyi, uz -= vzi;
      w = dx * ux + dy * uy + dz * uz;
    }
    vector l2 = dx * dx + dy * dy + dz * dz;
    SCALES(s, power, l2, w, e + at, q);
    *part += KEEP(here, power);
    dx *= s, dy *= s, dz *= s;
    sx += KEEP(here, dx), sy += KEEP(here, dy), sz += KEEP(here, dz);
    STORE_PULLS(&p->xy[t][at], &p->z[t][at], dx, dy, dz);
  }
  STORE_PULLS(&p->sum_xy[at], &p->sum_z[at], sx, sy, sz);
}

INLINE double list_springs(const hk_spring_numbers *q, const hk_spring_list *list, const double *x, const double *v,
                           double *F, bool damped) {
  const uint8_t *lanes = list->lanes;
  vector part[2] = {{0}, {0}};
  hk_spring_pulls p;
  for (size_t e = 0; e < list->count; lanes++) {
    const uint32_t(*pair)[2] = list->pair + e;
    for (size_t h = 0; h < 2; h++) half_slice(q, e, 4 * h, pair, lanes, x, v, damped, &p, &part[h]);
    hk_spring_pulls_add(&p, pair, lanes, F);
    while (*lanes) e += *lanes++;
  }
  part[0] += part[1];
  return (part[0][0] + part[0][1]) + (part[0][2] + part[0][3]);
}

WIDE static double list(const hk_spring_numbers *q, const hk_spring_list *list, const double *x, const double *v,
                        double *F, bool damped) {
  return damped ? list_springs(q, list, x, v, F, true) : list_springs(q, list, x, v, F, false);
}

const hk_spring_path *hk_spring_wide(void) {
  static const hk_spring_path path = {far_run, near_run, list};
  return __builtin_cpu_supports("avx2") ? &path : NULL;
}

#else

const hk_spring_path *hk_spring_wide(void) { return NULL; }

#endif
