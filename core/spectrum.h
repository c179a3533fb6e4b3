/* Bounds on the frequencies and damping rates of a scene, linearised at its present state. */
#ifndef HK_SPECTRUM_H
#define HK_SPECTRUM_H

#include "core/error.h"
#include "core/plugin.h"

typedef struct hk_spectrum {
  double w_max;        /* 1/s, no frequency is higher */
  double g_max;        /* 1/s, no damping rate is higher */
  double alpha, beta;  /* every mode is damped at least at the rate alpha + beta w^2 (1/s, s) */
  double channel_rate; /* 1/s, largest k of channels that decay as dy/dt = -k y */
} hk_spectrum;

/* Estimates them at (s->t, s->X). `covered`: every acting force that depends on x offers its elements, so that they
 * bound the frequencies too (Gershgorin) and tell the least damping. Evaluates accelerations some 2 x 40 times. */
hk_status hk_spectrum_estimate(hk_system *s, bool covered, hk_spectrum *spectrum, hk_error *error);

#endif
