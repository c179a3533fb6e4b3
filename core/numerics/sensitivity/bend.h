/* What the sweeps of curvature.c share with the curvature of one stage, bend.c. */
#ifndef HK_SENSITIVITY_BEND_H
#define HK_SENSITIVITY_BEND_H

#include "core/numerics/sensitivity/force_slopes.h"
#include "core/numerics/sensitivity/sensitivity.h"

/* A point of a stage, kept between the sweeps: 6n = 2v numbers of X, their derivatives V by all columns (rows), those
 * of the acceleration by X (v rows of 2v) and by the controls (v each); where Jacobians are not exact the acceleration,
 * v, and those beside it, less and more of every number of X. */
typedef struct hk_bend_point {
  double *X, *V, *A, *B, *a, *beside;
} hk_bend_point;

typedef struct hk_bend_pass {
  hk_sensitivity *s;
  const hk_varied *by;
  size_t v, controls, columns; /* 3n; 2v of the state, then two of every control */
  double begin, end;           /* s, of the knots */
  bool values;                 /* curvature by values of accelerations, not by products with their Jacobians */
  const bool *moves;           /* 2v: which numbers of the state at the begin change at all; NULL: all */
  double *dZ, *a[HK_MOST_STAGES], *u[HK_MOST_STAGES]; /* rows of `columns`: 3v of the state, v a stage; v a stage */
  double *L, *dX;                                     /* 3v, 2v: adjoints */
  double *G, *GV, *cross;                             /* 4v^2; 2v x columns; 2v */
  double *X, *one, *two;                              /* 2v each */
  double *H;
  double *memory;
  hk_changes_plan plan;
  hk_bend_point *kept;
} hk_bend_pass;

/* Where the time t lies between the knots, 0 to 1. */
static inline double hk_bend_part(const hk_bend_pass *w, double t) { return (t - w->begin) / (w->end - w->begin); }
/* rows += part times rows of another matrix. */
static inline void hk_bend_add_rows(const hk_bend_pass *w, double *rows, double part, const double *other,
                                    size_t count) {
  for (size_t e = 0; e < count * w->columns && part != 0; e++) rows[e] += part * other[e];
}

/* Fills a, beside and A of a point, where Jacobians are not exact: da/dX by the accelerations beside the point, along
 * the numbers that move. X and V are there. */
hk_status hk_bend_survey(hk_bend_pass *, const hk_stage_point *, const hk_bend_point *);
/* H += V' (u.a)'' V and what the controls add to that, of the point at t; of the first term the upper triangle. */
hk_status hk_bend_add(hk_bend_pass *, const hk_bend_point *, double t, const double *u);

#endif
