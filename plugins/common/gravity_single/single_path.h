/* The inner loops of gravitation in 32-bit arithmetic, by the instruction sets of processors, as gravity_path.h has
 * them for doubles: each file single_*.c has the loops of single_loops.h compiled for one of them.
 *
 * A coordinate is the sum of two floats, high and low, with 48 bits together: the difference of the high parts of two
 * bodies near each other is exact (Sterbenz 1974), and with that of the low parts the distance keeps its digits. An
 * interaction has a dozen roundings of 2^-24; they are summed in floats over a span of sources, and spans in doubles.
 * Estimates of roots differ between makes of processors, so results do by the rounding of floats. */
#ifndef HK_SINGLE_PATH_H
#define HK_SINGLE_PATH_H

#include <stdbool.h>
#include <stddef.h>

enum { HK_SINGLE_BLOCK = 32 }; /* targets */

/* A body that attracts, read as a whole. */
typedef struct hk_single_body {
  float high[3], low[3], m, unused; /* 32 bytes, so that none straddles a line of the cache */
} hk_single_body;

typedef struct hk_single_targets {
  float high[3][HK_SINGLE_BLOCK], low[3][HK_SINGLE_BLOCK];
} hk_single_targets;

/* Sums over the sources, to which calls add. */
typedef struct hk_single_pull {
  double a[3][HK_SINGLE_BLOCK];   /* sum m d/s^3 */
  float nearest[HK_SINGLE_BLOCK]; /* least s^2 */
} hk_single_pull;

typedef struct hk_single_path {
  const char *name;
  /* eps2: square of the softening. Where s is 0, sums are not finite or NaN, and `nearest` is 0. */
  void (*pull)(const hk_single_body *, size_t begin, size_t end, const hk_single_targets *, float eps2,
               hk_single_pull *);
} hk_single_path;

extern const hk_single_path hk_single_narrow; /* for every processor */
const hk_single_path *hk_single_wide8(void);  /* NULL where this processor has no AVX2 and FMA */
const hk_single_path *hk_single_wide16(void); /* NULL where it has no AVX-512 */
const hk_single_path *hk_single_best(void);

#endif
