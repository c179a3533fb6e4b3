/* A pair of features that may come into contact, a point and a triangle or two edges: the one record of it for the
 * broad phase, the pair cache, impulses, forces and untangling, and what all of them compute of it. A particle is an
 * edge from itself to itself. */
#ifndef HK_FEATURE_PAIR_H
#define HK_FEATURE_PAIR_H

#include "core/plugin/contact.h"
#include "plugins/common/contact/geometry/distance.h"

#include <stdint.h>

/* HK_POINT_TRIANGLE: vertex[0] against the triangle of vertex[1], [2], [3]; HK_EDGE_EDGE: the edge of vertex[0], [1]
 * against that of vertex[2], [3]. */
typedef struct hk_feature_pair {
  uint32_t vertex[4]; /* particles */
  hk_pair_kind kind;
  double offset; /* m, sum of the two radii */
  double gap;    /* m, the distance less the offset at the start of the present move, or a lower bound of it; NAN: not
                    known */
} hk_feature_pair;

/* The particles of the first feature stand before this place of `vertex`, those of the second from it on. */
static inline int hk_pair_split(hk_pair_kind kind) { return kind == HK_POINT_TRIANGLE ? 1 : 2; }

/* Of the vectors of all particles, n x 3, those of the pair. */
void hk_pair_gather(const hk_feature_pair *, const double *x, double out[12]);
hk_nearest hk_pair_nearest(const hk_feature_pair *, const double *x);

/* Where a pair is nearest: the unit vector from the second feature to the first, and the weights of hk_nearest. */
typedef struct hk_pair_frame {
  double w[4], n[3]; /* n = 0: the features are in one place */
} hk_pair_frame;

hk_pair_frame hk_pair_frame_of(const hk_nearest *);

/* The four points of a pair at both ends of a move. */
typedef struct hk_pair_path {
  double from[12], to[12];
} hk_pair_path;

void hk_pair_path_of(hk_pair_path *, const hk_feature_pair *, const double *x_from, const double *x_to);

/* m: no two points of the two features come nearer to each other, or go farther apart, by more than this. The first is
 * the least such bound, the largest move of a particle of one feature against one of the other. The second has moves
 * against the mean of the four, so that the motion of patches bounds it (candidates/patch_motion.h). */
double hk_pair_approach(hk_pair_kind, const hk_pair_path *);
double hk_pair_motion(hk_pair_kind, const hk_pair_path *);

/* The order of pairs, by kind and then by particles: as strcmp. */
static inline int hk_pair_compare(const hk_feature_pair *a, const hk_feature_pair *b) {
  if (a->kind != b->kind) return a->kind < b->kind ? -1 : 1;
  for (int c = 0; c < 4; c++)
    if (a->vertex[c] != b->vertex[c]) return a->vertex[c] < b->vertex[c] ? -1 : 1;
  return 0;
}

/* Where at most `reach` beyond the offset separates the features at x, n x 3: adds the middle between their nearest
 * points, with the direction from the second feature to the first, for pictures. None where both are in one place. */
void hk_pair_contact_point(const hk_feature_pair *, const double *x, double reach, const hk_contact_points *);

/* The two features in words, by the ids of particles: "particle 3", "edge 3 4", "triangle 3 4 5". */
typedef struct hk_pair_names {
  char one[48], other[48];
} hk_pair_names;

hk_pair_names hk_pair_names_of(const hk_feature_pair *, const uint32_t *id);

#endif
