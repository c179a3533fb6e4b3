/* The programs of cone_program.h for impacts of rigid bodies, in the coordinates of these: six numbers a body, scaled
 * so that their squares are twice the kinetic energy, whatever the number of its impacts. In place of the impulses z,
 * the change of motion w = J^T z is unknown: with R = 1e-4 of an impact's mobility and impulses z_0 it is the least of
 * f(w) = |w|^2/2 + sum of |P(R z_0 - u)|^2/(2 R), u = u_0 + J w, which is convex and smooth, and has its least at z =
 * P(R z_0 - u)/R (Todorov 2014, Convex and analytically-invertible dynamics with contacts and constraints, ICRA,
 * section III). Programs follow each other, each about the z of the last one, so that R (z - z_0), which is what u is
 * off, goes to 0 (Rockafellar 1976, SIAM J. Control Optim. 14, 877); from the impulses of the last step a heap at rest
 * needs none. What slides is beyond a convex program by mu |u_t| of the last one (De Saxce and Feng 1998, The
 * bipotential method, Math. Comput. Modelling 28, 225), the first one by that of the impulses it begins with. The z and
 * these are a fixed point of the programs, each of which is solved to a part of what the last one left; Anderson's
 * acceleration (linear/anderson.h) takes the slow modes of heaps that tumble. The matrix has a block for each pair of
 * bodies that touch, so that time and memory follow the number of contacts. */
#ifndef HK_SOLID_PROGRAM_H
#define HK_SOLID_PROGRAM_H

#include "plugins/common/cones/solid_matrix.h"
#include "plugins/common/linear/anderson.h"

typedef struct hk_solid_impact {
  hk_solid_sides sides;
  double mu, mobility;                        /* of 0 it has one unknown; 1/kg, along n */
  double u_0[3];                              /* m or m/s, without impulses */
  double z[3];                                /* kg m or N s: where to begin, and the solution */
  double centre[3], slide, u[3], du[3], P[3]; /* room */
} hk_solid_impact;

typedef struct hk_solid_program {
  const hk_host *host;
  const hk_solvers *solvers;
  hk_linear *linear;
  size_t solids, impacts;
  hk_solid_impact *impact; /* room for those of the last hk_solid_program_reserve */
  double *w, *rhs, *dw;    /* room: solids x 6 */
  hk_solid_matrix matrix;
  hk_anderson anderson;
  double *state; /* room: what a program begins with, what it comes to, and the difference */
  bool still;    /* what touches lies still: it sticks, so that the first program begins with no sliding */
  bool closer;   /* after a solution: what is left is a tenth at most of what the impulses given left */
  size_t impact_room, w_room, rhs_room, dw_room, state_room;
} hk_solid_program;

/* In `create`. HK_FAILED: the host has no service for linear systems. */
hk_status hk_solid_program_open(hk_solid_program *, const hk_host *);
hk_status hk_solid_program_reserve(hk_solid_program *, size_t solids, size_t impacts);
/* Solves it for the z of the impacts; what u is off is below 1e-5 of the tolerance, or where programs end before that,
 * of the tolerance. *solved: false where it is more; z is then a better guess than what was given if `closer`, and else
 * of no use. The errors are those of "solvers/1". */
hk_status hk_solid_program_solve(hk_solid_program *, double tolerance, bool *solved);

#endif
