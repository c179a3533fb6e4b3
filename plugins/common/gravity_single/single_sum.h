/* Gravitation by the sum over all pairs in 32-bit arithmetic. Places are taken relative to their mean and held in two
 * floats each, masses relative to a power of two near the largest. Pairs within a block of 32 targets are summed in
 * doubles, which costs little and leaves out the body itself; all others in floats. Where a source is so near that two
 * floats do not hold the distance well, or at the very place, or a sum is not finite, the targets are summed in doubles
 * altogether, and where masses are beyond the range of floats, all are: the error is that of floats wherever the bodies
 * are, and only the time depends on it.
 *
 * Each target's sum has the order of the sources, so it has the same bits for any number of threads. They differ
 * between paths by the rounding of floats. */
#ifndef HK_SINGLE_SUM_H
#define HK_SINGLE_SUM_H

#include "plugins/common/gravity/direct_sum.h"
#include "plugins/common/gravity_single/single_path.h"

typedef struct hk_single_sum {
  const hk_host *host;
  const hk_single_path *path;
  size_t room;
  hk_single_body *body; /* of the bodies gathered: scaled, relative to their mean; masses in units of `unit` */
  double unit;          /* kg, a power of two */
  bool fits;            /* masses are within the range of floats */
} hk_single_sum;

/* Memory for n bodies. HK_NO_MEMORY, without a message. */
hk_status hk_single_reserve(hk_single_sum *, const hk_host *, size_t n);
void hk_single_release(hk_single_sum *);

/* As hk_direct_forces, of the bodies gathered there. */
bool hk_single_forces(hk_single_sum *, hk_gravity_bodies *, double G, double *F);
/* Its errors, of four bodies in each of so many blocks evenly spaced. v: n x 3, of the particles. */
void hk_single_errors(hk_single_sum *, hk_gravity_bodies *, double G, const double *v, hk_force_errors *);

#endif
