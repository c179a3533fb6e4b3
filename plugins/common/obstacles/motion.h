/* The motion of an obstacle in a step, from what its script says of it at the ends of steps: a position and a rotation
 * vector (axis times angle, rad). Between them both are quadratic in time, through the ends of this step and the start
 * of the one before, so that velocities at the contact are off by O(h^2); without a step before they are linear. The
 * angular velocity is that of the rotation vector's path: w = J(r) r', J the left Jacobian of the exponential map. */
#ifndef HK_MOTION_H
#define HK_MOTION_H

#include <stdbool.h>

typedef struct hk_pose {
  double t;           /* s */
  double position[3]; /* m */
  double rotation[3]; /* rad */
} hk_pose;

enum { HK_POSES = 3 }; /* the start of the step before, the start and the end of this one */

typedef struct hk_body_frame {
  double origin[3], velocity[3]; /* m, m/s */
  double turn[9];                /* columns: the own axes in the scene */
  double spin[3];                /* rad/s */
} hk_body_frame;

typedef struct hk_motion {
  hk_pose pose[HK_POSES];
  bool bent;  /* the first pose is known */
  bool still; /* all poses are the same */
  hk_body_frame start, end;
} hk_motion;

/* Begins a history with one pose. */
void hk_motion_begin(hk_pose history[HK_POSES], const hk_pose *now);
/* Enters the pose at the end of a step that began at t_from; a step taken back before is replaced. */
void hk_motion_advance(hk_pose history[HK_POSES], double t_from, const hk_pose *now);
/* The motion of the step up to the last pose of the history. */
void hk_motion_of(hk_motion *, const hk_pose history[HK_POSES]);
/* The frame at the part s of the step, 0 to 1. */
void hk_motion_at(const hk_motion *, double s, hk_body_frame *);

/* From the scene to the frame and back: of points, directions, and velocities at the point x or p. */
void hk_body_point(const hk_body_frame *, const double x[3], double p[3]);
void hk_body_velocity(const hk_body_frame *, const double x[3], const double u[3], double w[3]);
void hk_body_place(const hk_body_frame *, const double p[3], double x[3]);
void hk_body_direction(const hk_body_frame *, const double d[3], double to[3]);
void hk_body_move(const hk_body_frame *, const double x[3], const double w[3], double u[3]);

#endif
