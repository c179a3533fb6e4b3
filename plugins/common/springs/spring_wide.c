/* Four springs at a time, in one pass: differences and dot products, the scales with square root and division on full
 * vectors, and the addition of forces to both ends. For x86-64 with AVX2. */
#include "plugins/common/springs/spring_path.h"

#include <math.h>

#if defined(__x86_64__)

#define WIDE __attribute__((target("avx2")))

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(32), aligned(8), may_alias));
typedef double half __attribute__((vector_size(16), aligned(8), may_alias));

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

/* Transposes rows of three numbers (and an unused one) to columns. */
#define COLUMNS(r, X, Y, Z)                                                                                            \
  vector X, Y, Z;                                                                                                      \
  do {                                                                                                                 \
    vector a_ = PICK(r[0], r[1], 0, 4, 2, 6), b_ = PICK(r[2], r[3], 0, 4, 2, 6);                                       \
    vector c_ = PICK(r[0], r[1], 1, 5, 3, 7), d_ = PICK(r[2], r[3], 1, 5, 3, 7);                                       \
    X = PICK(a_, b_, 0, 1, 4, 5);                                                                                      \
    Z = PICK(a_, b_, 2, 3, 6, 7);                                                                                      \
    Y = PICK(c_, d_, 0, 1, 4, 5);                                                                                      \
  } while (0)

/* Any springs. Forces are always added as x and y together and z alone: a wider store would overlap a neighbouring
 * particle, whose load would wait for it. */
WIDE static double list(const hk_spring_numbers *q, size_t n, const uint32_t (*restrict pair)[2],
                        const double *restrict x, const double *restrict v, double *restrict F, bool damped) {
  vector part = {0};
  for (size_t e = 0; e < n; e += HK_SPRING_LANES) {
    vector d[HK_SPRING_LANES], u[HK_SPRING_LANES], l2, w = {0}, s;
    size_t i[HK_SPRING_LANES], j[HK_SPRING_LANES];
    for (size_t r = 0; r < HK_SPRING_LANES; r++) {
      i[r] = 3 * (size_t)pair[e + r][0];
      j[r] = 3 * (size_t)pair[e + r][1];
      d[r] = LOAD(x + j[r]) - LOAD(x + i[r]);
    }
    COLUMNS(d, dx, dy, dz);
    l2 = dx * dx + dy * dy + dz * dz;
    if (damped) {
      for (size_t r = 0; r < HK_SPRING_LANES; r++) u[r] = LOAD(v + j[r]) - LOAD(v + i[r]);
      COLUMNS(u, ux, uy, uz);
      w = dx * ux + dy * uy + dz * uz;
    }
    SCALES(s, part, l2, w, e, q);
    dx *= s, dy *= s, dz *= s;
    for (size_t r = 0; r < HK_SPRING_LANES; r++) {
      half f = {dx[r], dy[r]};
      *(half *)(F + i[r]) += f;
      F[i[r] + 2] += dz[r];
      *(half *)(F + j[r]) -= f;
      F[j[r] + 2] -= dz[r];
    }
  }
  return (part[0] + part[1]) + (part[2] + part[3]);
}

const hk_spring_path *hk_spring_wide(void) {
  static const hk_spring_path path = {far_run, near_run, list};
  return __builtin_cpu_supports("avx2") ? &path : NULL;
}

#else

const hk_spring_path *hk_spring_wide(void) { return NULL; }

#endif
