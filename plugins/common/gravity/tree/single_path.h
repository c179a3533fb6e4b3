/* The inner loops of the tree in single precision, for errors far above its roundings. Places are the sum of two
 * floats, which together have 48 bits of the scaled place, so that a difference of places is right to 6e-8 of itself
 * and 2e-15 of the extent of all bodies; sums of some dozens of terms are added up in double precision. A source closer
 * than HK_SINGLE_NEAR, where that is not enough, is counted. Masses are multiplied by a power of two that brings their
 * sum near 1. */
#ifndef HK_SINGLE_PATH_H
#define HK_SINGLE_PATH_H

#include "plugins/common/gravity/gravity_path.h"

enum {
  HK_SINGLE_TARGETS = 256, /* at most */
  HK_SINGLE_BODY = 8,      /* floats of a source: x, y, z, the rest of x, y, z, the mass, 0 */
  HK_SINGLE_CELL = 16,     /* those of a cell: as a source, then its trace and S, as in HK_CELL_S, and 0 */
  HK_SINGLE_M = 6,
  HK_SINGLE_TRACE,
  HK_SINGLE_S
};
/* Scaled distance below which, where the softening is less as well, differences of places lose digits: 2e-15 of 1e-9 is
 * 2e-6. */
#define HK_SINGLE_NEAR 1e-9

typedef struct hk_single_targets {
  size_t count;
  float at[6][HK_SINGLE_TARGETS]; /* as of a source; those beyond `count` repeat the first one */
  double a[3][HK_SINGLE_TARGETS]; /* sums of m d/s^3, to which calls add */
  int32_t
      near[HK_SINGLE_TARGETS]; /* sources closer than HK_SINGLE_NEAR, of a smaller softening; the body itself is one */
} hk_single_targets;

typedef struct hk_single_path {
  /* Of the sources [0, count). eps2: scaled square of the softening. */
  void (*pull)(const float (*source)[HK_SINGLE_BODY], size_t count, double eps2, hk_single_targets *);
  /* Of the cells `which`, with their quadrupoles, which no target is inside of. */
  void (*pull_of_cells)(const float (*cell)[HK_SINGLE_CELL], const uint32_t *which, size_t count, double eps2,
                        hk_single_targets *);
} hk_single_path;

/* For hk_host.lanes; NULL: two lanes of doubles are as fast. */
const hk_single_path *hk_single_path_of(int lanes);

static inline void hk_single_place(float *into, const double place[3]) {
  for (int c = 0; c < 3; c++) {
    into[c] = (float)place[c];
    into[3 + c] = (float)(place[c] - (double)into[c]);
  }
}

#endif
