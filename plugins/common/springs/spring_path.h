/* The inner loops of spring_kernel, with vectors of two, four and eight doubles. All do the same operations in the same
 * order, so results are bitwise equal. Squared lengths below HK_SPRING_TINY (distances below
 * 1e-145 m) count as zero, since their reciprocal exceeds the range of doubles. */
#ifndef HK_SPRING_PATH_H
#define HK_SPRING_PATH_H

#include "plugins/common/springs/spring_slices.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HK_SPRING_TINY 1e-290 /* m^2 */

/* Ends HK_SPRING_FAR particles apart are far: what is added to one end has been stored when it is read as the other.
 * (Measured: from 16 on as fast as any, 12 a quarter slower.) */
enum { HK_SPRING_LANES = 4, HK_SPRING_WIDEST = 8, HK_SPRING_BLOCK = 256, HK_SPRING_FAR = 16 };

/* `k + (e & each_k)` points to the coefficients of spring e and those that follow; `each` is 0 for a common coefficient
 * (HK_SPRING_WIDEST equal numbers), otherwise it has all bits set. */
typedef struct hk_spring_numbers {
  const double *k, *c, *L;
  size_t each_k, each_c, each_L;
} hk_spring_numbers;

/* Has the coefficients of springs read that are HK_SPRING_AHEAD after spring e: the processor does not foresee by
 * itself where a path goes on in several lists, page by page. Distances of 64 to 512 springs are equally good. */
enum { HK_SPRING_AHEAD = 128 };
static inline __attribute__((always_inline)) void hk_spring_fetch(const hk_spring_numbers *q, size_t e) {
  e += HK_SPRING_AHEAD;
  __builtin_prefetch(q->k + (e & q->each_k));
  __builtin_prefetch(q->c + (e & q->each_c));
  __builtin_prefetch(q->L + (e & q->each_L));
}

/* Each function adds the forces of n springs to F and returns the sum of c w^2/l^2, W, in which springs e, e + 4, e + 8
 * ... of a run are summed first. n is a multiple of HK_SPRING_LANES. */
typedef struct hk_spring_path {
  /* The springs (i+t, j+t): x, v and F point to the first particle of each end, which are HK_SPRING_FAR or more apart.
   */
  double (*far_run)(const hk_spring_numbers *, size_t n, const double *xi, const double *xj, const double *vi,
                    const double *vj, double *Fi, double *Fj, bool damped);
  /* The same for ends that are nearer; n: at most HK_SPRING_BLOCK. */
  double (*near_run)(const hk_spring_numbers *, size_t n, const double *xi, const double *xj, const double *vi,
                     const double *vj, double *Fi, double *Fj, bool damped);
  /* Slices of pairs without the last particle: one number beyond a particle may be read. In the sum those of the
   * bundles r = 0 to 7 are summed first, then, as s, ((s0 + s4) + (s1 + s5)) + ((s2 + s6) + (s3 + s7)). */
  double (*list)(const hk_spring_numbers *, const hk_spring_list *, const double *x, const double *v, double *F,
                 bool damped);
} hk_spring_path;

extern const hk_spring_path hk_spring_narrow; /* for every processor */
const hk_spring_path *hk_spring_wide(void);   /* NULL where this processor has no vectors of four doubles */
const hk_spring_path *hk_spring_wide8(void);  /* the same for eight */

#endif
