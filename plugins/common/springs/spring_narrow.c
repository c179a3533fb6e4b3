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

static const mask two_bits[4] = {{0, 0}, {-1, 0}, {0, -1}, {-1, -1}}; /* all bits where a bit of the index is set */

static inline half scales(const hk_spring_numbers *q, size_t e, size_t at, mask here, half l2, half w, half *part) {
  const half one = {1, 1};
  mask m = (mask)(l2 > HK_SPRING_TINY) & here;
  half safe = (half)((m & (mask)l2) | (~m & (mask)one)), l = {sqrt(safe[0]), sqrt(safe[1])}, r = 1 / safe;
  half cwr = number(q->c, q->each_c, e, at) * w * r;
  *part += cwr * w;
  return number(q->k, q->each_k, e, at) * (l - number(q->L, q->each_L, e, at)) * l * r + cwr;
}

/* (a0 + a1 + b0, b1 + c0 + c1), each as (x + y) + z. */
static inline half sum3(half a, half b, half c) { return PICK(a, b, 0, 3) + PICK(a, c, 1, 2) + PICK(b, c, 0, 3); }

/* d: the forces on the first ends of two springs of a run, in the layout of x. */
static inline void run_pair(const hk_spring_numbers *q, size_t e, size_t at, const uint8_t *present, const double *xi,
                            const double *xj, const double *vi, const double *vj, bool damped, half *part, half d[3]) {
  half l2, w = {0, 0}, u[3];
  size_t first = 3 * (e + at);
  for (size_t r = 0; r < 3; r++) d[r] = LOAD(xj + first + 2 * r) - LOAD(xi + first + 2 * r);
  l2 = sum3(d[0] * d[0], d[1] * d[1], d[2] * d[2]);
  if (damped) {
    for (size_t r = 0; r < 3; r++) u[r] = LOAD(vj + first + 2 * r) - LOAD(vi + first + 2 * r);
    w = sum3(d[0] * u[0], d[1] * u[1], d[2] * u[2]);
  }
  mask here = two_bits[present[(e + at) / 8] >> (e + at) % 8 & 3];
  half s = scales(q, e, at, here, l2, (half)((mask)w & here), part);
  s = (half)((mask)s & here);
  d[0] *= PICK(s, s, 0, 0);
  d[1] *= s;
  d[2] *= PICK(s, s, 1, 1);
}

static double far_run(const hk_spring_numbers *q, size_t n, const uint8_t *present, const double *restrict xi,
                      const double *restrict xj, const double *restrict vi, const double *restrict vj, double *Fi,
                      double *Fj, bool damped) {
  half part[PAIRS] = {{0, 0}, {0, 0}}, f[3];
  for (size_t e = 0; e < n; e += LANES)
    for (size_t p = 0; p < PAIRS; p++) {
      run_pair(q, e, 2 * p, present, xi, xj, vi, vj, damped, &part[p], f);
      for (size_t r = 0; r < 3; r++) ADD(Fi + 3 * e + 6 * p + 2 * r, f[r]);
      for (size_t r = 0; r < 3; r++) SUBTRACT(Fj + 3 * e + 6 * p + 2 * r, f[r]);
    }
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
}

static double near_run(const hk_spring_numbers *q, size_t n, const uint8_t *present, const double *restrict xi,
                       const double *restrict xj, const double *restrict vi, const double *restrict vj, double *Fi,
                       double *Fj, bool damped) {
  half part[PAIRS] = {{0, 0}, {0, 0}}, f[3 * HK_SPRING_BLOCK / 2];
  for (size_t e = 0; e < n; e += LANES)
    for (size_t p = 0; p < PAIRS; p++) {
      half *at = f + 3 * e / 2 + 3 * p;
      run_pair(q, e, 2 * p, present, xi, xj, vi, vj, damped, &part[p], at);
      for (size_t r = 0; r < 3; r++) ADD(Fi + 3 * e + 6 * p + 2 * r, at[r]);
    }
  for (size_t r = 0; r < 3 * n / 2; r++) SUBTRACT(Fj + 2 * r, f[r]);
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
}

/* ---- lists ---- */

/* Rows of two particles to columns; `end`: the first or the second of each pair. */
static inline void columns(const double *x, const uint32_t (*pair)[2], int end, half column[3]) {
  const double *p = x + 3 * (size_t)pair[0][end], *q = x + 3 * (size_t)pair[1][end];
  half a = LOAD(p), b = LOAD(q);
  column[0] = PICK(a, b, 0, 2);
  column[1] = PICK(a, b, 1, 3);
  column[2] = (half){p[2], q[2]};
}

static inline void store_pulls(double xy[2][2], double z[2], const half f[3]) {
  *(half *)xy[0] = PICK(f[0], f[1], 0, 2);
  *(half *)xy[1] = PICK(f[0], f[1], 1, 3);
  *(half *)z = f[2];
}

static inline half keep(mask m, half value) { return (half)(m & (mask)value); }

/* d: the forces on the first ends, at x and v, of springs e + at and the one after, of a slot that begins at `pair`. */
static inline half slot_pair(const hk_spring_numbers *q, size_t e, size_t at, const uint32_t (*pair)[2],
                             const double *all_x, const double *all_v, const half x[3], const half v[3], bool damped,
                             half d[3]) {
  half u[3], w = {0, 0}, power = {0, 0};
  columns(all_x, pair + at, 1, d);
  for (size_t r = 0; r < 3; r++) d[r] -= x[r];
  if (damped) {
    columns(all_v, pair + at, 1, u);
    for (size_t r = 0; r < 3; r++) u[r] -= v[r];
    w = d[0] * u[0] + d[1] * u[1] + d[2] * u[2];
  }
  half s = scales(q, e, at, two_bits[3], d[0] * d[0] + d[1] * d[1] + d[2] * d[2], w, &power);
  for (size_t r = 0; r < 3; r++) d[r] *= s;
  return power;
}

/* The forces of the bundles `at` and at + 1 of a slice that begins at `pair`; e: its first spring. Lanes beyond a slot
 * have any numbers, and none in the sums. */
static void slice_pair(const hk_spring_numbers *q, size_t e, size_t at, const uint32_t (*pair)[2], const uint8_t *lanes,
                       const double *x, const double *v, bool damped, hk_spring_pulls *p, half *part) {
  half xi[3], vi[3] = {{0}, {0}, {0}}, d[3], sum[3] = {{0}, {0}, {0}};
  columns(x, pair + at, 0, xi);
  if (damped) columns(v, pair + at, 0, vi);
  for (size_t t = 0; lanes[t] > at; e += lanes[t], pair += lanes[t], t++) {
    const mask here = {-1, lanes[t] > at + 1 ? -1 : 0};
    *part += keep(here, slot_pair(q, e, at, pair, x, v, xi, vi, damped, d));
    for (size_t r = 0; r < 3; r++) sum[r] += keep(here, d[r]);
    store_pulls(&p->xy[t][at], &p->z[t][at], d);
  }
  store_pulls(&p->sum_xy[at], &p->sum_z[at], sum);
}

static double list(const hk_spring_numbers *q, const hk_spring_list *list, const double *x, const double *v, double *F,
                   bool damped) {
  const uint8_t *lanes = list->lanes;
  half part[4] = {{0}, {0}, {0}, {0}};
  hk_spring_pulls p;
  for (size_t e = 0; e < list->count; lanes++) {
    const uint32_t(*pair)[2] = list->pair + e;
    for (size_t h = 0; h < 4; h++) slice_pair(q, e, 2 * h, pair, lanes, x, v, damped, &p, &part[h]);
    hk_spring_pulls_add(&p, pair, lanes, F);
    while (*lanes) e += *lanes++;
  }
  part[0] += part[2], part[1] += part[3];
  return (part[0][0] + part[0][1]) + (part[1][0] + part[1][1]);
}

const hk_spring_path hk_spring_narrow = {far_run, near_run, list};
