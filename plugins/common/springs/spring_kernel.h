/* Forces of damped springs, many at a time. With d = x_j - x_i, l = |d|, u = v_j - v_i, each spring has the scale
 *     s = k (1 - L/l) + c (u.d)/l^2,      i gets the force s d and j gets -s d.
 * At l = 0 both are zero (the threshold is HK_SPRING_TINY in spring_path.h); a spring with L = 0 is smooth there.
 *
 * The layout is made once per topology. Springs are sorted by the parts of a sum (core/plugin/parts.h), which run on
 * several threads without conflicts; sums have a fixed order, so results do not depend on the number of threads. Inside
 * a part, runs of springs (i+t, j+t) are found, whose particles are read and written as contiguous vectors and need no
 * indices; a few may be missing in one, so that the rows of a grid, or the strands of a hair, are one run. The other
 * springs are put into slices (spring_slices.h). The loops over springs and the width of vectors are
 * in spring_path.h. */
#ifndef HK_SPRING_KERNEL_H
#define HK_SPRING_KERNEL_H

#include "plugins/common/parts/part_lists.h"
#include "plugins/common/springs/spring_slices.h"

typedef enum hk_spring_kind {
  HK_SPRING_RUN,   /* (i+t, j+t), t = 0, 1, ..., but for a few t: as in a grid, whose rows follow each other */
  HK_SPRING_LIST,  /* slices of any pairs without the last particle (vector loads reach one number beyond a particle) */
  HK_SPRING_SINGLE /* any pairs, one at a time */
} hk_spring_kind;

typedef struct hk_spring_run {
  hk_spring_kind kind;
  uint32_t i, j;        /* of a run: its first pair */
  size_t begin, count;  /* springs of the layout */
  size_t place, places; /* their coefficients; a run has places for springs that are missing in it as well */
  size_t bits;          /* of a run: position in `present` */
  size_t pair, lanes;   /* of the others: position of the first one in `pair`, of a list in `lanes` */
} hk_spring_run;

typedef struct hk_spring_layout {
  size_t count, places;
  uint32_t (*pair)[2];         /* of the springs in no run */
  uint8_t *lanes;              /* see hk_spring_list */
  uint8_t *present;            /* a bit for each place of a run, the lowest of a byte first; a run begins with a byte */
  double *k, *c, *L;           /* one number when all are equal; otherwise one for each place */
  bool each_k, each_c, each_L; /* the coefficient differs from spring to spring */
  bool damped;                 /* some c > 0 */
  hk_partition partition;
  size_t runs;
  hk_spring_run *run;
  size_t *part;  /* partition.parts + 1: runs of a part */
  double *power; /* partition.parts, W, of hk_spring_forces */
} hk_spring_layout;

/* The ends of the spring at place t of a run; false: there is none. */
static inline bool hk_spring_ends(const hk_spring_layout *s, const hk_spring_run *run, size_t t, uint32_t end[2]) {
  bool listed = run->kind != HK_SPRING_RUN;
  end[0] = listed ? s->pair[run->pair + t][0] : run->i + (uint32_t)t;
  end[1] = listed ? s->pair[run->pair + t][1] : run->j + (uint32_t)t;
  return listed || s->present[run->bits + t / 8] >> t % 8 & 1;
}

/* From edges and coefficients (common or one per edge), in the host's memory. Springs with an end where `is_active` is
 * false are omitted (NULL: all particles are active). After HK_NO_MEMORY the layout can only be freed. */
hk_status hk_spring_layout_build(hk_spring_layout *, const hk_host *host, const hk_partition *, const hk_tuples *edges,
                                 const hk_per_tuple *k, const hk_per_tuple *c, const hk_per_tuple *L,
                                 const bool *is_active);
void hk_spring_layout_free(hk_spring_layout *, const hk_host *host);
void hk_spring_layout_touch(const hk_spring_layout *, const hk_part_use *use); /* what hk_force.parts has to do */

/* F += the forces; *power += the power of the damping, -sum c (u.d)^2/l^2, when `power` is not NULL. */
void hk_spring_forces(const hk_spring_layout *, const hk_host *host, const double *x, const double *v, double *F,
                      double *power);
/* The same of one part. */
void hk_spring_part(const hk_spring_layout *, size_t part, const double *x, const double *v, double *F, double *power);

#endif
