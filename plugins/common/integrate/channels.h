/* The channels of an implicit stage or step: the y that solves y = y* + g dy/dt(t, x, v, y) while x and v are given.
 *
 * Newton's method with the block of dy'/dy that belongs to each particle, found by differences with one evaluation per
 * number of a particle: perturbations of neighbours (by index) have opposite signs, so that where a force exchanges a
 * quantity between neighbours the blocks are too large rather than too small, and the iteration converges. The blocks
 * are made when the plain iteration y <- y* + g dy/dt has proved slow, and kept until the iteration with them is; a
 * change of g costs new factors only. What depends on x and v is solved by taking turns with the velocities (newton.h).
 * Hairer and Wanner, Solving ODEs II, IV.8. */
#ifndef HK_CHANNELS_H
#define HK_CHANNELS_H

#include "plugins/common/integrate/stage.h"

/* Zeroed before `open`. */
typedef struct hk_channels {
  const hk_host *host;
  size_t n, width;        /* particles, numbers of each: their product is the numbers of y without the work */
  size_t *first, *step;   /* width each: number k of particle i is y[first[k] + step[k] * i] */
  double *block, *factor; /* n x width x width: dy'/dy, and the triangular factors of I - g dy'/dy */
  size_t *pivot;          /* n x width */
  double *scratch;        /* 3n + 3 (n width + 1) */
  double g;               /* s, of the factors; 0: there are none */
  bool known;             /* whether `block` has been found */
  double last, rate;      /* size of the last change, relative to the allowed one, and the observed convergence */
  int renewals;           /* of the blocks since x or v changed */
} hk_channels;

hk_status hk_channels_open(hk_channels *, const hk_host *host, const hk_view *view);
void hk_channels_close(hk_channels *);
void hk_channels_forget(hk_channels *); /* the rates may have become others */

/* Improves the y of stage->X by one iteration, dy being the rates there. `moved`: x or v have changed since the last
 * call. *settled: what is left of each number is below `tolerance` of its change in the stage and, unless it is 0,
 * below stage->channels of its size, the largest magnitude over all particles.
 * HK_NOT_CONVERGED: the iteration diverges. */
hk_status hk_channels_improve(hk_channels *, hk_system *s, const hk_stage *stage, const double *dy, double tolerance,
                              bool moved, bool *settled);
/* Finds the blocks at (t, X), with width + 1 evaluations (width, where `dy` is given). X changes by its pins only. */
hk_status hk_channels_differentiate(hk_channels *, hk_system *s, double t, double *X, const double *dy);
void hk_channels_factorize(hk_channels *, double g);
/* x = (I - g dy'/dy)^-1 b with the present factors, x = b where there are none; x may be b. */
void hk_channels_solve(const hk_channels *, const double *b, double *x);

#endif
