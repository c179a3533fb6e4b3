/* The loops of single_path.c for vectors of LANES targets (core/plugin/each_width.h). */

#if WIDTH == 2
static const hk_single_path NAME(path)[] = {{0}};
#else

/* One vector of targets and its sums. */
typedef struct SUMS {
  VECTOR at[6], a[3];
  MASK near;
} SUMS;

TARGET HK_INLINE SUMS NAME(open_sums)(const hk_single_targets *t, size_t at) {
  SUMS s = {0};
  for (int c = 0; c < 6; c++) s.at[c] = LOAD(t->at[c] + at);
  return s;
}

TARGET HK_INLINE void NAME(close_sums)(const SUMS *s, hk_single_targets *t, size_t at) {
  for (size_t l = 0; l < LANES; l++) {
    for (int c = 0; c < 3; c++) t->a[c][at + l] += (double)s->a[c][l];
    t->near[at + l] += s->near[l];
  }
}

/* 1/s: what the series leaves out of the estimate's error e is 5/16 e^3 = 1e-10 of |e| <= 7.4e-4, and 3/8 e^2 = 6e-9 of
 * 1.3e-4. */
TARGET HK_INLINE VECTOR NAME(root)(VECTOR s2) {
  VECTOR y = ROOT_ESTIMATE(s2), e = FMA(-(s2 * y), y, FILL(1.0f));
  return FMA(y * e, WIDTH == 4 ? FMA(e, FILL(0.375f), FILL(0.5f)) : FILL(0.5f), y);
}

TARGET HK_INLINE VECTOR NAME(square)(const SUMS *t, const float *source, VECTOR soft, VECTOR *d) {
  for (int c = 0; c < 3; c++) d[c] = (FILL(source[c]) - t->at[c]) + (FILL(source[3 + c]) - t->at[3 + c]);
  return FMA(d[0], d[0], FMA(d[1], d[1], FMA(d[2], d[2], soft)));
}

TARGET HK_INLINE void NAME(pull_one)(SUMS *t, const float *source, VECTOR soft, const bool bare) {
  VECTOR d[3], s2 = NAME(square)(t, source, soft, d), w = NAME(root)(s2);
  if (bare) { /* what the root makes of 0 loses all its bits */
    w = (VECTOR)((MASK)(s2 > 0) & (MASK)w);
    t->near -= (MASK)(s2 < FILL((float)(HK_SINGLE_NEAR * HK_SINGLE_NEAR))); /* true is -1 */
  }
  VECTOR f = (FILL(source[HK_SINGLE_M]) * w) * (w * w);
  for (int c = 0; c < 3; c++) t->a[c] = FMA(f, d[c], t->a[c]);
}

/* As pull_cell of gravity_loops.h. */
TARGET HK_INLINE void NAME(pull_cell)(SUMS *t, const float *cell, VECTOR soft) {
  const float *S = cell + HK_SINGLE_S;
  VECTOR d[3], w = NAME(root)(NAME(square)(t, cell, soft, d)), w2 = w * w, w3 = w2 * w, w5 = w3 * w2;
  const VECTOR Sd[3] = {FMA(FILL(S[0]), d[0], FMA(FILL(S[1]), d[1], FILL(S[2]) * d[2])),
                        FMA(FILL(S[1]), d[0], FMA(FILL(S[3]), d[1], FILL(S[4]) * d[2])),
                        FMA(FILL(S[2]), d[0], FMA(FILL(S[4]), d[1], FILL(S[5]) * d[2]))};
  VECTOR dSd = FMA(Sd[0], d[0], FMA(Sd[1], d[1], Sd[2] * d[2]));
  VECTOR f = FMA(w5, FMA(FILL(2.5f) * dSd, w2, FILL(-cell[HK_SINGLE_TRACE])), FILL(cell[HK_SINGLE_M]) * w3);
  for (int c = 0; c < 3; c++) t->a[c] = FMA(f, d[c], FMA(-w5, Sd[c], t->a[c]));
}

TARGET HK_INLINE void NAME(pull_at)(const float (*source)[HK_SINGLE_BODY], size_t count, double eps2,
                                    hk_single_targets *t, size_t at, const bool bare) {
  const VECTOR soft = FILL((float)eps2);
  const bool two_vectors = at + LANES < t->count;
  for (size_t k = 0; k < count;) {
    size_t until = count - k < SPAN ? count : k + SPAN;
    SUMS one = NAME(open_sums)(t, at);
    if (two_vectors) {
      SUMS two = NAME(open_sums)(t, at + LANES);
      for (; k < until; k++) {
        NAME(pull_one)(&one, source[k], soft, bare);
        NAME(pull_one)(&two, source[k], soft, bare);
      }
      NAME(close_sums)(&two, t, at + LANES);
    } else {
      for (; k < until; k++) NAME(pull_one)(&one, source[k], soft, bare);
    }
    NAME(close_sums)(&one, t, at);
  }
}

TARGET static void NAME(pull)(const float (*source)[HK_SINGLE_BODY], size_t count, double eps2, hk_single_targets *t) {
  for (size_t at = 0; at < t->count; at += 2 * LANES)
    if (eps2 > HK_SINGLE_NEAR * HK_SINGLE_NEAR)
      NAME(pull_at)(source, count, eps2, t, at, false);
    else
      NAME(pull_at)(source, count, eps2, t, at, true);
}

TARGET static void NAME(pull_of_cells)(const float (*cell)[HK_SINGLE_CELL], const uint32_t *which, size_t count,
                                       double eps2, hk_single_targets *t) {
  const VECTOR soft = FILL((float)eps2);
  for (size_t at = 0; at < t->count; at += 2 * LANES) {
    const bool two_vectors = at + LANES < t->count;
    for (size_t k = 0; k < count;) {
      size_t until = count - k < SPAN ? count : k + SPAN;
      SUMS one = NAME(open_sums)(t, at);
      if (two_vectors) {
        SUMS two = NAME(open_sums)(t, at + LANES);
        for (; k < until; k++) {
          NAME(pull_cell)(&one, cell[which[k]], soft);
          NAME(pull_cell)(&two, cell[which[k]], soft);
        }
        NAME(close_sums)(&two, t, at + LANES);
      } else {
        for (; k < until; k++) NAME(pull_cell)(&one, cell[which[k]], soft);
      }
      NAME(close_sums)(&one, t, at);
    }
  }
}

static const hk_single_path NAME(path)[] = {{NAME(pull), NAME(pull_of_cells)}};
#endif
