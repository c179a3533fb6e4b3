/* A joint: the angle by which a chain turns from the edge e1 = x_j - x_i to the edge e2 = x_k - x_j, and its
 * derivatives. */
#ifndef HK_JOINT_H
#define HK_JOINT_H

#include "core/plugin.h"

/* Index 0 is e1 and index 1 is e2. Where the angle has no direction, `across` and `b` are 0. */
typedef struct hk_joint {
  double angle;        /* rad: 0 to pi in space, -pi to pi in a plane */
  double sine, cosine; /* of the angle, in space; 0 where it has no direction */
  double l[2];         /* m, the edges' lengths, in a plane those of their projections */
  double t[2][3];      /* unit vectors along the edges */
  double across[2][3]; /* d angle/d e_m = across[m]/l[m] */
  double b[3];         /* the axis about which the chain turns; unit */
  bool plane;
} hk_joint;

/* A matrix between the edges: [m][n] is that of e_m with e_n, row-major. */
typedef double hk_joint_blocks[2][2][9];

/* Measures the joint of the particles node[0..2] of x (n x 3). plane: the unit normal of the plane in which angles are
 * measured; NULL: in space. straight: the angle at rest is 0, so a straight joint, whose plane is unknown, may take
 * any. */
void hk_joint_measure(const double *x, const uint32_t node[3], const double plane[3], bool straight, hk_joint *);

/* angle - rest, in -pi to pi. */
static inline double hk_joint_off(double angle, double rest) {
  const double pi = 3.14159265358979323846;
  double off = angle - rest;
  return off > pi ? off - 2 * pi : off < -pi ? off + 2 * pi : off;
}

/* blocks = k g g^T + z H with g the gradient of the angle and H its Hessian with respect to the edges; z in N m. At a
 * straight joint that bends in any plane z H is the limit for z = k angle. */
void hk_joint_stiffness(const hk_joint *, double k, double z, hk_joint_blocks blocks);
/* The same without its negative eigenvalues, those of the matrix scaled by the edges' lengths. */
void hk_joint_definite(const hk_joint *, double k, double z, hk_joint_blocks blocks);
/* The rates of the edges du = u_j - u_i, u_k - u_j: what the damping c turns with its direction, c g (H du)^T. */
void hk_joint_turning(const hk_joint *, double c, const double du[2][3], hk_joint_blocks blocks);
/* Bounds of k g g^T + z H, or of z H alone where not `whole`: what each edge adds along it and across, N/m. */
void hk_joint_bound(const hk_joint *, double k, double z, bool whole, double along[2], double across[2]);

#endif
