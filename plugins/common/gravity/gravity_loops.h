/* The loops of gravity_path.c for vectors of LANES targets (core/plugin/each_width.h). */

typedef struct PLACE {
  VECTOR x, y, z;
} PLACE;

TARGET HK_INLINE PLACE NAME(place_of)(const hk_targets *t, size_t at) {
  return (PLACE){LOAD(t->x[0] + at), LOAD(t->x[1] + at), LOAD(t->x[2] + at)};
}

TARGET HK_INLINE PLACE NAME(from_to)(const PLACE *p, double x, double y, double z) {
  return (PLACE){FILL(x) - p->x, FILL(y) - p->y, FILL(z) - p->z};
}

TARGET HK_INLINE VECTOR NAME(square)(const PLACE *d, VECTOR soft) {
  return FMA(d->x, d->x, FMA(d->y, d->y, FMA(d->z, d->z, soft)));
}

/* 1/s. What the series leaves out of the estimate's error e is its first term, 63/256 e^5 = 6e-17 of four floats' |e|
 * <= 7.4e-4, and 35/128 e^4 = 7e-17 of 14 bits, |e| <= 1.3e-4. */
TARGET HK_INLINE VECTOR NAME(root)(VECTOR s2) {
#if WIDTH == 2
  return 1 / ROOT(s2);
#else
  VECTOR y = ROOT_ESTIMATE(s2), e = FMA(-(s2 * y), y, FILL(1));
  VECTOR series =
      FMA(e, FMA(e, WIDTH == 4 ? FMA(e, FILL(0.2734375), FILL(0.3125)) : FILL(0.3125), FILL(0.375)), FILL(0.5));
  return FMA(y * e, series, y);
#endif
}

/* 1/s, and 0 at distance 0: what `root` makes of 0, infinity or NaN, loses all its bits. */
TARGET HK_INLINE VECTOR NAME(root_apart)(VECTOR s2) { return (VECTOR)((MASK)(s2 > 0) & (MASK)NAME(root)(s2)); }

/* One vector of targets and its sums. */
typedef struct SUMS {
  PLACE at, a;
  MASK zeros;
} SUMS;

TARGET HK_INLINE void NAME(pull_one)(SUMS *t, const hk_bodies *s, size_t j, VECTOR soft, const bool bare) {
  PLACE d = NAME(from_to)(&t->at, s->x[j], s->y[j], s->z[j]);
  VECTOR s2 = NAME(square)(&d, soft), w;
  if (bare) t->zeros -= (MASK)(s2 == 0); /* true is -1 */
  w = bare ? NAME(root_apart)(s2) : NAME(root)(s2);
  VECTOR f = (FILL(s->m[j]) * w) * (w * w);
  t->a = (PLACE){FMA(f, d.x, t->a.x), FMA(f, d.y, t->a.y), FMA(f, d.z, t->a.z)};
}

TARGET HK_INLINE SUMS NAME(no_sums)(const hk_targets *t, size_t l) { return (SUMS){.at = NAME(place_of)(t, l)}; }

TARGET HK_INLINE void NAME(add_sums)(hk_pull *sum, const SUMS *t, size_t l) {
  STORE(sum->a[0] + l, LOAD(sum->a[0] + l) + t->a.x);
  STORE(sum->a[1] + l, LOAD(sum->a[1] + l) + t->a.y);
  STORE(sum->a[2] + l, LOAD(sum->a[2] + l) + t->a.z);
  *(MASK *)(sum->zeros + l) += t->zeros;
}

TARGET HK_INLINE void NAME(pull_at)(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2,
                                    hk_pull *sum, size_t at, const bool bare) {
  const VECTOR soft = FILL(eps2);
  for (size_t j = begin; j < end;) {
    SUMS one = NAME(no_sums)(t, at), two = NAME(no_sums)(t, at + LANES);
    for (size_t until = end - j < SPAN ? end : j + SPAN; j < until; j++) {
      NAME(pull_one)(&one, s, j, soft, bare);
      NAME(pull_one)(&two, s, j, soft, bare);
    }
    NAME(add_sums)(sum, &one, at);
    NAME(add_sums)(sum, &two, at + LANES);
  }
}

TARGET static void NAME(pull)(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2,
                              hk_pull *sum) {
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += TOGETHER * LANES)
    if (eps2 > 0)
      NAME(pull_at)(s, begin, end, t, eps2, sum, at, false);
    else
      NAME(pull_at)(s, begin, end, t, 0, sum, at, true);
}

TARGET HK_INLINE void NAME(scalar_at)(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2,
                                      double *sum, size_t at, const int power) {
  const PLACE p = NAME(place_of)(t, at);
  const VECTOR soft = FILL(eps2);
  for (size_t j = begin; j < end;) {
    VECTOR total = {0};
    for (size_t until = end - j < SPAN ? end : j + SPAN; j < until; j++) {
      PLACE d = NAME(from_to)(&p, s->x[j], s->y[j], s->z[j]);
      VECTOR s2 = NAME(square)(&d, soft), w = NAME(root_apart)(s2);
      if (power == 3)
        total = FMA(FILL(s->m[j]) * w, w * w, total);
      else
        total = FMA(FILL(s->m[j]), w, total);
    }
    STORE(sum + at, LOAD(sum + at) + total);
  }
}

TARGET static void NAME(scalar)(const hk_bodies *s, size_t begin, size_t end, const hk_targets *t, double eps2,
                                int power, double *sum) {
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += LANES)
    if (power == 3)
      NAME(scalar_at)(s, begin, end, t, eps2, sum, at, 3);
    else
      NAME(scalar_at)(s, begin, end, t, eps2, sum, at, 1);
}

/* S d of a cell. */
TARGET HK_INLINE PLACE NAME(moments_times)(const double *c, const PLACE *d) {
  const double *S = c + HK_CELL_S;
  return (PLACE){FMA(FILL(S[0]), d->x, FMA(FILL(S[1]), d->y, FILL(S[2]) * d->z)),
                 FMA(FILL(S[1]), d->x, FMA(FILL(S[3]), d->y, FILL(S[4]) * d->z)),
                 FMA(FILL(S[2]), d->x, FMA(FILL(S[4]), d->y, FILL(S[5]) * d->z))};
}

/* With d from the target to the cell, S and trace as in HK_CELL_S:
 *     a = M d/s^3 + (5/2 d.Sd/s^7 - trace/s^5) d - Sd/s^5,      potential M/s + (d.Sd/s^5)/2 - trace/(3 s^3):
 * 1/s to second order about the centre of mass, where the first order vanishes. The softening is in s, so that the
 * trace stays. */
TARGET HK_INLINE void NAME(pull_cell)(SUMS *t, const double *c, VECTOR soft) {
  PLACE d = NAME(from_to)(&t->at, c[HK_CELL_X], c[HK_CELL_Y], c[HK_CELL_Z]), Sd = NAME(moments_times)(c, &d);
  VECTOR w = NAME(root)(NAME(square)(&d, soft)), w2 = w * w, w3 = w2 * w, w5 = w3 * w2;
  VECTOR dSd = FMA(Sd.x, d.x, FMA(Sd.y, d.y, Sd.z * d.z));
  VECTOR f = FMA(w5, FMA(FILL(2.5) * dSd, w2, FILL(-c[HK_CELL_TRACE])), FILL(c[HK_CELL_M]) * w3);
  t->a = (PLACE){FMA(f, d.x, FMA(-w5, Sd.x, t->a.x)), FMA(f, d.y, FMA(-w5, Sd.y, t->a.y)),
                 FMA(f, d.z, FMA(-w5, Sd.z, t->a.z))};
}

TARGET static void NAME(pull_of_cells)(const double (*cell)[HK_CELL_NUMBERS], const uint32_t *which, size_t count,
                                       const hk_targets *t, double eps2, hk_pull *sum) {
  const VECTOR soft = FILL(eps2);
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += TOGETHER * LANES) {
    for (size_t k = 0; k < count;) {
      SUMS one = NAME(no_sums)(t, at), two = NAME(no_sums)(t, at + LANES);
      for (size_t until = count - k < SPAN ? count : k + SPAN; k < until; k++) {
        NAME(pull_cell)(&one, cell[which[k]], soft);
        NAME(pull_cell)(&two, cell[which[k]], soft);
      }
      NAME(add_sums)(sum, &one, at);
      NAME(add_sums)(sum, &two, at + LANES);
    }
  }
}

TARGET HK_INLINE VECTOR NAME(potential_of_cell)(const PLACE *p, const double *c, VECTOR soft) {
  PLACE d = NAME(from_to)(p, c[HK_CELL_X], c[HK_CELL_Y], c[HK_CELL_Z]), Sd = NAME(moments_times)(c, &d);
  VECTOR w = NAME(root)(NAME(square)(&d, soft)), w2 = w * w;
  VECTOR dSd = FMA(Sd.x, d.x, FMA(Sd.y, d.y, Sd.z * d.z));
  VECTOR second = FMA(FILL(0.5) * dSd, w2, FILL(-c[HK_CELL_TRACE] / 3));
  return FMA(second, w2 * w, FILL(c[HK_CELL_M]) * w);
}

TARGET static void NAME(potential_of_cells)(const double (*cell)[HK_CELL_NUMBERS], const uint32_t *which, size_t count,
                                            const hk_targets *t, double eps2, double *sum) {
  const VECTOR soft = FILL(eps2);
  for (size_t at = 0; at < HK_GRAVITY_BLOCK; at += LANES) {
    const PLACE p = NAME(place_of)(t, at);
    VECTOR total = LOAD(sum + at);
    for (size_t k = 0; k < count; k++) total += NAME(potential_of_cell)(&p, cell[which[k]], soft);
    STORE(sum + at, total);
  }
}

static const hk_gravity_path NAME(path)[] = {{WIDTH == 8   ? "AVX-512"
                                              : WIDTH == 4 ? "AVX2"
                                                           : "vectors of two",
                                              NAME(pull), NAME(scalar), NAME(pull_of_cells), NAME(potential_of_cells)}};
