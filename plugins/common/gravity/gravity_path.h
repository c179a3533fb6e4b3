/* The inner loops of gravitation, by the width of vectors. Targets come in blocks, in the lanes of vectors, and all of
 * a block meet the same sources, one after the other; so the sum of a target has the order of the sources, wherever the
 * target stands in its block and however blocks are given to threads.
 *
 * With d = x_j - x_i, s^2 = d^2 + softening^2. The reciprocal 1/s is an estimate of the processor, improved by one step
 * of Householder's method, y (1 + e/2 + 3/8 e^2 + ...), e = 1 - s^2 y^2, as far as the estimate's error requires: it is
 * right to about 1e-16. Estimates differ between makes of processors, so results do by rounding. */
#ifndef HK_GRAVITY_PATH_H
#define HK_GRAVITY_PATH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_GRAVITY_BLOCK = 16 /* targets */, HK_GRAVITY_TILE = 64 /* bodies that pull each other; whole blocks */ };

/* Bodies, or cells as point masses, one coordinate after the other. */
typedef struct hk_bodies {
  double *x, *y, *z, *m;
} hk_bodies;

/* A cell about its centre of mass; S: second moments 3 sum m r_a r_b (xx, xy, xz, yy, yz, zz), and their trace
 * 1.5 sum m r^2. */
enum { HK_CELL_X, HK_CELL_Y, HK_CELL_Z, HK_CELL_M, HK_CELL_S, HK_CELL_TRACE = HK_CELL_S + 6, HK_CELL_NUMBERS };

/* A block of targets. */
typedef struct hk_targets {
  double x[3][HK_GRAVITY_BLOCK];
} hk_targets;

/* Sums over the sources, to which calls add. */
typedef struct hk_pull {
  double a[3][HK_GRAVITY_BLOCK];   /* sum m d/s^3 */
  int64_t zeros[HK_GRAVITY_BLOCK]; /* of softening 0: number of sources at the very place of the target, which are left
                                      out */
} hk_pull;

typedef struct hk_gravity_path {
  const char *name;
  /* eps2: square of the softening, m^2. */
  void (*pull)(const hk_bodies *, size_t begin, size_t end, const hk_targets *, double eps2, hk_pull *);
  /* Bodies from one[0] to one[1] - 1 and from two[0] to two[1] - 1 pull each other, or, where these are the same, among
   * themselves, each pair once: a[c][k] += sum m d/s^3 of body k. Whole blocks, two of them HK_GRAVITY_TILE at most. Of
   * softening 0, a sum is not finite where a body is at the place of another one. */
  void (*mutual)(const hk_bodies *, const size_t one[2], const size_t two[2], double eps2, double *const a[3]);
  /* sum += sum of m/s^power, power 1 (the potential) or 3 (a bound of the stiffness). Of softening 0, sources at the
   * place of the target are left out. */
  void (*scalar)(const hk_bodies *, size_t begin, size_t end, const hk_targets *, double eps2, int power, double *sum);
  /* The same of the cells `which`, with their quadrupoles, which no target is inside of. */
  void (*pull_of_cells)(const double (*cell)[HK_CELL_NUMBERS], const uint32_t *which, size_t count, const hk_targets *,
                        double eps2, hk_pull *);
  void (*potential_of_cells)(const double (*cell)[HK_CELL_NUMBERS], const uint32_t *which, size_t count,
                             const hk_targets *, double eps2, double *sum);
} hk_gravity_path;

/* For hk_host.lanes. */
const hk_gravity_path *hk_gravity_path_of(int lanes);

#endif
