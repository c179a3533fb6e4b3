/* The impact of a feature pair in a step, as an inequality for positions and one for velocities.
 *
 * With the unit normal n and the weights w of the nearest points at one instant of the step, the gap is, to first
 * order, C(x) = n.sum w_i x_i - offset. Where it closes at the part s of the step, with the normal speed u < 0, the law
 * of impact leaves the speed -e u, and accelerations go on as they did: n.sum w_i v_i >= max(0, u_1 - (1 + e) u), C(x)
 * >= max(0, C_1 - (1 + e) u (1 - s) h), where C_1 and u_1 are those that the step would end with. The maxima are
 * contact that lasts: the end neither overlaps nor approaches. s and u are those of the parabola through both ends with
 * the velocity of the start, so that under constant forces the law is exact. An impulse p n on the nearest point
 * changes v_i by w_i p n/m_i, which conserves momentum and, as the nearest points lie on one line along n, angular
 * momentum (at the instant of n and w). Friction is an impulse across n, at most mu p, that takes the sliding since the
 * impact. */
#ifndef HK_IMPACT_H
#define HK_IMPACT_H

#include "plugins/common/contact/geometry/feature_pair.h"

/* What a step would do. Positions and velocities are n x 3. */
typedef struct hk_step_move {
  double h; /* s */
  const double *x_from, *v_from;
  double *x, *v;
  const double *inverse_mass; /* n, 1/kg */
} hk_step_move;

/* One of the two inequalities, n.(sum w_i y_i - origin) >= target for y = x or v, and the impulses that keep it. */
typedef struct hk_impact_level {
  uint64_t solved; /* when: gauss_seidel.h */
  double origin[3], target;
  double push, slide[3]; /* along n and across it; kg m or N s */
} hk_impact_level;

/* The particles, and when the positions were solved, stand together: sweeps mostly find impacts that need no solution.
 */
typedef struct hk_impact {
  hk_feature_pair pair; /* its gap: at the start of the step */
  hk_impact_level place, speed;
  hk_pair_frame frame; /* of one instant of the step */
  double mobility;     /* 1/kg, sum of w_i^2/m_i; 0: the nearest points are pinned */
  double plastic;      /* m/s: speed.target without restitution */
  double part;         /* of the step, at which the gap closes; 1: it does not */
  double speed_then;   /* m/s, along the normal, below 0; 0: the step changes its speed by as much, as of contact that
                          lasts; none lasts that starts as far apart again as its features touch */
  double motion;       /* m/s, size of the relative velocity of the nearest points at the start of the step */
  bool rested;         /* it is contact that lasts and was given an impulse of the last step (warm_start.h) */
} hk_impact;

/* Sets mobility and levels of an impact whose pair and frame are set. again: it was pushed apart in this step already,
 * and of its maxima only the zeros hold. */
void hk_impact_set(hk_impact *, const hk_step_move *, double restitution, bool again);

/* Whether it is contact that lasts: from the start of the step to its end the gap is no larger than `near` m, and
 * closes by no more. Then friction takes the sliding of the whole step, where it takes that since the impact else:
 * among bodies that fall together in the step before its impulses, whether and when such a gap closes is an error of
 * the last step. */
bool hk_impact_last(hk_impact *, const hk_step_move *, double near);

/* F += the force of the solved impacts on the particles, N, n x 3: the mean of their impulses over a step of h s. */
void hk_impact_add_forces(const hk_impact *, size_t count, double h, double *F);

#endif
