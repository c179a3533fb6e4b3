/* A quadratic program along time, as Newton's method on the equations of a transcription makes it:
 *
 *   least  sum over segments of z' C z / 2 + g . u + the squares of goals and x' B x / 2 of knots,  z = (x of the knot,
 * u of both knots), with   x[k + 1] = J[k] z + off[k],  x[1] = 0,
 *
 * where x are the changes of the d numbers of the states at the knots and u those of the m controls there. It is solved
 * by the recursion of Riccati backwards in time (Bertsekas, Dynamic Programming and Optimal Control, 4.1; with the
 * controls' value at a knot as a part of the state there, because functions that are linear between knots reach into
 * two segments). That is the block elimination of its Karush-Kuhn-Tucker matrix, which is banded in time: operations
 * grow with knots (d + m)^3, memory with knots (d + m)^2. Every pivot is positive just where the matrix, restricted
 * to the equations, is. */
#ifndef HK_HORIZON_H
#define HK_HORIZON_H

#include <stdbool.h>
#include <stddef.h>

typedef struct horizon_goal {
  size_t knot;    /* from 0 */
  double *slope;  /* d */
  double *square; /* d: of the number at that knot whose square is in the matrix; 0: none */
} horizon_goal;

typedef struct horizon {
  size_t knots, d, m, goals;
  double *J;     /* of every segment: d rows of d + 2m numbers, by x, by u at its begin, by u at its end */
  double *C;     /* of every segment: d + 2m squared, symmetric; without the effort */
  double *W;     /* of every segment: 2m squared, the effort's second derivatives */
  double *bend;  /* of every knot: d squared, symmetric, by x there */
  double square; /* the weight of the squares */
  horizon_goal *goal;
  /* ---- made by hk_horizon_factor, q = d + m ---- */
  double *P;       /* of every knot: q squared, the second derivatives of what is still to be paid */
  double *L;       /* of every knot: m squared, Cholesky's factor of the pivot of its controls */
  double *K;       /* of every segment: m rows of q, how the controls at its end follow what is at its begin */
  double *scratch; /* 4 (q + m) (q + m) and more */
  double *memory;  /* that of all of these */
} horizon;

/* NULL: no memory. C, W, bend and square are 0. */
horizon *hk_horizon_create(size_t knots, size_t d, size_t m, size_t goals);
void hk_horizon_free(horizon *);

/* Factors the matrix; false: it is not positive along the equations. */
bool hk_horizon_factor(horizon *);

/* The least of z' C z / 2 + ... + gx . x + gu . u along the equations. gx: d of every knot, gu: m of every knot, off: d
 * of every segment; NULL: 0. Fills x (d of every knot), u (m of every knot) and the multipliers of the equations (d of
 * every segment; may be NULL). After hk_horizon_factor. */
void hk_horizon_least(const horizon *, const double *gx, const double *gu, const double *off, double *x, double *u,
                      double *multipliers);

/* Adds to the row (m of every knot) how the number with the slope by x at `knot` changes with the controls. */
void hk_horizon_row(const horizon *, size_t knot, const double *slope, double *row);

#endif
