/* The loop of scaled_sums.h for vectors of LANES numbers (core/plugin/each_width.h). Particles are taken EIGHT at a
 * time, and each of their numbers has a sum of its own for the power: a single sum would make additions wait for each
 * other, and with sums of a vector the result would depend on its width. */

TARGET HK_INLINE void NAME(hk_scaled_rows)(const hk_scaled *s, const double *u, size_t i, VECTOR power[3], double *F,
                                           const bool common) {
  const VECTOR by = *(const VECTOR *)(s->by + i);
  for (size_t r = 0; r < 3; r++) {
    VECTOR *sum = (VECTOR *)(F + 3 * i + LANES * r);
    const VECTOR v = *(const VECTOR *)(u + (common ? 0 : 3 * i) + LANES * r);
    const VECTOR f = (s->each + s->times * SPREAD(by, r)) * v;
    *sum += f;
    if (!common) power[r] += f * v;
  }
}

TARGET HK_INLINE double NAME(hk_scaled_each)(const hk_scaled *s, const double *u, size_t begin, size_t end, double *F,
                                             const bool common) {
  VECTOR power[3 * HK_SCALED_EIGHT / LANES] = {{0}};
  double of[3 * HK_SCALED_EIGHT], sum = 0;
  for (size_t i = begin; i < end; i += HK_SCALED_EIGHT)
    for (size_t b = 0; b < HK_SCALED_EIGHT; b += LANES)
      NAME(hk_scaled_rows)(s, u, i + b, power + 3 * b / LANES, F, common);
  memcpy(of, power, sizeof of);
  for (size_t l = 0; !common && l < 3 * HK_SCALED_EIGHT; l++) sum += of[l];
  return sum;
}

/* The number of particles is a multiple of EIGHT; pattern: the common vector over and over. */
TARGET static inline double NAME(hk_scaled_eights)(const hk_scaled *s, const double *pattern, size_t begin, size_t end,
                                                   double *F) {
  return s->u ? NAME(hk_scaled_each)(s, s->u, begin, end, F, false)
              : NAME(hk_scaled_each)(s, pattern, begin, end, F, true);
}
