/* Forces of damped springs, many at a time. With d = x_j - x_i, l = |d|, u = v_j - v_i, each spring has the scale
 *     s = k (1 - L/l) + c (u.d)/l^2,      i gets the force s d and j gets -s d.
 * At l = 0 both are zero (the threshold is HK_SPRING_TINY in spring_path.h); a spring with L = 0 is smooth there.
 *
 * The layout is made once per topology. Particles are divided into ranges, by index or, where joined particles have
 * distant indices (shuffled ids), by hk_particle_order. A group contains the springs between two ranges, and groups are
 * put into rounds so that no two of a round share a range: the groups of a round can run on several threads without
 * conflicts. The number of ranges depends on the number of springs only and sums have a fixed order, so results do not
 * depend on the number of threads. Inside a group, runs of springs (i+t, j+t) are found, whose particles are read and
 * written as contiguous vectors; the other springs are sorted by blocks of particles, so that their data are in the
 * cache. The loops over springs and the width of vectors are in spring_path.h. */
#ifndef HK_SPRING_KERNEL_H
#define HK_SPRING_KERNEL_H

#include "core/plugin.h"

typedef enum hk_spring_kind {
  HK_SPRING_RUN,   /* (i+t, j+t), t = 0, 1, ... */
  HK_SPRING_LIST,  /* any pairs without the last particle (vector loads reach one number beyond a particle) */
  HK_SPRING_SINGLE /* any pairs, one at a time */
} hk_spring_kind;

typedef struct hk_spring_run {
  hk_spring_kind kind;
  size_t begin, count; /* springs of the layout */
} hk_spring_run;

typedef struct hk_spring_layout {
  size_t count;
  uint32_t (*pair)[2];         /* count, in the layout's order */
  double *k, *c, *L;           /* one number when common; otherwise count numbers, in the layout's order */
  bool each_k, each_c, each_L; /* the coefficient differs from spring to spring */
  bool damped;                 /* some c > 0 */
  size_t runs, groups, rounds;
  hk_spring_run *run;
  size_t *group;       /* groups + 1: runs of a group */
  size_t *round;       /* rounds + 1: groups of a round */
  double *group_power; /* groups, W */
} hk_spring_layout;

/* From edges and coefficients (common or one per edge), in the host's memory. Springs with an end where `is_active` is
 * false are omitted (NULL: all particles are active). After HK_NO_MEMORY the layout can only be freed. */
hk_status hk_spring_layout_build(hk_spring_layout *, const hk_host *host, size_t n, const hk_tuples *edges,
                                 const hk_per_tuple *k, const hk_per_tuple *c, const hk_per_tuple *L,
                                 const bool *is_active);
void hk_spring_layout_free(hk_spring_layout *, const hk_host *host);

/* F += the forces; *power += the power of the damping, -sum c (u.d)^2/l^2, when `power` is not NULL. */
void hk_spring_forces(const hk_spring_layout *, const hk_host *host, const double *x, const double *v, double *F,
                      double *power);

#endif
