/* The largest eigenvalue of a symmetric operator from both sides: see lanczos.c. */
#ifndef HK_LANCZOS_H
#define HK_LANCZOS_H

#include "core/plugin.h"

enum { HK_LANCZOS_STEPS = 40 };

/* out = A in, both l->size doubles and different arrays. */
typedef hk_status hk_lanczos_apply(void *context, const double *in, double *out);

/* The vectors are the caller's and may change places. */
typedef struct hk_lanczos {
  size_t size;
  double *current;  /* size; on entry of a run the start vector, of any length */
  double *previous; /* size, scratch */
  double *image;    /* size, scratch */
  double *ritz;     /* size; when `warm`: about the eigenvector, length 1 */
  bool warm;
  double slack;          /* how much bound may exceed 1.12 theta at the end of a run */
  double margin, before; /* the caller's: bound over theta when the bound was last sound; the last `known` */

  double theta;     /* the largest eigenvalue is at least this */
  double bound;     /* ... and at most this; never above `known` */
  double norm;      /* largest |A v| / |v| seen */
  double asymmetry; /* largest |u.Av - v.Au| seen, for unit vectors */
  int steps;
} hk_lanczos;

/* Fills `vector` with a fixed pseudo-random direction, close to normal deviates. */
void hk_lanczos_random(double *vector, size_t size);

/* At most `steps` applications of A, ended when bound <= 1.12 theta + slack. `known` is an upper bound from elsewhere,
 * INFINITY: none. `share` in (0, 1]: the length of the random part of the start vector over its whole length. */
hk_status hk_lanczos_run(hk_lanczos *, hk_lanczos_apply *apply, void *context, double known, double share, int steps);

#endif
