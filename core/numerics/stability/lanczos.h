/* Lower and upper bounds of the largest eigenvalue of a symmetric operator: see lanczos.c. */
#ifndef HK_LANCZOS_H
#define HK_LANCZOS_H

#include "core/plugin.h"

enum { HK_LANCZOS_STEPS = 40 };

/* out = A in, both l->size doubles and different arrays. */
typedef hk_status hk_lanczos_apply(void *context, const double *in, double *out);

/* The vectors belong to the caller; a run may exchange their pointers. */
typedef struct hk_lanczos {
  size_t size;
  double *current;  /* size; on entry of a run the start vector, of any length */
  double *previous; /* size, scratch */
  double *image;    /* size, scratch */
  double slack;     /* allowed excess of bound over 1.12 theta at the end of a run */

  double theta;     /* lower bound of the largest eigenvalue */
  double bound;     /* upper bound of the largest eigenvalue; never above `known` */
  double norm;      /* largest |A v| / |v| of the run */
  double asymmetry; /* largest |u.Av - v.Au| of the run, for unit vectors */
  int steps;
} hk_lanczos;

/* Fills `vector` with a fixed pseudo-random direction, close to normal deviates. */
void hk_lanczos_random(double *vector, size_t size);

/* Applies A at most HK_LANCZOS_STEPS times and stops when bound <= 1.12 theta + slack. `known` is an upper bound from
 * another source, INFINITY: none. */
hk_status hk_lanczos_run(hk_lanczos *, hk_lanczos_apply *apply, void *context, double known);

#endif
