/* The accuracy of a run: the figures of its frames, its summary, and the verdict with its reason. */
#ifndef HK_JUDGE_H
#define HK_JUDGE_H

#include "core/engine/loop/loop.h"
#include "core/scene/scene/scene.h"

typedef struct hk_judgement hk_judgement;

typedef struct hk_plugin_time {
  const char *kind, *name, *label, *remedy; /* remedy: of its own figures; NULL: not known */
  double seconds;
  bool apart;     /* a force without parts: see hk_evaluate_is_apart */
  size_t figures; /* of a corrector */
  hk_own_figure figure[HK_OWN_FIGURES];
} hk_plugin_time;

/* A copy of X, ids and masses. */
typedef struct hk_snapshot {
  double t;
  size_t n, size, capacity; /* capacity: both the doubles of X and the particles of id and mass */
  double *X;
  uint32_t *id;
  double *mass;
} hk_snapshot;

/* Positions and channels of a run at its frames, and at its end, for the comparison with other runs. */
typedef struct hk_trajectory {
  size_t moments, room; /* moments kept, and allocated */
  struct hk_moment *moment;
  double *value; /* of all moments, one after the other: ids, positions (n x 3), channels */
  size_t size, capacity;
  size_t width;  /* numbers of a particle in `value`: its id, x, y, z, channels */
  size_t stride; /* every stride-th frame is kept, so that the memory is bounded */
} hk_trajectory;

/* ---- snapshot.c ---- */

hk_status hk_snapshot_take(hk_snapshot *, const hk_state *, hk_error *error);
void hk_snapshot_free(hk_snapshot *);

/* ---- trajectory.c ---- */

/* Keeps the state, which is that of frame number `frame`; with `always`, also where only every second frame is kept. */
hk_status hk_trajectory_note(hk_trajectory *, const hk_state *, size_t frame, bool always, hk_error *error);
void hk_trajectory_free(hk_trajectory *);
/* For checkpoints, which hold `moment` (so many bytes), then `value`. Restoring reads both by `get`; without `keep` it
 * only passes over them. `stated`: moments, size, width and stride; no id is next_id or above. False: they are not
 * there, or contradict each other, or there is no memory. */
size_t hk_trajectory_bytes(const hk_trajectory *);
bool hk_trajectory_restore(hk_trajectory *, bool keep, const hk_trajectory *stated, uint32_t next_id, void *from,
                           bool (*get)(void *from, void *data, size_t bytes));

/* How far two runs of a scene are apart. */
typedef struct hk_distance {
  double position; /* m, RMS over the particles, the largest of all moments; INFINITY: a run has no finite positions */
  double t;        /* s, the moment of the largest difference */
  double channel;  /* RMS of a channel's difference relative to the accuracy that it is to have, the largest */
  const char *channel_name;
} hk_distance;

/* Compares the moments from `from` to `until` (s) that both have. channel_accuracy: one per channel. Where the
 * particles are not the same, or no moment is, `position` is NAN. */
hk_distance hk_trajectory_distance(const hk_trajectory *, const hk_trajectory *, const hk_scene *,
                                   const double *channel_accuracy, double from, double until);
double hk_trajectory_time(const hk_trajectory *, double part); /* s, after this part of the moments (some) */
/* m, how far the particles get from their start, RMS, at most. */
double hk_trajectory_motion(const hk_trajectory *);
/* m, RMS: the distance of the particles from their first moment; 0 where others are there. */
double hk_trajectory_reach(const hk_trajectory *, const hk_state *);
/* x and v (m, m/s) of a particle at t, with v linear between the middles of two moments, about as x is. False: it was
 * not there at the moments around t. */
bool hk_trajectory_place(const hk_trajectory *, uint32_t id, double t, double x[3], double v[3]);
/* How far a channel gets from its start, RMS, at most. NAN: the moments have other channels than the scene. */
double hk_trajectory_channel_change(const hk_trajectory *, const hk_scene *, size_t channel);

/* ---- figures.c: energies and momenta of a frame, and the error against a known solution ---- */

/* Fills judgement->last_frame and the record; keeps a snapshot of a plausible state. `caller`: passed to measures. */
hk_status hk_figures_take(hk_loop *, hk_judgement *, const void *caller);
/* The scene's measures of the present state, which is not that of a frame where a run stopped between two. */
hk_status hk_figures_measure(hk_loop *, hk_judgement *, const void *caller);
/* *error: m, RMS over the particles whose positions the scene's `exact` gives; NAN: there is none. On a failure of that
 * function it is NAN, too, and `cause` says why. */
hk_status hk_figures_exact(const hk_scene *, hk_loop *, double *error, hk_error *cause);
/* Before a run: whether `exact` gives positions at its end at all, as many as there are particles at most. */
hk_status hk_figures_check_exact(const hk_scene *, size_t n, double end, hk_error *cause);
/* m, how far the exact solution takes the particles from their start by `end`, RMS, at most; NAN: not known. */
double hk_figures_exact_motion(const hk_scene *, hk_loop *, double end);

/* ---- under_resolved.c: motion that implicit steps do not resolve. Called before and after a sampled step ---- */

void hk_under_resolved_before(hk_loop *, hk_judgement *);
void hk_under_resolved_after(hk_loop *, hk_judgement *, double h);
double hk_under_resolved_error(hk_judgement *); /* m, the median of the samples; 0 without samples */

/* ---- given_speeds.c ---- */

/* Warns of a path of a pin whose velocities, from now to `end` (s), are not the derivatives of its positions. */
void hk_check_given_speeds(hk_loop *, double end);

/* ---- under_sampled.c ---- */

enum { HK_SAMPLING_PIECES = 500, HK_SAMPLING_JUMPS = 100 };

/* What random samples of the functions of time, of forces, constraints, correctors and pins, say of the run so far. */
typedef struct hk_sampling {
  bool varies;       /* a function varies between the times at which the run evaluated it */
  double shortest;   /* s, of such variation as was seen: a pulse's length, half a period; INFINITY: none */
  double begin, end; /* s, first time in which that function does so */
  const char *where, *label, *name; /* script line, plugin and parameter of that function; NULL: none varies */
  /* s: what was assumed: no pulse is shorter than this; `declared` where that is larger. 0: there are no functions */
  double assumed;
  double declared;     /* s, shortest `fastest` of the script; INFINITY: none */
  bool too_dear;       /* a declared time was too short to be sampled: `assumed` is what was */
  bool steps_too_long; /* the run has steps longer than a declared time */
  size_t calls;        /* of functions */
  size_t pieces;
  double piece[HK_SAMPLING_PIECES][2]; /* s, begin and end of the times of such variation */
  bool more;                           /* there are more of them */
  size_t jumps;                        /* of functions; some are listed: times before and after, s */
  double jump[HK_SAMPLING_JUMPS][2];
} hk_sampling;

/* most_calls: of all functions for which the script declares no shortest time; some 0.3 us each. Functions of the state
 * are sampled along the trajectory, or where particles are at the end (NULL). */
hk_sampling hk_under_sampled(hk_loop *, const hk_trajectory *, size_t most_calls);
/* Warns where the steps of a fixed-step method are longer than the shortest time that the script declares. */
void hk_warn_of_long_steps(hk_loop *);
/* The begins and ends of such variation, and of jumps unless there are more than are listed, in the order of time,
 * without repetition, at most `room`; their number. A begin is just before the first change and an end just after the
 * last one, so that a method that ends a step at each has steps of its own for every pulse. Where a pulse rises by a
 * jump it still needs several: the first and the last have a jump. */
size_t hk_sampling_cuts(const hk_sampling *, double *times, size_t room);

/* ---- missed_encounters.c: forces of short range that steps pass by ---- */

/* After a step of h s from the positions in loop->X_before: adds what it passed by to the record. Ends its own calls
 * (loop->hooks.moved) once no force has encounters. */
void hk_missed_encounters_note(hk_loop *, double h);
bool hk_missed_encounters_asks(const hk_loop *);    /* a force of the scene states its encounters */
double hk_missed_encounters_error(const hk_loop *); /* m, RMS over the particles, at the present time */

/* ---- own_damping.c ---- */

/* s, see hk_summary; by the growth factors of methods that damp what they do not resolve and estimate no errors. */
double hk_damps_below(const hk_loop *);
/* s: what swings faster than that has lost half of its amplitude by the present time. */
double hk_damps_by_now(const hk_loop *);

/* ---- force_errors.c ---- */

void hk_by_hand_note(hk_loop *);      /* at a frame and at the end: asks forces that a user's hand moves for its work */
void hk_force_errors_note(hk_loop *); /* at a frame: asks forces that are approximations for their errors */

/* ---- contacts.c ---- */

/* At a frame: counts intersections, as plugins report them. HK_BAD_PARAM: some at the start, which nobody removes. */
hk_status hk_contacts_note(hk_loop *);

/* ---- summary.c: the figures of a run ---- */

typedef struct hk_summary {
  const char *scene, *integrator;
  const char *origin;         /* what the scene was made from (scene/origin.c); NULL: not known */
  const char *solver;         /* solver of linear systems; NULL: the run solved none */
  const char *solver_choice;  /* "chosen for the forces and the size", ...; "": named by the script or the user */
  char solver_libraries[160]; /* text of hk_solver.describe; "" without one, or when no system was solved */
  hk_verdict verdict;
  const char *verdict_name;
  char reason[1024];  /* why it is not ok; "" otherwise */
  char checked[512];  /* what the verdict ok rests on, and what was not checked; "" otherwise */
  char remedy[384];   /* which step or tolerance would do, where it is inaccurate; "" otherwise */
  double t, end, fps; /* s, s, 1/s: time reached, end of the run, frame rate */
  size_t n, steps, frames, rejected_steps, late_impacts;
  size_t force_evaluations, jacobian_evaluations, factorizations, linear_iterations;
  double dt_min, dt_max, dt_limit; /* s; dt_limit: the smallest of all estimated largest stable steps; NAN: not known */
  bool dt_chosen;
  char step[128]; /* dt_min, dt_max and dt_limit in words; "" before the first step */
  double wall_s, step_wall_s, start_wall_s, steps_per_s;       /* start_wall_s: from opening to the first step */
  double energy_first, energy_last, energy_work, energy_drift; /* J, J, J, relative; NAN: not known */
  double kinetic_max, kinetic_rounding; /* J; the latter: of moves that are rounding errors of positions, in a step */
  double kinetic_mean;                  /* J, over the frames */
  double damps_below; /* s: what swings faster loses half its amplitude or more in each swing, by the method alone; NAN:
                         its damping is not what it is for */
  double momentum_drift;       /* relative to the largest sum of m |v|; NAN: the scene does not conserve momentum */
  double constraint_violation; /* m, of constraints and of what correctors keep */
  double max_strain;           /* NAN: no elements */
  double exact_error;          /* m, RMS at the end; NAN: no exact solution */
  double force_rms, force_p99, force_largest; /* relative errors of approximate forces; NAN: there are none */
  double force_work;                          /* J, of these errors at most; 0: there are none */
  /* Of the contact of surfaces; NAN: no plugin reports it. Frames with a count; intersections that count against the
   * run; those of the start; m, the least gap; N s; J */
  double contact_frames, intersections, intersections_first, closest, impulse, impact_energy;
  double hand_work;         /* J, of the user's hand; NAN: it did nothing */
  double path_speed_error;  /* m/s, largest estimated error of a pin's velocity; NAN: no path's is estimated */
  double accuracy;          /* m, accuracy asked for; NAN: none */
  size_t accuracies;        /* how many were asked for: of the positions, and of channels */
  double verify_difference; /* m, RMS difference to half the step from a perturbed start; NAN: not verified */
  double error_estimate;    /* m, of the positions: RMS over the particles, the largest of all frames; NAN: none */
  double channel_error;     /* estimated error of the worst channel relative to its accuracy; NAN: none asked */
  double check_wall_s;      /* s, time of the runs that this one was compared with; NAN: none */
  size_t plugins;
  const hk_plugin_time *plugin; /* valid until the next summary of the run */
  size_t measures;
  const char *const *measure_name, *const *measure_unit;
  const double *measure;
  size_t warnings;
  char **warning;
} hk_summary;

/* What the user asked of the run, and when the run was opened. */
typedef struct hk_asked {
  double end;        /* s */
  double accuracy;   /* m; NAN: none */
  bool at_end;       /* the accuracy holds at the end only, not at every frame */
  double opened_at;  /* s, wall */
  bool ignore_exact; /* judge as if the scene had no exact solution */
} hk_asked;

/* The figures of a run without its verdict. */
void hk_summary_measure(hk_loop *, hk_judgement *, const hk_asked *, hk_summary *);
const char *hk_verdict_name(hk_verdict); /* "ok", "inaccurate", "diverged", "interrupted" */

/* ---- figure_table.c: the table of a summary's figures, from which the text, JSON and Lua reports are made ---- */

typedef enum hk_figure_type {
  HK_FIGURE_TEXT,   /* const char *; NULL: no text */
  HK_FIGURE_BUFFER, /* char[] */
  HK_FIGURE_COUNT,  /* size_t */
  HK_FIGURE_NUMBER  /* double; NAN: not known */
} hk_figure_type;

typedef struct hk_figure {
  const char *group; /* key of the enclosing JSON object, such as "energy"; NULL: the summary itself */
  const char *key;
  hk_figure_type type;
  size_t offset; /* in hk_summary */
  /* For the text report. label: the label of a new line; NULL: the figure continues the line before. format: the printf
   * format of the figure; NULL: the text report omits it. */
  const char *label, *format;
} hk_figure;

extern const hk_figure hk_figure_table[]; /* a NULL key ends the table */

/* ---- verdict.c: the verdict, a pure function of what a run measured and what comparisons showed ---- */

/* What can be seen, and what cannot be trusted any more. */
typedef struct hk_limits {
  double visible; /* of the motion, or of the largest kinetic energy: seen in any picture, while the energy error of a
                     symplectic method at 0.9 of its stable limit stays below it on cloth */
  double mean_energy; /* of the mean kinetic energy */
  double unresolved;  /* of the extent, in a step */
  double violation;   /* m, of constraints, but no more than `violated` and no less than `rounding` of the extent */
  double violated;    /* of the extent */
  double tolerance;   /* largest error estimate of a step relative to its tolerance */
  double rounding;    /* of the extent: what stands still has no motion to compare with */
} hk_limits;

extern const hk_limits hk_limit;

typedef enum hk_fault {
  HK_STEP_UNSTABLE,        /* s, above the stable limit */
  HK_ENERGY_NOT_FINITE,    /* J */
  HK_ENERGY_OF_LARGEST,    /* J, energy that came or went without a cause: of the largest kinetic energy */
  HK_ENERGY_OF_MEAN,       /* J, of the mean kinetic energy */
  HK_CONTACT_ENERGY,       /* J, that contact gave while nothing was driven */
  HK_UNRESOLVED,           /* m, in a step */
  HK_ENCOUNTER,            /* m, at the end: a force of short range that steps pass by */
  HK_ABOVE_TOLERANCE,      /* error estimate of a step, relative */
  HK_EXACT_VISIBLE,        /* m, against the exact solution */
  HK_VIOLATION,            /* m, of constraints */
  HK_INTERSECTIONS,        /* of surfaces */
  HK_EXACT_FAILED,         /* the function that gives the exact solution */
  HK_BY_HAND,              /* J: an accuracy was asked for, and no other run repeats what a hand did */
  HK_NOT_CHECKED,          /* no comparison was possible, though an accuracy was asked for, or for want of memory */
  HK_ERROR,                /* relative to what is allowed, by comparison with other runs */
  HK_DAMPED,               /* m, by swings that both runs damp */
  HK_PULSE,                /* s: a function of time that acts between evaluations */
  HK_EXACT_ABOVE_ACCURACY, /* m */
  HK_OWN_FIGURE,           /* a corrector's, above its limit; in its own unit */
  HK_FAULTS
} hk_fault;

typedef struct hk_finding {
  hk_fault fault;
  double value;  /* in the unit of the fault */
  double excess; /* how many times above what is allowed, in a figure that goes with step^order; NAN: in none */
  double order;
} hk_finding;

typedef struct hk_opinion {
  hk_verdict verdict; /* ok or inaccurate */
  size_t count;
  hk_finding finding[HK_FAULTS];
} hk_opinion;

/* What a run measured. */
typedef struct hk_evidence {
  const hk_summary *figures; /* without its verdict and words, which are not read */
  const hk_record *record;
  unsigned method; /* flags of the integrator */
  int order;       /* of the integrator */
  bool growth_expected, ignore_exact, exact_failed;
  bool abrupt; /* there are impacts, or other changes within a step: the order may be 1, whatever the method's is */
  double extent, motion; /* m, of the scene; over which the particles move at most */
  double exact_motion;   /* m, over which the exact solution moves them; NAN: not known */
  double unresolved;     /* m, local error by the change of accelerations */
  double missed;         /* m, RMS at the end: what was missed of forces of short range */
} hk_evidence;

/* A step or a tolerance with which a run may be ok; 0: not that, or none is known. */
typedef struct hk_remedy {
  double dt, tol;
  bool tried, ok; /* a run with it was judged, and is ok */
} hk_remedy;

/* What other runs of the scene showed (run/verify.c). */
typedef struct hk_comparisons {
  bool tried;     /* the error is judged by them */
  bool reference; /* it is that to an independent method */
  bool not_begun; /* there was no memory for them */
  bool energy_converges;
  double error;            /* relative to what is asked, or to what is visible; NAN: not known */
  double position, at;     /* m, RMS, at the moment s of the largest difference; NAN: not known */
  const char *channel;     /* whose error is the largest; NULL: that of the positions is */
  double channel_accuracy; /* asked for that channel; 0: none was */
  double channel_error;    /* of the worst channel relative to its accuracy; NAN: none was asked for */
  double order;      /* in which half the step is nearer to the reference, or the quarter to the half; NAN: not seen */
  double damped;     /* m: how far energy that both runs damp would have taken the particles */
  double difference; /* m, RMS, to half the step; NAN: not taken */
  double wall_s;     /* s, time of all of these runs; NAN: none */
  char how[160];
  hk_sampling sampling; /* of functions of time */
  hk_remedy remedy;     /* the last one that was tried */
} hk_comparisons;

static inline bool hk_above_limit(const hk_own_figure *f) { return fabs(f->value) > f->limit; }
bool hk_confirmed(const hk_comparisons *); /* an independent method agrees with the run */
/* The method was chosen without an accuracy, and damps what it does not resolve: that energy is missing is no fault;
 * that a reference measures an error of a tenth of the motion is one. */
bool hk_damps_as_chosen(const hk_summary *);
bool hk_damps_visibly(const hk_summary *); /* by so much that it would be a fault otherwise */
hk_opinion hk_verdict_find(const hk_evidence *, const hk_comparisons *);
/* J, what is no change of the energy that is held: the kinetic energy of a scene at rest is smaller than that, so that
 * nothing can be compared with it. */
double hk_energy_rounding(const hk_summary *);

/* ---- judgement.c ---- */

struct hk_judgement {
  const hk_scene *scene; /* what was run */
  hk_verdict verdict;
  char reason[1024];     /* of a run that diverged or was interrupted */
  hk_opinion opinion;    /* of a run that reached its end */
  hk_snapshot last_good; /* the last state whose energy was plausible */
  hk_frame last_frame;   /* figures of the last frame; its measures point into `measure` */
  double *measure;       /* one per measure of the scene */
  const char **measure_name, **measure_unit;
  hk_trajectory trajectory;
  bool keeps_trajectory; /* for comparisons with other runs */
  hk_comparisons comparisons;
  double exact_motion;    /* m, as in hk_evidence */
  char exact_cause[1024]; /* why the exact solution is not known; "" */
  /* under_resolved.c */
  double *slope[2]; /* the state's accelerations and channel rates at the two ends of a step */
  bool sampling;    /* hk_under_resolved_before was called and succeeded */
  size_t samples;
  double *unresolved;          /* m, local error, one per sample */
  hk_plugin_time *plugin_time; /* times of the last summary */
};

hk_status hk_judgement_open(hk_judgement *, const hk_scene *, hk_error *error);
void hk_judgement_close(hk_judgement *);
/* At the end, and after comparisons: finds the verdict. HK_SCRIPT, with loop->error: the exact solution failed. */
hk_status hk_judge(hk_loop *, hk_judgement *, const hk_asked *);
/* Whether something acts or ceases within steps (impacts, friction, correctors): a part of a run then shows little. */
bool hk_is_abrupt(const hk_loop *);
/* The figures with the verdict in words, at any time. Pointers are valid while the run is, `plugin` until the next. */
void hk_summary_take(hk_loop *, hk_judgement *, const hk_asked *, hk_summary *);

/* ---- findings.c, remedy.c: the words of a verdict ---- */

void hk_findings_describe(const hk_loop *, const hk_judgement *, hk_summary *); /* s->reason */
void hk_checked_describe(const hk_loop *, const hk_judgement *, hk_summary *);  /* s->checked, of a run that is ok */
/* s->remedy, where the run is inaccurate for want of a shorter step or a smaller tolerance. */
void hk_remedy_describe(hk_loop *, const hk_judgement *, hk_summary *);
/* The step or tolerance that the order asks for. */
hk_remedy hk_remedy_propose(const hk_loop *, const hk_judgement *, const hk_summary *);
/* The smallest tolerance to which the errors of an adaptive method's runs fall (facet adaptive). */
double hk_finest_tolerance(const hk_integrator *method);
/* stiffest.c: the label of the force that swings fastest at the present state, and 1/s; NULL: none swings. */
const char *hk_stiffest_force(hk_loop *, double *w);

/* ---- diagnosis.c ---- */

/* A run that diverged: names step, time, particle and force; returns the status. */
hk_status hk_diagnose(hk_loop *, hk_judgement *, hk_status cause);

#endif
