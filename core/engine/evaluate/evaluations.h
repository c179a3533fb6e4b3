/* How far apart the times are at which a run evaluated its functions of time. */
#ifndef HK_EVALUATIONS_H
#define HK_EVALUATIONS_H

#include <stdbool.h>
#include <stddef.h>

enum { HK_PENDING = 256, HK_CELLS = 32768 };

typedef struct hk_evaluations {
  float *
      distance; /* s, per cell, HK_CELLS: the longest between two neighbouring times; 0: none; NULL: nothing is noted */
  double cell;  /* s, length of a cell */
  double last;  /* s, last time of accepted steps; NAN: none */
  size_t pending;
  double time[HK_PENDING]; /* s, of the step under way */
} hk_evaluations;

bool hk_evaluations_open(hk_evaluations *, double end); /* false: no memory */
void hk_evaluations_close(hk_evaluations *);
/* Where times are noted, `distance`. */
void hk_evaluations_note(hk_evaluations *, double t);   /* the functions are evaluated at t */
void hk_evaluations_accept(hk_evaluations *, double t); /* a step to t is accepted */
/* The distance in s near t, where it is known. */
double hk_evaluations_distance(const hk_evaluations *, double t, double otherwise);

#endif
