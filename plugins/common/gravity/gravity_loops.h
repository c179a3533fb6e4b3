/* The loops of gravity_path.h. A file that includes this one defines before: INLINE and TARGET, attributes with its
 * instruction set; LANES, vector (doubles) and mask (integers); SPREAD(a), a in all lanes; FMA(a, b, c) = a b + c; and
 * root(s2) = 1/sqrt(s2). All functions with vectors are inlined into functions for the same instructions. */
#include "plugins/common/gravity/gravity_path.h"

enum {
  TOGETHER = 2, /* vectors at a time: each hides the latency of the other */
  SPAN = 64     /* sources that are summed apart: roundings of the sum of n grow with SPAN and n/SPAN, not with n */
};

#define LOAD(p) (*(const vector *)(p))
#define STORE(p, value) (*(vector *)(p) = (value))

typedef struct place {
  vector x, y, z;
} place;

INLINE place place_of(const hk_targets *t, size_t at) {
  return (place){LOAD(t->x[0] + at), LOAD(t->x[1] + at), LOAD(t->x[2] + at)};
}

INLINE place from_to(const place *p, double x, double y, double z) {
  return (place){SPREAD(x) - p->x, SPREAD(y) - p->y, SPREAD(z) - p->z};
}

INLINE vector square(const place *d, vector soft) { return FMA(d->x, d->x, FMA(d->y, d->y, FMA(d->z, d->z, soft))); }

/* 1/s, and 0 at distance 0: what `root` makes of 0, infinity or NaN, loses all its bits. */
INLINE vector root_apart(vector s2) { return (vector)((mask)(s2 > 0) & (mask)root(s2)); }

/* One vector of targets and its sums. */
typedef struct lane_sums {
  place at, a;
  mask zeros;
} lane_sums;

INLINE void pull_one(lane_sums *t, const hk_bodies *s, size_t j, vector soft, const bool bare) {
  place d = from_to(&t->at, s->x[j], s->y[j], s->z[j]);
  vector s2 = square(&d, soft), w;
  if (bare) t->zeros -= (mask)(s2 == 0); /* true is -1 */
  w = bare ? root_apart(s2) : root(s2);
  vector f = (SPREAD(s->m[j]) * w) * (w * w);
  t->a = (place){FMA(f, d.x, t->a.x), FMA(f, d.y, t->a.y), FMA(f, d.z, t->a.z)};
}

INLINE lane_sums no_sums(const hk_targets *t, size_t l) { return (lane_sums){.at = place_of(t, l)}; }

INLINE void add_sums(hk_pull *sum, const lane_sums *t, size_t l) {
  STORE(sum->a[0] + l, LOAD(sum->a[0] + l) + t->a.x);
  STORE(sum->a[1] + l, LOAD(sum->a[1] + l) + t->a.y);
  STORE(sum->a[2] + l, LOAD(sum->a[2] + l) + t->a.z);
  *(mask *)(sum->zeros + l) += t->zeros;
}

INLINE void pull_at(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2, hk_pull *sum,
                    size_t at, const bool bare) {
  const vector soft = SPREAD(eps2);
  for (size_t j = begin; j < end;) {
    lane_sums one = no_sums(t, at), two = no_sums(t, at + LANES);
    for (size_t until = end - j < SPAN ? end : j + SPAN; j < until; j++) {
      pull_one(&one, s, j, soft, bare);
      pull_one(&two, s, j, soft, bare);
    }
    add_sums(sum, &one, at);
    add_sums(sum, &two, at + LANES);
  }
}

TARGET static void pull(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2, hk_pull *sum) {
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += TOGETHER * LANES)
    if (eps2 > 0)
      pull_at(s, begin, end, t, eps2, sum, at, false);
    else
      pull_at(s, begin, end, t, 0, sum, at, true);
}

INLINE void scalar_at(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2, double *sum,
                      size_t at, const int power) {
  const place p = place_of(t, at);
  const vector soft = SPREAD(eps2);
  for (size_t j = begin; j < end;) {
    vector total = {0};
    for (size_t until = end - j < SPAN ? end : j + SPAN; j < until; j++) {
      place d = from_to(&p, s->x[j], s->y[j], s->z[j]);
      vector s2 = square(&d, soft), w = root_apart(s2);
      if (power == 3)
        total = FMA(SPREAD(s->m[j]) * w, w * w, total);
      else
        total = FMA(SPREAD(s->m[j]), w, total);
    }
    STORE(sum + at, LOAD(sum + at) + total);
  }
}

TARGET static void scalar(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2, int power,
                          double *sum) {
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += LANES)
    if (power == 3)
      scalar_at(s, begin, end, t, eps2, sum, at, 3);
    else
      scalar_at(s, begin, end, t, eps2, sum, at, 1);
}

/* S d of a cell. */
INLINE place moments_times(const double *c, const place *d) {
  const double *S = c + HK_CELL_S;
  return (place){FMA(SPREAD(S[0]), d->x, FMA(SPREAD(S[1]), d->y, SPREAD(S[2]) * d->z)),
                 FMA(SPREAD(S[1]), d->x, FMA(SPREAD(S[3]), d->y, SPREAD(S[4]) * d->z)),
                 FMA(SPREAD(S[2]), d->x, FMA(SPREAD(S[4]), d->y, SPREAD(S[5]) * d->z))};
}

/* With d from the target to the cell, S and trace as in HK_CELL_S:
 *     a = M d/s^3 + (5/2 d.Sd/s^7 - trace/s^5) d - Sd/s^5,      potential M/s + (d.Sd/s^5)/2 - trace/(3 s^3):
 * 1/s to second order about the centre of mass, where the first order vanishes. The softening is in s, so that the
 * trace stays. */
INLINE void pull_cell(lane_sums *t, const double *c, vector soft) {
  place d = from_to(&t->at, c[HK_CELL_X], c[HK_CELL_Y], c[HK_CELL_Z]), Sd = moments_times(c, &d);
  vector w = root(square(&d, soft)), w2 = w * w, w3 = w2 * w, w5 = w3 * w2;
  vector dSd = FMA(Sd.x, d.x, FMA(Sd.y, d.y, Sd.z * d.z));
  vector f = FMA(w5, FMA(SPREAD(2.5) * dSd, w2, SPREAD(-c[HK_CELL_TRACE])), SPREAD(c[HK_CELL_M]) * w3);
  t->a = (place){FMA(f, d.x, FMA(-w5, Sd.x, t->a.x)), FMA(f, d.y, FMA(-w5, Sd.y, t->a.y)),
                 FMA(f, d.z, FMA(-w5, Sd.z, t->a.z))};
}

TARGET static void pull_of_cells(const double (*cell)[HK_CELL_NUMBERS], const uint32_t *which, size_t count,
                                 const hk_targets *t, double eps2, hk_pull *sum) {
  const vector soft = SPREAD(eps2);
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += TOGETHER * LANES) {
    for (size_t k = 0; k < count;) {
      lane_sums one = no_sums(t, at), two = no_sums(t, at + LANES);
      for (size_t until = count - k < SPAN ? count : k + SPAN; k < until; k++) {
        pull_cell(&one, cell[which[k]], soft);
        pull_cell(&two, cell[which[k]], soft);
      }
      add_sums(sum, &one, at);
      add_sums(sum, &two, at + LANES);
    }
  }
}

INLINE vector potential_of_cell(const place *p, const double *c, vector soft) {
  place d = from_to(p, c[HK_CELL_X], c[HK_CELL_Y], c[HK_CELL_Z]), Sd = moments_times(c, &d);
  vector w = root(square(&d, soft)), w2 = w * w;
  vector dSd = FMA(Sd.x, d.x, FMA(Sd.y, d.y, Sd.z * d.z));
  vector second = FMA(SPREAD(0.5) * dSd, w2, SPREAD(-c[HK_CELL_TRACE] / 3));
  return FMA(second, w2 * w, SPREAD(c[HK_CELL_M]) * w);
}

TARGET static void potential_of_cells(const double (*cell)[HK_CELL_NUMBERS], const uint32_t *which, size_t count,
                                      const hk_targets *t, double eps2, double *sum) {
  const vector soft = SPREAD(eps2);
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += LANES) {
    const place p = place_of(t, at);
    vector total = LOAD(sum + at);
    for (size_t k = 0; k < count; k++) total += potential_of_cell(&p, cell[which[k]], soft);
    STORE(sum + at, total);
  }
}

#define PATH(title)                                                                                                    \
  { title, pull, scalar, pull_of_cells, potential_of_cells }
