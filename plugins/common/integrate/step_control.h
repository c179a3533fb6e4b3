/* The error of a step relative to the scene, for methods that choose their steps.
 *
 * It is the largest of the relative errors, in the RMS norm, of positions, velocities and each channel. Positions are
 * measured against the scene's size, the RMS distance of the particles from their mean or, if that is larger, V^2/A,
 * the radius of curvature of a path, with V and A the largest RMS speed and acceleration so far: neither depends on
 * where the origin lies, and one particle alone has the second. Velocities are measured against V, but no less than a
 * millionth of the extent in a step, so that a scene at rest is not held to its rounding; a channel against
 * its larger RMS at the two ends of the step. The work does not count. */
#ifndef HK_STEP_CONTROL_H
#define HK_STEP_CONTROL_H

#include "core/plugin.h"

typedef struct hk_scales {
  double speed, acceleration; /* largest RMS so far */
} hk_scales;

double hk_rms(const double *list, size_t count);
void hk_scales_notice(hk_scales *, const hk_system *, const double *v, const double *a);
/* From nothing, particles in one place and at rest with no force on them yet: what the forces of the time `span` later
 * would make of them until then. X and rates are room for a state each. */
hk_status hk_scales_foresee(hk_scales *, hk_system *s, double span, double *X, double *rates);
double hk_scales_extent(const hk_scales *, const hk_system *, const double *x); /* m */
/* Of the estimate E, shaped as X, where a step of h ends at X_new with the accelerations a. NAN when something is. */
double hk_scales_error(const hk_scales *, const hk_system *, double h, const double *X_new, const double *a,
                       const double *E);
double hk_scales_speed(const hk_scales *, double extent, double h); /* m/s, what velocities are measured against */
double hk_ratio(double value, double scale);                        /* value/scale, 0 for 0/0 */
/* 1/s, how fast the motion changes by what has been seen, speed/extent and acceleration/speed; 0: from rest, where
 * neither is known. *speed: what was taken for it, no less than sqrt(extent acceleration). */
double hk_scales_rate(const hk_scales *, double extent, double *speed);

#endif
