/* The short steps of small components of stiff springs, many of one shape side by side: what a vector has in its lanes
 * is the same particle, or the same spring, of different components. So nothing is looked up in a short step, all of
 * them are done in the first-level cache, and no lane waits for another.
 *
 * Measured on Zen 5 with 970 springs at random in a sheet, four of five of them alone, and 18 short steps: 34 us a
 * step, where sums over lists of springs took 85. */
#ifndef HK_SHORT_LANES_H
#define HK_SHORT_LANES_H

#include "plugins/common/local/local_filter.h"
#include "plugins/common/local/stiff_edges.h"

enum {
  HK_SHORT_LANES = 16,    /* two vectors of eight or four of four: what the divider's delay leaves free is filled */
  HK_SHORT_PARTICLES = 8, /* of a small component, at most */
  HK_SHORT_SPRINGS = 12   /* the same */
};

typedef double hk_short_row[HK_SHORT_LANES];

/* How the springs of a component join its particles. */
typedef struct hk_short_shape {
  uint8_t n, springs, pair[HK_SHORT_SPRINGS][2];
} hk_short_shape;

/* Components of one shape. Lanes without one have particles of lane 0 without their springs, and are not written. */
typedef struct hk_short_batch {
  hk_short_shape shape;
  uint32_t filled;                   /* lanes */
  double stiffest;                   /* 1/s^2 */
  hk_local_rule rule;                /* for the step of the last call */
  uint32_t (*index)[HK_SHORT_LANES]; /* n: particles of the scene */
  hk_short_row *w, *k, *tension;     /* n, springs, springs: 1/kg; N/m; N, that of a spring of length 0, k L */
} hk_short_batch;

/* Zeroed before the first use; all memory is the instance's. */
typedef struct hk_short_lanes {
  size_t batches;
  hk_short_batch *batch;
  hk_short_row *rows; /* the numbers of all batches */
  uint32_t (*indices)[HK_SHORT_LANES];
  double h; /* s, for which the rules are made */
} hk_short_lanes;

/* Springs of one component have the same number in `root` (of particles; `count` of them are given), which has the
 * bound of its squared frequency in `bound`. */
hk_status hk_short_lanes_build(hk_short_lanes *, const hk_host *, const hk_model *, const hk_stiff_edges *,
                               const uint32_t *edge, size_t count, const uint32_t *root, const double *bound);
void hk_short_lanes_free(hk_short_lanes *, const hk_host *);

/* As hk_short_steps_take. */
void hk_short_lanes_take(hk_short_lanes *, const hk_host *, const double *x, double h, double *a, double *v);

#endif
