/* The loop of step_in_tile.c that divides by the masses, for vectors of LANES numbers (core/plugin/each_width.h): the
 * particles begin to end - 1, a multiple of EIGHT. What is not finite gives NaN when it is multiplied by 0. */

TARGET HK_INLINE void NAME(divide_rows)(const double *inverse, double *F, VECTOR bad[3]) {
  const VECTOR w = *(const VECTOR *)inverse;
  for (size_t r = 0; r < 3; r++) {
    VECTOR *a = (VECTOR *)(F + LANES * r);
    bad[r] += *a * 0;
    *a *= SPREAD(w, r);
  }
}

TARGET static bool NAME(divide_eights)(const double *inverse, double *F, size_t begin, size_t end) {
  VECTOR bad[3] = {{0}};
  double sum = 0;
  for (size_t i = begin; i < end; i += EIGHT)
    for (size_t b = i; b < i + EIGHT; b += LANES) NAME(divide_rows)(inverse + b, F + 3 * b, bad);
  for (size_t r = 0; r < 3; r++)
    for (size_t l = 0; l < LANES; l++) sum += bad[r][l];
  return sum == 0;
}
