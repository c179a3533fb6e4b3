/* The Jacobians of many joints, in blocks of vectors and on several threads. */
#ifndef HK_JOINT_JACOBIAN_H
#define HK_JOINT_JACOBIAN_H

#include "plugins/common/joints/joint.h"
#include "plugins/common/joints/joint_kernel.h"

/* What a joint does now: its geometry, k, c, the moment z = k (theta - theta_0) + c d(theta)/dt and the edges' rates.
 */
typedef struct hk_joint_state {
  hk_joint joint;
  double k, c, z, moment, du[2][3]; /* moment: without damping */
} hk_joint_state;

/* Joint e of the layout. plane: as in hk_joint_measure. */
void hk_joint_evaluate(const hk_joint_layout *, const hk_view *view, const double plane[3], size_t e, hk_joint_state *);
/* Adds the blocks of all joints, nine for each element, (i, i), (i, j), (i, k), (j, i), ... */
void hk_joint_jacobian(const hk_joint_layout *, const hk_view *view, const double plane[3], const hk_blocks *into);

#endif
