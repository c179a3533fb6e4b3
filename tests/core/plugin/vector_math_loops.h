/* The loop of vector_math.c for vectors of LANES numbers (core/plugin/each_width.h): out[i] = FMA(a[i], b[i], c[i]) of
 * the first LANES numbers, and how many those are. */

TARGET static size_t NAME(fused)(const HK_REAL *a, const HK_REAL *b, const HK_REAL *c, HK_REAL *out) {
  *(VECTOR *)out = FMA(*(const VECTOR *)a, *(const VECTOR *)b, *(const VECTOR *)c);
  for (size_t i = 0; i < LANES; i++)
    if (FMA_ONE(a[i], b[i], c[i]) != out[i]) return 0;
  return LANES;
}
