/* The impact of a pair of surfaces in a step, as an inequality for positions and one for velocities.
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

#include "plugins/common/surfaces/surfaces.h"

/* What a step would do. Positions and velocities are n x 3. */
typedef struct hk_step_move {
  double h; /* s */
  const double *x_from, *v_from;
  double *x, *v;
  const double *inverse_mass; /* n, 1/kg */
} hk_step_move;

/* The four points of a pair at both ends. */
typedef struct hk_pair_path {
  double from[12], to[12];
} hk_pair_path;

void hk_pair_path_of(hk_pair_path *, const hk_surface_pair *, const double *x_from, const double *x_to);
void hk_pair_gather(double out[12], const hk_surface_pair *, const double *x);
/* m: no two points of the two features come nearer to each other, or go farther, by more than this. */
double hk_pair_motion(hk_pair_kind kind, const hk_pair_path *);

/* One of the two inequalities, n.(sum w_i y_i - origin) >= target for y = x or v, and the impulses that keep it. */
typedef struct hk_impact_level {
  double origin[3], target;
  double push, slide[3]; /* along n and across it; kg m or N s */
  uint64_t solved;       /* when: sweeps.h */
} hk_impact_level;

typedef struct hk_impact {
  uint32_t vertex[4];
  double w[4], n[3];
  double mobility; /* 1/kg, sum of w_i^2/m_i; 0: the nearest points are pinned */
  double gap_from; /* m, at the start of the step */
  hk_impact_level place, speed;
} hk_impact;

/* How a pair meets. */
typedef struct hk_meeting {
  double gap_from;    /* m, at the start */
  double n[3], w[4];  /* of the nearest points at the instant from which these are taken */
  double restitution; /* e */
  bool again;         /* it was pushed apart in this step already: only the maxima's zeros hold */
} hk_meeting;

void hk_impact_of(hk_impact *, const hk_surface_pair *, const hk_step_move *, const hk_meeting *);

#endif
