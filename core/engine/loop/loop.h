/* The time loop: the order of the parts of a step, the choice of the step size, and the times at which a step must
 * end. */
#ifndef HK_LOOP_H
#define HK_LOOP_H

#include "core/engine/evaluate/evaluate.h"

#include <signal.h>

/* The data measured so far from which the verdict of a run is derived. Plain data; checkpoints contain all of it. */
typedef struct hk_record {
  /* written by the loop */
  size_t steps, frames; /* number of steps taken and of frames */
  double dt_min, dt_max;
  double dt_beyond;              /* s, the longest step above the stable limit at its time; 0: none */
  double worst_error;            /* largest error estimate of accepted steps, relative to tol */
  double step_taken, step_error; /* s, of the last step; largest estimate since a frame set it to 0 */
  double kinetic_max, hand_work; /* J; hand_work: of the user's hand */
  double kinetic_sum;            /* J, over the frames */
  double reach;                  /* m, RMS: the largest distance from the start that was seen between frames */
  double correction_work;        /* J, energy that correctors gave, by the energies before and after */
  double contact_work;           /* J, of it by those that keep surfaces apart */
  double dissipated;             /* J, that internal variables of forces took */
  bool moved, corrected;         /* a corrector moved something, and did not say what energy that took */
  bool sourced, by_hand; /* particles were born or died: the energy balance is not known; a user's hand moved some */
  bool growth_expected;  /* the integrator has no stable step on this scene */
  size_t late_impacts;   /* number of steps at whose end a one-sided equation was met late */
  size_t rejected;       /* number of steps rejected by contact or by correctors */
  /* By the hook `moved`: sums of dv^2 t^k over what steps missed; the largest dv, its time, the dt it asks for, whose.
   */
  double passed[3], passed_most, passed_at, passed_dt;
  uint32_t passed_id, passed_force;
  double path_speed_error; /* m/s, largest estimated error of the velocity of a pin's path; 0: none is estimated */
  /* written at frames */
  double energy_first, momentum_first[3], momentum_scale;
  double violation_max, strain_max;           /* m; relative */
  double force_rms, force_p99, force_largest; /* the largest errors of approximate forces so far, relative; 0: none */
  double force_work, force_power, force_at;   /* J, of such errors at most; W at the last frame, and its time, s */
  hk_contact_report contact;                  /* so far; the intersections of all frames that count against the run */
  size_t contact_frames, intersecting, intersections[2]; /* frames; of the first frame, and of the last */
  double intersecting_at;                                /* s, the first frame that counts against the run */
  double contact_least, contact_rise; /* J, that contact gave: the least while nothing drove it; rises above it */
} hk_record;

/* ---- The length of steps ---- */

/* The functions are installed by what chooses the step as the scene changes (core/numerics/step_choice), of which this
 * is the first member; NULL: steps are of dt. */
typedef struct hk_step_length hk_step_length;
struct hk_step_length {
  double dt;        /* s, longest step; adaptive methods: the next step that they propose */
  double limit_now; /* s, largest stable step by the last estimate; INFINITY: no limit, NAN: not known */
  size_t watch_at;  /* number of evaluations from which `watch` is called again */
  hk_status (*watch)(hk_step_length *, hk_dynamics *);                  /* before a step of a fixed-step method */
  hk_status (*reestimate)(hk_step_length *, hk_dynamics *, bool event); /* at frames; `event`: forces or pins changed */
  hk_status (*review)(hk_step_length *, hk_dynamics *, size_t births, size_t deaths); /* after births and deaths */
};

/* ---- time_loop.c ---- */

/* Times at which a step must end besides frames and events, and the conditions that end a run early. */
typedef struct hk_schedule {
  size_t refine;     /* r > 0: 2rn + 1 steps replace n steps between two cuts, see hk_run_options */
  const double *cut; /* s, increasing: further times at which a step ends, such as those of pulses */
  size_t cuts;
  double part;       /* fraction of a frame at which it is cut as well; 0: no such cut */
  double dt_most;    /* s, longest step of an adaptive method; 0: no limit */
  size_t step_limit; /* the run ends with HK_INTERRUPTED after so many, taken or taken back; 0: no limit */
  const volatile sig_atomic_t *interrupted; /* NULL: the run cannot be interrupted */
} hk_schedule;

/* The steps of a fixed-step method between two cuts: step i of n, of h s, ends at begin + i h. A run that is
 * interrupted keeps the piece it was in; n is 0 between two pieces. */
typedef struct hk_piece {
  size_t i, n;           /* the step that is next, from 1 */
  double begin, stop, h; /* s */
  double dt;             /* s, the longest step when it was cut */
} hk_piece;

enum { HK_EARLY_STEPS = 64 };

/* Functions that the loop calls; NULL: none. */
typedef struct hk_loop_hooks {
  void *context;
  hk_status (*frame)(void *context);    /* at a frame, and at the start */
  hk_status (*framed)(void *context);   /* when all that belongs to a frame is done: the run may be saved here */
  void (*before_sample)(void *context); /* before and after the last step of a fixed-step method before a cut */
  void (*after_sample)(void *context, double h);
  void (*moved)(void *context, double h); /* after a step of h s from the positions in X_before, before correctors */
  void (*now_and_then)(void *context);    /* every 64 steps */
  void (*passing)(void *context);         /* after every HK_TILE_STEPS steps, 2 of the first HK_EARLY_STEPS */
} hk_loop_hooks;

typedef struct hk_loop hk_loop;
typedef struct hk_attempt hk_attempt;
typedef hk_status hk_step_stage(hk_loop *, hk_attempt *);
enum { HK_STAGES = 12 };
typedef struct hk_population_change hk_population_change;

struct hk_loop {
  hk_state *state;
  hk_pins *pins;
  hk_plugins *plugins;
  hk_dynamics *dynamics;
  hk_step_length *step;
  hk_record *record;
  hk_warnings *warnings;
  hk_error *error;
  hk_schedule schedule;
  hk_loop_hooks hooks;
  double fps;
  hk_piece piece;
  /* Births and deaths (core/numerics/population) before a step of h s, or, with HK_AFTER_STEPS, after it; NULL: the
   * scene has no sources. */
  hk_status (*emit)(hk_loop *, double h, unsigned when);
  hk_population_change *population; /* of `emit` */
  double last_h;                    /* s; 0: no step yet */
  bool between_steps;               /* it was interrupted there, with nothing half done */
  bool emitted;                     /* the sources were called for the coming step */
  double *X_end;                    /* the state at the end of a step, before correctors; NULL: not needed */
  double *X_before; /* the state before a step for contact and correctors, or x alone for `moved`; NULL: not needed */
  size_t room_before, room_end;
  hk_record record_before; /* where a step may be rejected */
  const char *rejected_by; /* who rejected a step last */
  double part;             /* of its length, in which the step is repeated next */
  unsigned needs; /* what the scene needs of a step, and the stages of an attempt that follow from it (step.c) */
  hk_step_stage *stage[HK_STAGES];
  size_t stages;
  hk_instance *integrator;
  const hk_integrator *method;                   /* its table */
  double first_step_at, seconds, output_seconds; /* s, wall: of the first step; spent in steps; in frames */
};

/* All but schedule, hooks and sources, which are zero. */
void hk_loop_open(hk_loop *, hk_dynamics *, hk_step_length *, hk_record *, double fps);
hk_status hk_loop_to(hk_loop *, double t);
double hk_loop_longest_step(hk_loop *); /* s, that forces and correctors allow at the present state; INFINITY: any */
hk_status hk_loop_frame(hk_loop *);     /* calls the frame hook for the present state */
void hk_loop_close(hk_loop *);

/* ---- step.c: the order of a step, and its attempts. Afterwards the state is that of the new time, or, on a failure,
 * one for the diagnosis ---- */

struct hk_attempt {
  double t_stop; /* s: it may not end later; a fixed-step method ends there */
  double stop;   /* s, the next cut */
  double h;      /* s, the step that is asked for */
  bool last;     /* another attempt will not be made */
  double begin;  /* s, the time before it */
  hk_step out;   /* the integrator's report; out.h is NAN where an adaptive method made none */
  bool rejected; /* the state before the step is restored; time and record are not */
};

hk_status hk_step_begin(hk_loop *, double h);
/* Advances to t_end by one step h, or by parts of it where an attempt fails or is rejected. */
hk_status hk_step_fixed(hk_loop *, double t_end, double h);
hk_status hk_step_adaptive(hk_loop *, double stop, double h);
void hk_step_set_time(hk_loop *, double t);
/* After a step, of the state after it: record, `accepted`, and now and then whether it is finite. */
hk_status hk_step_accept(hk_loop *, double h, double error);
hk_status hk_step_check(const hk_loop *); /* HK_NOT_FINITE where a number of the state is not */

/* ---- tile.c ---- */

bool hk_tile_fits(const hk_loop *);                       /* several steps can be taken at once, until the next cut */
size_t hk_tile_length(const hk_loop *, const hk_piece *); /* so many, where it fits */
hk_status hk_tile_take(hk_loop *, const hk_piece *, size_t *length); /* *length, or fewer */

/* ---- reset.c ---- */

void hk_step_reset(hk_loop *, hk_reason why);

/* ---- contact.c: calls of `update` and `step_limit` in a step ---- */

hk_status hk_contact_begin(hk_loop *, double h); /* before a step of h s: updates up to the predicted positions */
/* Of a method that does not limit its moves: whether a step failed because forces were not finite; the state before the
 * step is then restored and *status is HK_OK. */
bool hk_contact_rejects(hk_loop *, hk_status *status);
/* *rejected: the move from X_before to the state is safe in part only; the state before the step is then restored. */
hk_status hk_contact_check(hk_loop *, double t_before, bool *rejected);

/* J, the work done on the scene: that of pins and non-conservative forces, which is integrated with the state, less
 * what internal variables dissipated. The latter is kept apart from X, of which some methods have a copy. */
static inline double hk_loop_work(const hk_state *s, const hk_record *r) { return s->X[s->size - 1] - r->dissipated; }

/* ---- correctors.c ---- */

double hk_correctors_longest_step(hk_loop *);   /* s, at the present state; INFINITY: no bound */
bool hk_correctors_need_start(const hk_loop *); /* whether a corrector needs the state before the step */
/* last: the step cannot be made shorter. *rejected: a corrector rejected the step; the state before the step is then
 * restored. */
hk_status hk_correctors_apply(hk_loop *, double h, bool last, bool *rejected);

#endif
