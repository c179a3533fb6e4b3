/* Rigid bodies: mass, centre and moments of shapes and closed meshes, and the few particles that have the same.
 *
 * The frame of a body is that in which its shape is described. Its second moments are S = sum of m y y^T about the
 * centre of mass, kg m^2; the moments of inertia are the eigenvalues of tr(S) 1 - S. Functions that return text return
 * NULL on success, otherwise a sentence with the cause, which may be in the buffer that they were given. */
#ifndef HK_RIGID_H
#define HK_RIGID_H

#include "core/scene/meshes/meshes.h"

/* ---- moments.c: exact integrals ---- */

typedef struct hk_moments {
  double mass;      /* kg */
  double center[3]; /* m, in the frame of the body */
  double second[9]; /* kg m^2, S by rows, symmetric */
} hk_moments;

enum { HK_RIGID_TEXT = 256 }; /* of a buffer for a sentence */

/* Solids of density 1 kg/m^3 about the origin, of lengths in m above 0, round ones along z. */
hk_moments hk_moments_of_sphere(double radius);
hk_moments hk_moments_of_box(const double size[3]);
hk_moments hk_moments_of_cylinder(double radius, double length);
hk_moments hk_moments_of_capsule(double radius, double length); /* length between the centres of its ends */
/* Of what a mesh of triangles encloses. Refused are a mesh with an edge that does not belong to two triangles in
 * opposite directions, which is open or has triangles that face each other's way, and one whose volume is not above 0,
 * which is inside out or flat. */
const char *hk_moments_of_mesh(const hk_mesh *, hk_moments *, char text[HK_RIGID_TEXT]);
/* Of `count` points (count x 3, m) with masses above 0, kg. */
hk_moments hk_moments_of_points(size_t count, const double *x, const double *mass);
/* Multiplies mass and second moments. */
void hk_moments_scale(hk_moments *, double by);
/* Adds those of a further part, whose frame has its origin at x and is turned by R (by rows). */
void hk_moments_add(hk_moments *sum, const hk_moments *part, const double x[3], const double R[9]);
/* S of the moments of inertia about the centre, `inertia` by rows, symmetric, kg m^2. Refused are those that no body
 * has: one above the sum of the two others, or below 0. */
const char *hk_moments_set_inertia(hk_moments *, const double inertia[9], char text[HK_RIGID_TEXT]);

/* ---- rigid_body.c: the particles of a body ---- */

/* `count` particles of equal masses at the distances q (along the principal axes, from the centre of mass), with the
 * body's mass, centre and second moments: a tetrahedron, of a flat body a triangle, of a rod two points. */
typedef struct hk_rigid_body {
  double mass, center[3];
  double axes[9]; /* the principal axes as columns, right-handed, in the frame of the body */
  int dimensions; /* 1 to 3: the first principal axes, along which it has an extent */
  double a[3];    /* m, sqrt(S_k / m) along them, falling; 0 beyond `dimensions` */
  size_t count;   /* dimensions + 1 */
  double q[4][3]; /* m */
} hk_rigid_body;

/* An extent below 1e-6 of the largest is dropped. Refused are moments that are not finite, no mass, and no extent. */
const char *hk_rigid_body_of(const hk_moments *, hk_rigid_body *);
/* kg m^2, of the body, about its k-th principal axis. */
double hk_rigid_body_inertia(const hk_rigid_body *, int k);
/* The places of the particles, count x 3, m, and their velocities, m/s, where the origin of the body's frame is at
 * `origin`, turned by R (by rows), the centre of mass moves with `velocity`, and the body turns
 * at `spin`, rad/s. */
void hk_rigid_body_place(const hk_rigid_body *, const double origin[3], const double R[9], const double velocity[3],
                         const double spin[3], double *x, double *v);
/* The weights of the particles, with the sum 1, whose combination is the point y of the body's frame, wherever the body
 * goes. Returns the distance, m, by which y lies off the plane of a flat body, or the line of a rod: those have
 * combinations within them only. */
double hk_rigid_body_weights(const hk_rigid_body *, const double y[3], double weight[4]);

/* ---- rigid_motion.c: how a body moves, by its particles ---- */

typedef struct hk_rigid_motion {
  double center[3], velocity[3]; /* m, m/s, of the centre of mass */
  double attitude[9];            /* by rows: a point y of the body is at center + attitude (y - center of the body) */
  double spin[3];                /* rad/s; of a rod, across it */
  double momentum[3], angular_momentum[3]; /* kg m/s; kg m^2/s about the centre of mass */
  double energy;                           /* J, kinetic */
} hk_rigid_motion;

/* x and v: count x 3. A flat body's third axis is across the others; a rod is turned the shortest way. */
hk_rigid_motion hk_rigid_motion_of(const hk_rigid_body *, const double *x, const double *v);

/* ---- rotation.c ---- */

/* The unit quaternion (w, x, y, z), w >= 0, of a rotation by rows. Shepperd, J. Guidance and Control 1 (1978) 223. */
void hk_quaternion_of(const double R[9], double q[4]);
void hk_rotation_of_quaternion(const double q[4], double R[9]); /* of a unit quaternion */
double hk_rotation_error(const double R[9]);                    /* the largest |R R^T - 1|; 2 of a reflection */

#endif
