/* The largest stable step of a method on a scene: see stability.c. */
#ifndef HK_STABILITY_H
#define HK_STABILITY_H

#include "core/stability/spectrum.h"

typedef struct hk_stable {
  double limit;      /* s, largest step at which nothing grows; INFINITY: any; 0: none worth the name; NAN: not known */
  double suggestion; /* s, 0.9 limit; chosen for accuracy where limit is 0 */
  double growth_rate; /* 1/s, of the mode that grows fastest at `suggestion`; 0 below the limit */
  double w, g;        /* 1/s, frequency and damping rate of the mode that sets the limit */
  const char *why;    /* what sets it, in a few words; a constant */
} hk_stable;

hk_stable hk_stable_step(const hk_integrator *method, const hk_spectrum *spectrum);

/* Largest growth factor of a step h over all the scene's modes; at least 1. */
double hk_stable_growth(const hk_integrator *method, const hk_spectrum *spectrum, double h);

#endif
