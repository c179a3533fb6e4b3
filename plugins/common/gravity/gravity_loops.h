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

/* ---- sums of pairs that pull each other ---- */

/* 1/s^3. With y the estimate of 1/s and e = 1 - s^2 y^2 it is y^3 (1 - e)^(-3/2), whose series is cut after e^4 of four
 * lanes and after e^3 of eight. Of the first term that is left out, c e^(p+2), the part c a^2 q e^p with a the largest
 * |e| is kept (q = 0.87 for p = 3, 0.83 for p = 2): 7e-17 and 9e-17 are missing, where it would be 6e-16. */
TARGET HK_INLINE VECTOR NAME(cube)(VECTOR s2) {
#if WIDTH == 2
  VECTOR w = 1 / ROOT(s2);
  return w * w * w;
#else
  VECTOR y = ROOT_ESTIMATE(s2), y2 = y * y, e = FMA(-s2, y2, FILL(1));
  VECTOR rest = WIDTH == 4 ? FMA(e, FMA(e, FILL(2.4609375), FILL(2.1875 + 1.262e-6)), FILL(1.875))
                           : FMA(e, FILL(2.1875), FILL(1.875 + 3.04e-8));
  VECTOR y3 = y * y2;
  return FMA(y3 * e, FMA(e, rest, FILL(1.5)), y3);
#endif
}

/* The bodies from `at` on, one in each lane, and those from begin to end - 1 pull each other: each pair has one root.
 * The sums of the latter are kept lane by lane, with the other sign. */
TARGET HK_INLINE void NAME(pull_both)(const hk_bodies *s, size_t at, size_t begin, size_t end, VECTOR soft,
                                      VECTOR (*back)[3], double *const a[3]) {
  const PLACE p = {LOAD(s->x + at), LOAD(s->y + at), LOAD(s->z + at)};
  const VECTOR m = LOAD(s->m + at);
  PLACE sum = {{0}, {0}, {0}};
  for (size_t j = begin; j < end; j++, back++) {
    PLACE d = NAME(from_to)(&p, s->x[j], s->y[j], s->z[j]);
    VECTOR f = NAME(cube)(NAME(square)(&d, soft)), g = FILL(s->m[j]) * f, h = m * f;
    sum = (PLACE){FMA(g, d.x, sum.x), FMA(g, d.y, sum.y), FMA(g, d.z, sum.z)};
    (*back)[0] = FMA(h, d.x, (*back)[0]);
    (*back)[1] = FMA(h, d.y, (*back)[1]);
    (*back)[2] = FMA(h, d.z, (*back)[2]);
  }
  STORE(a[0] + at, LOAD(a[0] + at) + sum.x);
  STORE(a[1] + at, LOAD(a[1] + at) + sum.y);
  STORE(a[2] + at, LOAD(a[2] + at) + sum.z);
}

/* The bodies of one vector among each other: NaN where softening is 0 and one is at the place of another. */
TARGET HK_INLINE void NAME(pull_within)(const hk_bodies *s, size_t at, VECTOR soft, bool bare, double *const a[3]) {
  SUMS t = {.at = {LOAD(s->x + at), LOAD(s->y + at), LOAD(s->z + at)}};
  for (size_t j = at; j < at + LANES; j++)
    if (bare)
      NAME(pull_one)(&t, s, j, soft, true);
    else
      NAME(pull_one)(&t, s, j, soft, false);
  MASK met = (MASK)(t.zeros != (int64_t)bare); /* itself is at its place */
  STORE(a[0] + at, LOAD(a[0] + at) + (VECTOR)((MASK)t.a.x | met));
  STORE(a[1] + at, LOAD(a[1] + at) + t.a.y);
  STORE(a[2] + at, LOAD(a[2] + at) + t.a.z);
}

TARGET static void NAME(mutual)(const hk_bodies *s, const size_t one[2], const size_t two[2], double eps2,
                                double *const a[3]) {
  const VECTOR soft = FILL(eps2);
  const bool same = one[0] == two[0];
  VECTOR back[HK_GRAVITY_TILE][3];
  for (size_t k = 0; k < two[1] - two[0]; k++) back[k][0] = back[k][1] = back[k][2] = FILL(0);
  for (size_t at = one[0]; at < one[1]; at += LANES) {
    size_t begin = same ? at + LANES : two[0];
    if (same) NAME(pull_within)(s, at, soft, !(eps2 > 0), a);
    NAME(pull_both)(s, at, begin, two[1], soft, back + (begin - two[0]), a);
  }
  for (size_t k = 0; k < two[1] - two[0]; k++)
    for (int c = 0; c < 3; c++) {
      double sum = 0;
      for (size_t l = 0; l < LANES; l++) sum += back[k][c][l];
      a[c][two[0] + k] -= sum;
    }
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
                                              NAME(pull), NAME(mutual), NAME(scalar), NAME(pull_of_cells),
                                              NAME(potential_of_cells)}};
