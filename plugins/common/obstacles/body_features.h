/* Points and edges of particles that constraints join, against an obstacle: where an edge is nearest to the surface,
 * how far it is at any part of a step, and when it first touches. The way of a particle within a step is Hermite's
 * cubic through the positions and velocities of its ends, exact under constant forces and off by O(h^4) else. */
#ifndef HK_BODY_FEATURES_H
#define HK_BODY_FEATURES_H

#include "plugins/common/obstacles/obstacle.h"

/* A particle (both the same) or an edge. */
typedef struct hk_obstacle_feature {
  uint32_t end[2];
  const hk_obstacle *against; /* NULL: all obstacles */
} hk_obstacle_feature;

/* Where a feature is nearest to an obstacle. */
typedef struct hk_feature_gap {
  double gap;          /* m, of the surfaces; negative: inside */
  double place;        /* on the edge, from 0 to 1 */
  double x[3], n[3];   /* m, that place; the obstacle's normal there, in the scene */
  bool inside_of_edge; /* it is nearer there than the edge's ends are */
} hk_feature_gap;

/* What a feature does past an obstacle in a step. */
typedef struct hk_feature_way {
  hk_feature_gap from, to; /* at the start and at the end */
  double landing;          /* the part of the step at which it first touches; 0: from the start; 1: it does not before
the end */
  hk_feature_gap at;       /* then */
  bool touches;            /* in the step */
} hk_feature_way;

/* The place of the feature at the part s of the step. What is farther away than `reach`, m, may be taken as its nearer
 * end. */
hk_feature_gap hk_feature_gap_at(const hk_obstacle *, const hk_obstacle_moves *, const hk_obstacle_feature *, double s,
                                 double reach);
/* `touching`: m, the gap of contact, here and below. False: the feature certainly does not touch in the step. */
bool hk_feature_may_touch(const hk_obstacle *, const hk_obstacle_moves *, const hk_obstacle_feature *, double touching);
hk_feature_way hk_feature_way_of(const hk_obstacle *, const hk_obstacle_moves *, const hk_obstacle_feature *,
                                 double touching);
/* m/s, the velocity of the obstacle's surface at the place x, at the part s of the step. */
void hk_obstacle_surface_velocity(const hk_obstacle *, double s, const double x[3], double u[3]);

#endif
