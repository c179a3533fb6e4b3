/* Impacts with Coulomb's friction as a sequence of convex programs, which redundant contacts (four feet of a table,
 * corners of stacked boxes that stick) cannot bring to a standstill, as they can Newton's iteration for the law itself
 * (body_newton.h): it starts from what is found here. With u~ = u + mu |u_t| n the law is that z is in the cone |z_t|
 * <= mu z_n, u~ in its dual, and z.u~ = 0 (De Saxce and Feng 1998, Math. Comput. Modelling 28, 225, equation 23); with
 * |u_t| held it is the optimum of the least z.D z/2 + z.u~_0 in the cones (Acary and others 2011, ZAMM 91, 265, section
 * 3). */
#ifndef HK_CONE_PROGRAM_H
#define HK_CONE_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>

/* Impacts have one unknown, z_n >= 0, or three, z_n and z_t. */
typedef struct hk_cone_program {
  size_t size, count;  /* unknowns; impacts */
  const size_t *first; /* count: the first unknown of each */
  const double *mu;    /* count; 0: it has one unknown */
  const double *D;     /* size x size, symmetric, no eigenvalue below 0: u = u_0 + D z */
  const double *u_0;   /* size */
  double *z;           /* size: where to begin, and the solution */
  double *matrix;      /* room: size x size */
  double *room;        /* room: 7 x size */
} hk_cone_program;

/* Solves it, but for 1e-7 of D's diagonal times z, to that of u, and for what six programs leave of what slides. False:
 * a program was not solved. */
bool hk_cone_program_solve(const hk_cone_program *);
/* P(-u) of one impact, the projection on its cone, and its derivative J by -u, 3 x 3, where it is wanted. */
void hk_cone_project(const double *u, size_t unknowns, double mu, double P[3], double *J);
/* A rhs = rhs by elimination with pivots of columns, which changes A (n x n); false: A is singular. */
bool hk_eliminate(double *A, double *rhs, size_t n);

#endif
