/* Bounds on the frequencies and damping rates of a scene, linearised at its present state, and the largest stable step
 * of a method that follows from them. The files of core/numerics/stability see a scene as an hk_system only. */
#ifndef HK_STABILITY_H
#define HK_STABILITY_H

#include "core/engine/base/base.h"

enum { HK_DAMPED_LINES = 3 };

/* Every mode is an oscillator x'' = -(g + i b) x' - w^2 x with w <= w_max, |b| <= b_max and
 * hk_spectrum_floor(s, w) <= g <= hk_spectrum_ceiling(s, w). */
typedef struct hk_spectrum {
  double w_max;          /* 1/s, no frequency is higher; 0: nothing oscillates */
  double w_reached;      /* 1/s, at least one is as high */
  double g_max;          /* 1/s, no damping rate is higher */
  double b_max;          /* 1/s, no velocity is turned faster (by v x B, say); 0: none is turned */
  double alpha;          /* 1/s, drag that all modes feel (an estimate, see spectrum.c) */
  double beta;           /* s, least damping over stiffness of the elements */
  double damping_slope;  /* s; 0: not known, and nor is damping_offset */
  double damping_offset; /* 1/s, no damping rate is above damping_slope w^2 + damping_offset */
  struct {
    double slope, offset; /* s, 1/s: no damping rate is below slope w^2 - offset; slope 0: not known */
  } damped[HK_DAMPED_LINES];
  double w_undamped;  /* 1/s, no mode held by the elements' tension alone, which their damping spares, is faster */
  double w_switching; /* 1/s, no frequency of forces that set in and cease (HK_STIFFENS) is higher; 0: there are none */
  double channel_rate; /* 1/s, largest k of channels that decay as dy/dt = -k y */
  bool rigorous;       /* w_max and g_max are bounds (but for one scene in a million), not estimates */
  bool covered;        /* the elements account for all that depends on x */
  size_t evaluations;  /* spent on it, or what takes as long */
} hk_spectrum;

static inline double hk_spectrum_floor(const hk_spectrum *s, double w) {
  double least = s->alpha + s->beta * fmax(0, w * w - s->w_undamped * s->w_undamped);
  for (int k = 0; k < HK_DAMPED_LINES; k++) least = fmax(least, s->damped[k].slope * w * w - s->damped[k].offset);
  return least;
}

static inline double hk_spectrum_ceiling(const hk_spectrum *s, double w) {
  return s->damping_slope > 0 ? fmin(s->g_max, s->damping_slope * w * w + s->damping_offset) : s->g_max;
}

/* Estimates the spectrum at (system->t, system->X), which do not change. On failure *spectrum does not change. Takes
 * some 30 to 180 evaluations, up to four times as many where there is damping; allocates memory of some 6 times x and
 * frees it. */
hk_status hk_spectrum_estimate(hk_system *system, hk_spectrum *spectrum, hk_error *error);

/* The same as far as the largest stable step of a method depends on it: where the fastest and most strongly damped of
 * all modes sets that step, `damping_slope` is not looked for, and `damped` only where the method gains by damping,
 * which saves most of the evaluations. `parameters` is the method's instance memory. `step`: NAN, or a step that is
 * given: where a scene is large and what its forces state of their stiffness allows that step, w_max is from that
 * alone, and w_reached is not known and as large. */
hk_status hk_spectrum_estimate_for(hk_system *system, const hk_integrator *method, const void *parameters, double step,
                                   hk_spectrum *spectrum, hk_error *error);

/* sqrt(3n) |K u| for a random unit vector u of the motions that pins and constraints allow, 1/s^2: no bound, but as
 * large as the largest eigenvalue where few are large, and it rises with them, as constraints' forces stiffen what they
 * hold, which nothing states. The same vector every time. *sample: 0 where it is rounding. Takes two evaluations and
 * two projections; allocates memory of some 6 times x and frees it. */
hk_status hk_stiffness_sample(hk_system *system, double *sample);

/* ---- watch.c: what is known of the stiffness between two estimates. Plain data ---- */

typedef struct hk_stated_bounds {
  bool covered;     /* every force that depends on x states it */
  double stiffness; /* 1/s^2 */
  double damping;   /* 1/s, of those forces that state a stiffness */
  double sample;    /* 1/s^2, hk_stiffness_sample, where there are constraints; 0 elsewhere */
} hk_stated_bounds;

typedef struct hk_watch {
  hk_stated_bounds allowed;    /* the spectrum is valid up to these */
  hk_stated_bounds last, seen; /* at the last two measurements */
  hk_stated_bounds expected;   /* at the next one */
  size_t next, every;          /* evaluations of the run: at the next measurement, between two */
  double motion, moved;        /* (m/s)^2, with constraints: at the most until then; at the last measurement */
  size_t at;                   /* evaluations of the run at the last measurement */
  double peak[2];              /* 1/s^2, the largest sample between the last two estimates, and since */
  double leeway;               /* the factor by which w_max^2 may rise until it determines the step, at least 1 */
  size_t measurements;
  size_t often; /* times as many measurements as else for the same evaluations, where steps cost more; 0: as 1 */
} hk_watch;

/* After an estimate at the present state. scratch: 6n doubles, here and below; motion: the largest square of the speed
 * of what constraints hold, (m/s)^2, or 0. */
void hk_watch_begin(hk_watch *, hk_system *system, double (*scratch)[6], double motion, size_t evaluations);
/* Whether that hk_stiffness_sample is above that of the last estimate, by more than a chosen step allows. */
bool hk_watch_exceeded(const hk_watch *, double sample);
/* Whether to measure. */
bool hk_watch_calls(const hk_watch *, double motion, size_t evaluations);
/* Measures; whether the spectrum is expected to be exceeded by the next measurement. */
bool hk_watch_measure(hk_watch *, hk_system *system, double (*scratch)[6], double motion, size_t evaluations);
/* Raises the spectrum to the expected bounds, with some headroom. */
void hk_watch_raise(hk_watch *, hk_spectrum *spectrum);

/* ---- largest_step.c ---- */

typedef struct hk_stable {
  double limit;      /* s, largest step at which no mode grows; INFINITY: any step; 0: no useful step; NAN: not known */
  double suggestion; /* s, 0.9 limit; chosen for accuracy where limit is 0, or not known because velocities turn */
  double growth_rate; /* 1/s, of the mode that grows fastest at `suggestion`; 0 below the limit */
  double w, g, b;     /* 1/s, frequency, damping rate and turning rate of the mode that sets the limit */
  const char *why;    /* what determines the limit, in a few words; a constant string */
} hk_stable;

/* `method` is that of hk_integrator_tables; `parameters` is its instance memory. */
hk_stable hk_stable_step(const hk_integrator *method, const void *parameters, const hk_spectrum *spectrum);

/* Largest growth factor of a step h over all modes of the scene; at least 1. */
double hk_stable_growth(const hk_integrator *method, const void *parameters, const hk_spectrum *spectrum, double h);

#endif
