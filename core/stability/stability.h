/* Bounds on the frequencies and damping rates of a scene, linearised at its present state, and the largest stable step
 * of a method that follows from them. This room sees a scene as an hk_system only. */
#ifndef HK_STABILITY_H
#define HK_STABILITY_H

#include "core/base/base.h"

/* Every mode is an oscillator x'' = -g x' - w^2 x with w <= w_max and
 * hk_spectrum_floor(s, w) <= g <= hk_spectrum_ceiling(s, w). */
typedef struct hk_spectrum {
  double w_max;          /* 1/s, no frequency is higher; 0: nothing oscillates */
  double w_reached;      /* 1/s, at least one is as high */
  double g_max;          /* 1/s, no damping rate is higher */
  double alpha;          /* 1/s, drag that all modes feel (an estimate, see spectrum.c) */
  double beta;           /* s, least damping over stiffness of the elements */
  double damping_slope;  /* s; 0: not known, and nor is damping_offset */
  double damping_offset; /* 1/s, no damping rate is above damping_slope w^2 + damping_offset */
  double w_undamped;     /* 1/s, no mode held by the elements' tension alone, which their damping spares, is faster */
  double channel_rate;   /* 1/s, largest k of channels that decay as dy/dt = -k y */
  bool rigorous;         /* w_max and g_max are bounds (but for one scene in a million), not estimates */
  bool covered;          /* the elements account for all that depends on x */
  bool rotates;          /* forces like v x B were seen; they count in w_max and g_max, and nothing in alpha and beta */
  size_t evaluations;    /* spent on it */
} hk_spectrum;

static inline double hk_spectrum_floor(const hk_spectrum *s, double w) {
  return s->alpha + s->beta * fmax(0, w * w - s->w_undamped * s->w_undamped);
}

static inline double hk_spectrum_ceiling(const hk_spectrum *s, double w) {
  return s->damping_slope > 0 ? fmin(s->g_max, s->damping_slope * w * w + s->damping_offset) : s->g_max;
}

/* Estimates them at (system->t, system->X), which stay as they are. On failure *spectrum is as it was. Some 30 to 180
 * evaluations, twice as many for strong damping; memory is taken and given back. */
hk_status hk_spectrum_estimate(hk_system *system, hk_spectrum *spectrum, hk_error *error);

/* The same in three parts, for estimates that are repeated: arrays of some 13 times x (and four times y) are kept. */
typedef struct hk_spectrum_work hk_spectrum_work;
hk_spectrum_work *hk_spectrum_create(const hk_system *system); /* NULL: no memory */
void hk_spectrum_destroy(hk_spectrum_work *);                  /* NULL is fine */
/* From the start; also after births and deaths, when it takes memory anew (HK_NO_MEMORY). */
hk_status hk_spectrum_measure(hk_spectrum_work *, hk_system *system, hk_spectrum *spectrum);
/* Once more, with at most `iterations` steps of Lanczos (two evaluations each) for w_max and as many for g_max, begun
 * from the directions found last; alpha is kept. Where they do not suffice for a bound, the last one grows with what
 * the steps and the forces' own bounds tell, and `rigorous` is false: an estimate that never shrinks. */
hk_status hk_spectrum_update(hk_spectrum_work *, hk_system *system, int iterations, hk_spectrum *spectrum);

/* ---- largest_step.c ---- */

typedef struct hk_stable {
  double limit;      /* s, largest step at which nothing grows; INFINITY: any; 0: none worth the name; NAN: not known */
  double suggestion; /* s, 0.9 limit; chosen for accuracy where limit is 0 */
  double growth_rate; /* 1/s, of the mode that grows fastest at `suggestion`; 0 below the limit */
  double w, g;        /* 1/s, frequency and damping rate of the mode that sets the limit */
  const char *why;    /* what sets it, in a few words; a constant */
} hk_stable;

/* `parameters` is the method's instance memory. */
hk_stable hk_stable_step(const hk_integrator *method, const void *parameters, const hk_spectrum *spectrum);

/* Largest growth factor of a step h over all the scene's modes; at least 1. */
double hk_stable_growth(const hk_integrator *method, const void *parameters, const hk_spectrum *spectrum, double h);

#endif
