/* The error of a step relative to the scene, for methods that choose their steps.
 *
 * It is the largest of the relative errors of positions, velocities and the numbers of each channel, each that of the
 * particle with the largest one: the tolerance holds for every particle, also for the only one of thousands that moves.
 * The scale of positions is the extent: the RMS distance of the particles from their mean or, if that is larger, V^2/A,
 * the radius of curvature of a path, with V and A the largest RMS speed and acceleration so far of the particles
 * that are not fixed or led along a path, however fast those are. Neither depends on the
 * origin, and the second is defined for a single particle too. The scale of velocities is V, but at least a millionth
 * of the extent per step, so that rounding does not count as an error in a scene at rest; the scale of a number of a
 * channel is its largest magnitude over all particles at the two ends of the step, but at least a millionth of the
 * channel's. The work is not included. */
#ifndef HK_STEP_CONTROL_H
#define HK_STEP_CONTROL_H

#include "core/plugin.h"

typedef struct hk_scales {
  double speed, acceleration; /* largest RMS values so far */
} hk_scales;

/* Of a method that has to give up a step from t at h s, as a shorter one would be less than what t and the time to the
 * next stop, `span`, resolve: whether it takes that step whatever its error, which is not finite or more than 1. A
 * force that jumps while all is at rest, or nearly so, gives speeds and ways of which it makes all of the scale, so
 * that no step is short enough; but the jump then is where its time is known to, and the error is that of a time
 * rounded. A singular force has no such step, as it goes on to grow: so this is granted again after some steps have met
 * their tolerance only. *wait: 0 at first, among the fields of the method; counted down by hk_jump_passed. */
bool hk_jump_met(int64_t *wait, double error);
void hk_jump_passed(int64_t *wait);                      /* a step has met its tolerance */
double hk_shortest_step(const hk_system *, double span); /* s, what the loops of methods may shorten a step to */

/* A scalar product, in eight partial sums for speed; their order is fixed. */
double hk_inner_product(const double *a, const double *b, size_t count);
double hk_rms_free(const hk_system *, const double *p); /* p: n x 3; of the particles that move freely */
/* The RMS of velocities, n x 3, of the particles that move, freely or on paths: what is pinned at rest is no part of
 * the motion, however much of it a scene has. */
double hk_rms_moving(const hk_system *, const double *v);
void hk_scales_notice(hk_scales *, const hk_system *, const double *v, const double *a);
/* Used where all particles are in one place, at rest and without forces, so that no scale is known: sets the scales to
 * the acceleration and speed that the forces at the time `span` later would cause. X and rates: scratch, one state
 * each. */
hk_status hk_scales_foresee(hk_scales *, hk_system *s, double span, double *X, double *rates);
/* m: the RMS distance of what moves freely from its middle, or the radius V^2/A of its paths where that is more. */
double hk_scales_extent(const hk_scales *, const hk_system *, const double *x);
/* The relative error of the estimate E, shaped as X, where a step of h ends at X_new with the accelerations a. NAN when
 * a part of it is NAN. */
double hk_scales_error(const hk_scales *, const hk_system *, double h, const double *X_new, const double *a,
                       const double *E);
/* The same of one channel in a step between two states. */
double hk_channel_error(const hk_channel *, size_t n, const double *from, const double *to, const double *E);
/* 1/s, the largest rate of a number of a channel relative to its size (as above); 0 where the channel is 0. For the
 * first step. */
double hk_channel_rate(const hk_system *, const double *y, const double *dy);
double hk_scales_speed(const hk_scales *, double extent, double h); /* m/s, the scale of velocities */
double hk_ratio(double value, double scale);                        /* value/scale; 0 for 0/0 */
/* 1/s, the rate of change of the motion according to the scales, the larger of speed/extent and acceleration/speed; 0
 * where neither is known (at rest). *speed: the speed used for it, at least sqrt(extent acceleration). */
double hk_scales_rate(const hk_scales *, double extent, double *speed);

/* 1/s, the largest rate at which the system changes, from the slope a at X (accelerations, then rates of y) and that
 * after an Euler step of *small s; 0: nothing changes. For the first step; span: to the next stop. X and next: scratch,
 * a state and a slope. */
hk_status hk_scales_first(hk_scales *, hk_system *s, double span, const double *a, double *X, double *next,
                          double *rate, double *small);

#endif
