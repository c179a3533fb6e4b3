/* Linear steps (core/plugin/facets/stages.h, `linear`): one system in place of a step's equation,
 *     A dv = M r,    r = v* - v + g a,    A = M + g D + g^2 K,
 * at the point x^ = x* + g v, v. Their derivative has that of A beside that of r,
 *     A d(dv) = M dr + dM r - dA dv,
 * where dA dv is the central difference of products along the change of the point and of the positions from which the
 * tensions in K are foretold, or between two scenes. Backwards, with A^T y = the adjoint of dv, y.dA dv is the gradient
 * of a bilinear form: of forces whose blocks are those of -dF/dx and -dF/dv it is, as second derivatives are symmetric,
 * the derivative of (dF/dx, dF/dv)^T y along (g^2 dv, g dv), a difference of two products; others state it
 * (facets/implicit.h, `bilinear`).
 *
 * Where the factorization failed, dv = p + q with B p = M r and B q = M r - A p, B of projected blocks, and this is
 * differentiated, as long as no block changes from one that is projected to one that is not. */
#ifndef HK_SENSITIVITY_LINEARISED_H
#define HK_SENSITIVITY_LINEARISED_H

#include "core/numerics/implicit/implicit.h"
#include "core/numerics/sensitivity/force_slopes.h"
#include "core/numerics/sensitivity/sensitivity.h"

/* A step, and where the tape has what it is made of, in place of the points of its stages. */
typedef struct hk_linear_point {
  double t, g, back; /* s, of its end; s; of X* = X + back (X - X_before) */
  bool foretold;     /* K has the tensions that the last linearisation foretold */
  bool projected;    /* dv = p + q */
  double *X, *a;     /* x^ and v, 6n, and the acceleration there, 3n */
  double *between;   /* 6n: the positions of the last linearisation, and those that it led to */
  double *dv, *r;    /* 3n */
  double *p, *q;     /* 3n */
} hk_linear_point;

struct hk_linearised {
  unsigned want; /* of the blocks, by the scene's solver */
  double *X;     /* 12n: a point, and behind it the positions `between` */
  double *w[8];  /* 3n each: scratch */
  /* Of the adjoint of the step at hand, 3n each: of M r in the system of dv, or of q; of M r in that of p. */
  double *y, *z;
  double *by_between; /* 6n: that of the positions `between` */
  bool *states;       /* one per force: it is constant, or states the gradient of its bilinear form */
  bool *others;       /* one per force: scratch */
};

/* One for a record of a method with `linear`. */
hk_status hk_linearised_open(hk_sensitivity *);
void hk_linearised_close(hk_sensitivity *);
/* Refuses in one sentence scenes of such a method, constraints apart. */
hk_status hk_linearised_refuse(const hk_loop *, hk_error *);

/* ---- step.c ---- */

/* Takes a step from Z to Z, and keeps what it is made of. */
hk_status hk_linearised_step(hk_sensitivity *, const hk_taken_step *, hk_carried *Z);
hk_linear_point hk_linearised_at(const hk_sensitivity *, const hk_taken_step *);
/* The matrix at the point, with more than the method's own `want`; valid until the next one. */
hk_status hk_linearised_matrix(hk_sensitivity *, const hk_linear_point *, unsigned more, hk_matrix *A);
void hk_linearised_product(const hk_matrix *A, const double *x, double *y); /* y = A x */
/* x of b, which is filtered, by the last factors. */
hk_status hk_linearised_solve(hk_sensitivity *, double *b, double *x);
/* Subtracts from c and d what the matrices' change makes of the systems of dv, or q, and of p, and adds that of the
 * masses: by a parameter, without some forces (NULL: with all); and while the point and `between` change, 6n each. */
hk_status hk_linearised_by_parameter(hk_sensitivity *, const hk_linear_point *, const hk_varied *, const bool *without,
                                     double *c, double *d);
hk_status hk_linearised_change(hk_sensitivity *, const hk_linear_point *, const hk_varied *, const double *dX,
                               const double *between, double *c, double *d);

/* ---- tangent.c ---- */

/* The change dX, 6n, of the point. */
void hk_linearised_place(const hk_sensitivity *, const hk_taken_step *, const hk_carried *dZ, double *dX);
/* dZ becomes that of the end, with the change dX of the point and da of its acceleration. The step has just been taken.
 */
hk_status hk_linearised_tangent(hk_sensitivity *, const hk_taken_step *, const hk_varied *, const double *dX,
                                const double *da, hk_carried *dZ);

/* ---- adjoint.c ---- */

/* Of the adjoint L of a step's end: finds y and z, and u, 3n, the adjoint of the acceleration. */
hk_status hk_linearised_return(hk_sensitivity *, const hk_taken_step *, const hk_carried *L, double *u);
/* Adds to dX, 6n, what the matrices ask of the point, and to the slopes, if there are any. */
hk_status hk_linearised_bend(hk_sensitivity *, const hk_taken_step *, double *dX, hk_force_slopes *);
/* The derivative by a parameter, through the matrices and the masses. */
double hk_linearised_slope(const hk_sensitivity *, const hk_linear_point *, const double *c, const double *d);
/* With all that is asked of the point, dX, L becomes the adjoint of the step's begin. */
void hk_linearised_depart(hk_sensitivity *, const hk_taken_step *, const double *dX, hk_carried *L);

#endif
