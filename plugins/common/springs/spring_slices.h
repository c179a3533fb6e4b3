/* Springs without runs, in slices. A slice has up to eight bundles side by side, of springs at one particle each: its
 * first slot has the first spring of every bundle, the second slot the second ones, and so on, bundles with more
 * springs before those with fewer. So the particles of the bundles, the first ends, are read and their forces are
 * written once for all of their springs, and eight springs of a slot are computed together.
 *
 * Forces are added in this order: slot after slot those on the second ends, then to each first end the sum of its
 * springs'. An end may occur many times in a slice.
 *
 * Measured with eight lanes on Zen 5, on a mesh of 130,000 particles in random order, ns a spring for the list alone:
 * springs sorted by both ends, each end read and written for every spring, 4.5; slices 2.7; where a slot begins before
 * the one ahead of it ends, 2.5 (in the first-level cache 2.1 instead of 2.35, of which 1.3 without the additions to
 * second ends). Not faster, within what a busy machine lets one see: rows of four numbers in which the forces of a part
 * are summed before they are added to F, with one store for a force (0.5 instead of 0.8 for the additions, but as much
 * more for the rows themselves); indices multiplied by three beforehand; bundles of fewer particles with more springs
 * each, by a greedy cover of the edges; bundles far apart beside each other, with forces added as vectors of four;
 * large pages; particles along a curve of Hilbert or by Cuthill and McKee instead of in rows (core/scene/order.c). With
 * two lanes slices take up to a tenth longer than the sorted springs took, with four a quarter less. */
#ifndef HK_SPRING_SLICES_H
#define HK_SPRING_SLICES_H

#include "core/plugin.h"

enum {
  HK_SPRING_BUNDLES = 8, /* of a slice */
  HK_SPRING_SLOTS = 16   /* of a slice, at most; a particle with more springs has several bundles */
};

/* Eight pairs can be read from any of the list on, and the coordinates of their particles with one number beyond. */
typedef struct hk_spring_list {
  size_t count;              /* springs */
  const uint32_t (*pair)[2]; /* count: a bundle's particle first */
  const uint8_t *lanes;      /* the springs of each slot; 0 after the last slot of a slice */
} hk_spring_list;

/* Puts `count` springs into the order of slices. `order` has room for twice as many, `lanes` too. Returns the length of
 * `lanes`. */
size_t hk_spring_slices_sort(const hk_tuples *edges, uint32_t *order, size_t count, uint8_t *lanes);

/* The end by whose springs bundles are made. */
static inline uint32_t hk_spring_owner(const uint32_t pair[2]) { return pair[0] > pair[1] ? pair[0] : pair[1]; }

/* The forces of a slice, x and y as a pair, z alone. */
typedef struct hk_spring_pulls {
  double xy[HK_SPRING_SLOTS][HK_SPRING_BUNDLES][2], z[HK_SPRING_SLOTS][HK_SPRING_BUNDLES];
  double sum_xy[HK_SPRING_BUNDLES][2], sum_z[HK_SPRING_BUNDLES];
} __attribute__((aligned(64))) hk_spring_pulls;

typedef double hk_spring_half __attribute__((vector_size(16), aligned(8), may_alias));

/* x and y together and z alone: a wider store would overlap a neighbouring particle, whose load would wait for it. */
static inline void hk_spring_pull(double *F, const double xy[2], double z) {
  *(hk_spring_half *)F += *(const hk_spring_half *)xy;
  F[2] += z;
}

static inline void hk_spring_push(double *F, const double xy[2], double z) {
  *(hk_spring_half *)F -= *(const hk_spring_half *)xy;
  F[2] -= z;
}

/* Adds the forces of a slice; `pair` and `lanes` are its first ones. */
static inline __attribute__((always_inline)) void
hk_spring_pulls_add(const hk_spring_pulls *p, const uint32_t (*pair)[2], const uint8_t *lanes, double *F) {
  const uint32_t(*own)[2] = pair;
  for (size_t t = 0; lanes[t]; pair += lanes[t++])
    for (size_t r = 0; r < lanes[t]; r++) hk_spring_push(F + 3 * (size_t)pair[r][1], p->xy[t][r], p->z[t][r]);
  for (size_t r = 0; r < lanes[0]; r++) hk_spring_pull(F + 3 * (size_t)own[r][0], p->sum_xy[r], p->sum_z[r]);
}

#endif
