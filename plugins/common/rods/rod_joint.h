/* One joint at the state of the last evaluation, and its derivatives with respect to the vectors of its edges. */
#ifndef HK_ROD_JOINT_H
#define HK_ROD_JOINT_H

#include "plugins/common/rods/rod_set.h"

/* d: directors halfway, of the edge before; e: the same of the edge after. k: components of kb on them. */
typedef struct hk_rod_joint {
  double t0[3], t1[3], inverse[2], chi, kb[3], mean[3];
  double d[2][3], e[2][3];
  double bend[2], twist, k[2], w[2], torque; /* w: dE/dk, torque: dE/dm */
} hk_rod_joint;

static inline size_t hk_rod_joints(const hk_rod_batch *b, size_t lane) {
  return b->ring ? b->count[lane] : b->count[lane] > 0 ? b->count[lane] - 1 : 0;
}

/* Joint k of the rod in a lane. */
void hk_rod_joint_at(const hk_rods *, const hk_rod_batch *, size_t lane, size_t k, hk_rod_joint *);
/* Makes the joint at a row one whose derivatives of squares are those of the damping: bend and twist become J s. Where
 * there is no stiffness in twist, that against rates of twist is the one of bending. */
void hk_rod_joint_damping(const hk_rods *, size_t row, hk_rod_joint *);
/* The derivatives of the two components of curvature and of the twist, (e0, e1). */
void hk_rod_joint_gradients(const hk_rod_joint *, double g[2][6], double m[6]);

#endif
