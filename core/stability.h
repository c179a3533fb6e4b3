/* The largest stable step of a method on a scene: see stability.c. */
#ifndef HK_STABILITY_H
#define HK_STABILITY_H

#include "core/spectrum.h"

typedef struct hk_step_choice {
  double h;           /* s, the step; INFINITY: any, NAN: the method does not say how it amplifies */
  bool stable;        /* no mode grows at h or below; false: h was chosen for accuracy and some grow */
  bool unconditional; /* nothing in the scene limits the step of this method */
  double growth_rate; /* 1/s, of the mode that grows fastest at h; 0 when stable */
  double limit;       /* s, largest step without growth, however small; 0: none was found, INFINITY: any */
  double w, g;        /* 1/s, the oscillation and the damping rate that set the limit */
  const char *why;    /* the reason in a few words, for messages */
} hk_step_choice;

/* No safety factor is applied: take 0.9 h. */
hk_step_choice hk_stable_step(const hk_integrator *method, const hk_spectrum *spectrum);

/* Largest growth factor of a step h over all the scene's modes. */
double hk_step_growth(const hk_integrator *method, const hk_spectrum *spectrum, double h);

#endif
