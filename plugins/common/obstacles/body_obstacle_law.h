/* The law of impact of one contact between a body or an edge and an obstacle. */
#ifndef HK_BODY_OBSTACLE_LAW_H
#define HK_BODY_OBSTACLE_LAW_H

#include "plugins/common/contact/bodies/body_arms.h"
#include "plugins/common/contact/bodies/body_moments.h"
#include "plugins/common/contact/impulses/impact.h"
#include "plugins/common/obstacles/body_features.h"

/* A feature that touches an obstacle in the step. */
typedef struct hk_body_contact {
  const hk_obstacle *obstacle;
  size_t index; /* of the feature and the obstacle, in hk_body_obstacles.solved */
  hk_obstacle_feature feature;
  const uint32_t *carrier; /* 4, of a round body, which is rubbed at its surface; else NULL */
  hk_feature_way way;
} hk_body_contact;

/* Sets the impact of a contact: its frame, targets and origins, and its arms, without the response. again: only that
 * the gap neither stays closed nor closes. Returns whether its speeds obey the law even without a push on positions. */
bool hk_body_obstacle_impact(hk_impact *, hk_body_arms *, const hk_body_contact *, const hk_obstacle_moves *,
                             bool again);
/* Rolling and spinning friction of that contact. */
void hk_body_obstacle_moments(hk_body_moments *, const hk_body_contact *, const hk_obstacle_moves *);
/* m/s: the speed across n at which a contact that lasts surely slides, far above what the step changes; 0: it does not.
 */
void hk_body_obstacle_slides(const hk_body_contact *, const hk_obstacle_moves *, double slip[3]);
/* m/s, of the feature at the place of `gap` against the obstacle, along n, at the part s of the step. */
double hk_body_contact_speed(const hk_body_contact *, const hk_obstacle_moves *, const hk_feature_gap *gap,
                             const double n[3], double s);
/* m: gaps below are contact; far above what the projection onto constraints leaves, 1e-12 of the largest coordinate. */
double hk_body_contact_touching(const hk_obstacle *, const hk_obstacle_moves *, const hk_obstacle_feature *);

#endif
