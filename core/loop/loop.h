/* The time loop: the order of a step, the choice of its length, and where time is cut. */
#ifndef HK_LOOP_H
#define HK_LOOP_H

#include "core/dynamics/dynamics.h"
#include "core/stability/stability.h"

#include <signal.h>

/* What a run has measured of itself so far: what its verdict rests on. Plain data, saved whole in checkpoints. */
typedef struct hk_record {
  /* the loop's */
  size_t steps, frames; /* taken, shown */
  double dt_min, dt_max;
  double dt_beyond;       /* s, the longest step taken above the limit of its time; 0: none */
  double worst_error;     /* largest error estimate relative to tol of accepted steps */
  double kinetic_max;     /* J */
  double correction_work; /* J, energy that correctors reported to have given */
  bool moved;             /* a corrector moved something */
  bool corrected;         /* a corrector moved something and did not say what energy that took */
  bool sourced;           /* particles were born or died: the energy balance is not known */
  bool growth_expected;   /* a method without a stable step was taken all the same */
  size_t rejected;        /* steps that a corrector took back */
  /* the frames' */
  double energy_first, momentum_first[3], momentum_scale;
  double violation_max; /* m */
  double strain_max;
} hk_record;

/* ---- step_choice.c ---- */

typedef struct hk_step_choice {
  const hk_integrator *method;
  const void *parameters; /* of the method */
  const char *method_name;
  double fps;
  hk_spectrum spectrum;
  double dt;           /* s, no step is longer; adaptive methods: what they would take next */
  double dt_suggested; /* s, from the last estimate */
  double dt_limit;     /* s, largest stable step; INFINITY: none, NAN: not known; the least so far */
  double limit_now;    /* s, the same, as last estimated */
  double growth_rate;  /* 1/s */
  bool chosen, growth_expected;
  size_t estimate_cost; /* evaluations */
  size_t estimated_at;  /* evaluations when the limit was last estimated */
} hk_step_choice;

hk_status hk_step_estimate(hk_step_choice *, hk_dynamics *); /* the spectrum and the limit, whatever the method */
/* dt from `given` (s; NAN: from the stable limit). */
hk_status hk_step_choose(hk_step_choice *, hk_dynamics *, double given);
/* Again when the limit could have shrunk; `event`: in any case. */
hk_status hk_step_reestimate(hk_step_choice *, hk_dynamics *, bool event);

/* ---- time_loop.c ---- */

/* Where time is cut beside frames and events, and what ends a run early. */
typedef struct hk_schedule {
  size_t refine;     /* r > 0: n steps between two cuts become 2rn + 1: finer, and never in step with the first run */
  double part;       /* frames are cut at that part, too; 0: they are not */
  double dt_most;    /* s, longest step of an adaptive method; 0: any */
  size_t step_limit; /* HK_INTERRUPTED after so many steps; 0: none */
  const volatile sig_atomic_t *interrupted; /* NULL: cannot be */
} hk_schedule;

/* What others do at moments of the loop; NULL: nothing. */
typedef struct hk_loop_hooks {
  void *context;
  hk_status (*frame)(void *context);    /* at a frame, and at the start */
  void (*before_sample)(void *context); /* before and after the last step of a fixed-step method to a cut */
  void (*after_sample)(void *context, double h);
  void (*now_and_then)(void *context); /* every so many steps */
} hk_loop_hooks;

typedef struct hk_loop {
  const hk_scene *scene;
  hk_state *state;
  hk_pins *pins;
  hk_plugins *plugins;
  hk_dynamics *dynamics;
  hk_step_choice *step;
  hk_record *record;
  hk_warnings *warnings;
  hk_error *error;
  hk_schedule schedule;
  hk_loop_hooks hooks;
  double fps;
  double last_h;    /* s; 0: no step yet */
  bool emitted;     /* sources have been asked for the coming step */
  double *X_before; /* state->size, before the step, for correctors that want it; NULL */
  size_t room_before;
  hk_instance *integrator;
  double first_step_at, seconds, output_seconds; /* s, wall: when, of the loop without outputs, of frames */
} hk_loop;

hk_status hk_loop_to(hk_loop *, double t);
hk_status hk_loop_frame(hk_loop *); /* shows the present state */
void hk_loop_close(hk_loop *);

/* ---- step.c: one step, after which the state is that of the new time or, on a failure, worth a diagnosis ---- */

hk_status hk_step_begin(hk_loop *, double h); /* interruptions, sources, updates of contact and constraints */
/* To t_end in one step of h, or in halves where the solver does not converge or a corrector takes it back. */
hk_status hk_step_fixed(hk_loop *, double t_end, double h);
hk_status hk_step_adaptive(hk_loop *, double stop, double h);

/* ---- reset.c ---- */

void hk_step_reset(hk_loop *, hk_reason why);

/* ---- correctors.c, sources.c ---- */

hk_status hk_correctors_keep(hk_loop *); /* what they want to know of the state before the step */
/* *rejected: a corrector takes the step back; the state is then what was kept. */
hk_status hk_correctors_apply(hk_loop *, double h, bool *rejected);
hk_status hk_sources_emit(hk_loop *, double h);

#endif
