/* Two springs at a time, in one pass, with the vectors of two doubles that every x86-64 and arm64 has. */
#include "plugins/common/springs/spring_path.h"

#include <math.h>

typedef double half __attribute__((vector_size(16), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(16), aligned(8), may_alias));

#define LOAD(p) (*(const half *)(p))
#define ADD(p, value) (*(half *)(p) += (value))
#define SUBTRACT(p, value) (*(half *)(p) -= (value))
#define PICK __builtin_shufflevector

enum { LANES = HK_SPRING_LANES, PAIRS = LANES / 2 };

/* The coefficients of springs e and e+1, in lanes `at` and at+1 of four. */
static inline half number(const double *list, size_t each, size_t e, size_t at) { return LOAD(list + (e & each) + at); }

static inline half scales(const hk_spring_numbers *q, size_t e, size_t at, half l2, half w, half *part) {
  const half one = {1, 1};
  mask m = (mask)(l2 > HK_SPRING_TINY);
  half safe = (half)((m & (mask)l2) | (~m & (mask)one)), l = {sqrt(safe[0]), sqrt(safe[1])}, r = 1 / safe;
  half cwr = number(q->c, q->each_c, e, at) * w * r;
  *part += cwr * w;
  return number(q->k, q->each_k, e, at) * (l - number(q->L, q->each_L, e, at)) * l * r + cwr;
}

/* (a0 + a1 + b0, b1 + c0 + c1), each as (x + y) + z. */
static inline half sum3(half a, half b, half c) { return PICK(a, b, 0, 3) + PICK(a, c, 1, 2) + PICK(b, c, 0, 3); }

/* d: the forces on the first ends of two springs of a run, in the layout of x. */
static inline void run_pair(const hk_spring_numbers *q, size_t e, size_t at, const double *xi, const double *xj,
                            const double *vi, const double *vj, bool damped, half *part, half d[3]) {
  half l2, w = {0, 0}, u[3];
  size_t first = 3 * (e + at);
  for (size_t r = 0; r < 3; r++) d[r] = LOAD(xj + first + 2 * r) - LOAD(xi + first + 2 * r);
  l2 = sum3(d[0] * d[0], d[1] * d[1], d[2] * d[2]);
  if (damped) {
    for (size_t r = 0; r < 3; r++) u[r] = LOAD(vj + first + 2 * r) - LOAD(vi + first + 2 * r);
    w = sum3(d[0] * u[0], d[1] * u[1], d[2] * u[2]);
  }
  half s = scales(q, e, at, l2, w, part);
  d[0] *= PICK(s, s, 0, 0);
  d[1] *= s;
  d[2] *= PICK(s, s, 1, 1);
}

static double far_run(const hk_spring_numbers *q, size_t n, const double *restrict xi, const double *restrict xj,
                      const double *restrict vi, const double *restrict vj, double *Fi, double *Fj, bool damped) {
  half part[PAIRS] = {{0, 0}, {0, 0}}, f[3];
  for (size_t e = 0; e < n; e += LANES)
    for (size_t p = 0; p < PAIRS; p++) {
      run_pair(q, e, 2 * p, xi, xj, vi, vj, damped, &part[p], f);
      for (size_t r = 0; r < 3; r++) ADD(Fi + 3 * e + 6 * p + 2 * r, f[r]);
      for (size_t r = 0; r < 3; r++) SUBTRACT(Fj + 3 * e + 6 * p + 2 * r, f[r]);
    }
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
}

static double near_run(const hk_spring_numbers *q, size_t n, const double *restrict xi, const double *restrict xj,
                       const double *restrict vi, const double *restrict vj, double *Fi, double *Fj, bool damped) {
  half part[PAIRS] = {{0, 0}, {0, 0}}, f[3 * HK_SPRING_BLOCK / 2];
  for (size_t e = 0; e < n; e += LANES)
    for (size_t p = 0; p < PAIRS; p++) {
      half *at = f + 3 * e / 2 + 3 * p;
      run_pair(q, e, 2 * p, xi, xj, vi, vj, damped, &part[p], at);
      for (size_t r = 0; r < 3; r++) ADD(Fi + 3 * e + 6 * p + 2 * r, at[r]);
    }
  for (size_t r = 0; r < 3 * n / 2; r++) SUBTRACT(Fj + 2 * r, f[r]);
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
}

static double list(const hk_spring_numbers *q, size_t n, const uint32_t (*restrict pair)[2], const double *restrict x,
                   const double *restrict v, double *restrict F, bool damped) {
  half part[PAIRS] = {{0, 0}, {0, 0}};
  for (size_t e = 0; e < n; e += 2) {
    size_t i0 = 3 * (size_t)pair[e][0], j0 = 3 * (size_t)pair[e][1], i1 = 3 * (size_t)pair[e + 1][0],
           j1 = 3 * (size_t)pair[e + 1][1], at = e % LANES;
    half a = LOAD(x + j0) - LOAD(x + i0), b = LOAD(x + j1) - LOAD(x + i1), w = {0, 0};
    half dx = PICK(a, b, 0, 2), dy = PICK(a, b, 1, 3), dz = {x[j0 + 2] - x[i0 + 2], x[j1 + 2] - x[i1 + 2]};
    if (damped) {
      half g = LOAD(v + j0) - LOAD(v + i0), h = LOAD(v + j1) - LOAD(v + i1);
      half uz = {v[j0 + 2] - v[i0 + 2], v[j1 + 2] - v[i1 + 2]};
      w = dx * PICK(g, h, 0, 2) + dy * PICK(g, h, 1, 3) + dz * uz;
    }
    half s = scales(q, e - at, at, dx * dx + dy * dy + dz * dz, w, &part[at / 2]);
    a *= s[0], b *= s[1], dz *= s;
    ADD(F + i0, a), F[i0 + 2] += dz[0];
    SUBTRACT(F + j0, a), F[j0 + 2] -= dz[0];
    ADD(F + i1, b), F[i1 + 2] += dz[1];
    SUBTRACT(F + j1, b), F[j1 + 2] -= dz[1];
  }
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
}

const hk_spring_path hk_spring_narrow = {far_run, near_run, list};
