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
  if (at == 0) hk_spring_fetch(q, e);
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

/* ---- lists ---- */

/* The sums of two bundles of a slice: x and y of the first, of the second, z of both. */
typedef struct twins {
  half sum[3];
} twins;

/* Springs e + at and the one after of a slot that begins at `pair`. There is only the first one where the slot ends;
 * the other lane then has any numbers, and none in the sums. Returns c w^2/l^2. */
static inline __attribute__((always_inline)) half list_pair(const hk_spring_numbers *q, size_t e, size_t at,
                                                            const uint32_t (*pair)[2], bool both, const double *x,
                                                            const double *v, double *F, bool damped, twins *own) {
  const mask here = {-1, both ? -1 : 0};
  size_t i0 = 3 * (size_t)pair[at][0], j0 = 3 * (size_t)pair[at][1];
  size_t i1 = 3 * (size_t)pair[at + 1][0], j1 = 3 * (size_t)pair[at + 1][1];
  half a = LOAD(x + j0) - LOAD(x + i0), b = LOAD(x + j1) - LOAD(x + i1), w = {0, 0}, power = {0, 0};
  half dx = PICK(a, b, 0, 2), dy = PICK(a, b, 1, 3), dz = {x[j0 + 2] - x[i0 + 2], x[j1 + 2] - x[i1 + 2]};
  if (damped) {
    half g = LOAD(v + j0) - LOAD(v + i0), h = LOAD(v + j1) - LOAD(v + i1);
    half uz = {v[j0 + 2] - v[i0 + 2], v[j1 + 2] - v[i1 + 2]};
    w = dx * PICK(g, h, 0, 2) + dy * PICK(g, h, 1, 3) + dz * uz;
  }
  half s = scales(q, e, at, dx * dx + dy * dy + dz * dz, w, &power);
  a *= s[0], b *= s[1], dz *= s;
  b = (half)((mask){here[1], here[1]} & (mask)b), dz = (half)(here & (mask)dz);
  own->sum[0] += a, own->sum[1] += b, own->sum[2] += dz;
  SUBTRACT(F + j0, a), F[j0 + 2] -= dz[0];
  if (both) SUBTRACT(F + j1, b), F[j1 + 2] -= dz[1];
  return (half)(here & (mask)power);
}

static inline __attribute__((always_inline)) double list_springs(const hk_spring_numbers *q, const hk_spring_list *list,
                                                                 const double *restrict x, const double *restrict v,
                                                                 double *restrict F, bool damped) {
  const uint8_t *lanes = list->lanes;
  half part[HK_SPRING_BUNDLES / 2] = {{0}, {0}, {0}, {0}};
  for (size_t e = 0; e < list->count; lanes++) {
    const uint32_t(*own)[2] = list->pair + e;
    const size_t bundles = *lanes;
    twins sum[HK_SPRING_BUNDLES / 2] = {0};
    for (; *lanes; e += *lanes++) {
      hk_spring_fetch(q, e);
      __builtin_prefetch(list->pair + e + HK_SPRING_AHEAD);
      size_t at = 0;
      for (; at + 1 < *lanes; at += 2)
        part[at / 2] += list_pair(q, e, at, list->pair + e, true, x, v, F, damped, &sum[at / 2]);
      if (at < *lanes) part[at / 2] += list_pair(q, e, at, list->pair + e, false, x, v, F, damped, &sum[at / 2]);
    }
    for (size_t r = 0; r < bundles; r++) {
      ADD(F + 3 * (size_t)own[r][0], sum[r / 2].sum[r % 2]);
      F[3 * (size_t)own[r][0] + 2] += sum[r / 2].sum[2][r % 2];
    }
  }
  part[0] += part[2], part[1] += part[3];
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
}

static double list(const hk_spring_numbers *q, const hk_spring_list *list, const double *x, const double *v, double *F,
                   bool damped) {
  return damped ? list_springs(q, list, x, v, F, true) : list_springs(q, list, x, v, F, false);
}

const hk_spring_path hk_spring_narrow = {far_run, near_run, list};
