/* A run: one simulation of a scene. Opening a run makes the state and starts the plugins, advancing it takes time
 * steps, and closing it closes the outputs; a run that failed or was interrupted keeps its last good state. A scene may
 * have several runs, at the same time or one after the other. */
#ifndef HK_RUN_H
#define HK_RUN_H

#include "core/run/report/report.h"
#include "core/run/storage/storage.h"

enum { HK_COMPARE_ASKED, HK_COMPARE_SMALL, HK_COMPARE_ALWAYS }; /* where an accuracy is asked; in small scenes too */

typedef struct hk_run_options {
  const char *integrator; /* "name" or "name:parameter=value,..." replaces the scene's integrator; NULL: the scene's */
  const char *solver;     /* the same for the linear solver; "auto": chosen by the host */
  double dt, tol, until;  /* NAN: the scene's; dt INFINITY: none, whatever the scene gives */
  double accuracy; /* m, of the positions (RMS over the particles); NAN: the scene's; 0: no accuracy is asked for */
  const char *accuracy_at; /* "frames": at all of them, or "end"; NULL: the scene's choice */
  /* Keep the positions at the frames, so that hk_verify can compare them with other runs: HK_COMPARE_... */
  int compare;
  size_t step_limit; /* the run ends with HK_INTERRUPTED after this number of steps; 0: no limit */
  bool gives_up;     /* it also ends so where an eighth of them has shown that three times as many would be needed */
  double perturb; /* largest random offset of the start positions in each direction, relative to the scene's extent */
  uint64_t perturb_seed;
  size_t refine;  /* r > 0: 2rn + 1 steps replace n steps between two cuts, so no step of this run ends when one of the
                     first does */
  double dt_most; /* s, longest step of an adaptive method; 0: no limit */
  const double
      *cut; /* s, increasing: further times at which a step ends, from hk_sampling_cuts(); it outlives the run */
  size_t cuts;
  bool ignore_exact; /* the verdict does not use the scene's exact solution */
  size_t without_count;
  const char *const *without; /* labels of the plugins that are omitted from the scene */
  size_t with_count;
  const char *const *with; /* plugins beside those of the scene, "kind:name:parameter=value,..." */
  bool bare;               /* outputs among them are left out: another run is compared with this one */
  const char *out;         /* NULL: "out/NAME" */
  const char *resume;      /* checkpoint of the same scene, from which the run goes on; NULL: from the start */
  size_t change_count;
  const char *const *change; /* parameters that may have other values than in the checkpoint; "=VALUE" may follow */
  const char *words;         /* how the run was asked for, for its checkpoints (hk_checkpoint_take); NULL: not known */
  bool only_run;             /* of its scene, of which what the run has copied is freed then */
  bool no_output;
  const char *const (*taken)[2]; /* hk_folder_spare; NULL: none */
  bool draft;                    /* outputs may do with less quality (hk_draft) */
  int progress;                  /* negative: not even warnings; 0: quiet, 1: lines, 2: one line on a terminal */
  const volatile sig_atomic_t *interrupted; /* how often the user asked to stop; NULL: cannot */
  const hk_instance *volatile *acting;      /* is set to the plugin that is at work; NULL: nobody wants to know */
  const char *(*disturbed)(void);           /* hk_shared.disturbed, also asked at frames; NULL: nobody looks */
  void (*thread_ended)(void);               /* hk_threads_watch of the run's threads */
  /* Is given the last good state at every frame; NULL: nobody wants it. */
  void (*kept)(void *context, const hk_snapshot *last_good, const hk_state *);
  void *kept_context;
  const char *caution; /* a warning that the run begins with; NULL: none */
  int threads;         /* 0: the scene's */
  long allocations;    /* plugins get so many; 0: any number. For tests of what happens then */
  int lanes;           /* hk_host.lanes; 0: those of the processor. Tests try fewer */
} hk_run_options;

/* Checkpoints of the run under way, see saving.c. */
typedef struct hk_saving {
  hk_checkpoints table; /* what outputs call */
  bool served;          /* an output asked for the table */
  bool asked;           /* for a point after this frame, on `path`; "": in memory only */
  bool on_file;         /* the point is written */
  char path[4096];
  hk_checkpoint point; /* the last one; empty: none */
  char *origin;        /* of scene and plugins; NULL: not needed */
} hk_saving;

typedef struct hk_run {
  const hk_scene *scene;
  hk_run_options options;
  hk_error error; /* where host->fail writes */
  hk_warnings warnings;
  hk_shared shared;
  hk_overrides overrides;
  hk_plugins plugins;
  hk_plugin_spec **service_spec; /* specs of the services that plugins asked for */
  size_t services;
  hk_state state;
  hk_pins pins;
  hk_dynamics dynamics;
  struct hk_step_choice *step; /* core/numerics/step_choice */
  hk_loop loop;
  hk_record record;       /* the measured data from which the verdict is derived; checkpoints contain all of it */
  hk_judgement judgement; /* verdict, reason, last good state */
  hk_asked asked;
  hk_progress progress;
  hk_folder *folder;
  FILE *measures;
  size_t outputs_open;
  const char **force_name; /* labels of the forces, for outputs */
  hk_saving saving;
  hk_interruption interruption;
  sig_atomic_t interruptions; /* before the outputs began to be closed */
  bool resumed;               /* the run was continued from a checkpoint */
  double pins_jump;           /* m, by which pins were elsewhere there than they are by the scene as it is now */
  bool closed;
} hk_run;

/* ---- open.c ---- */

hk_status hk_run_open(hk_scene *, const hk_run_options *, hk_run **run, hk_error *error);
void hk_run_destroy(hk_run *);

/* ---- plugins.c ---- */

hk_status hk_run_make_plugins(hk_run *);  /* an instance of each, of which no code has run */
hk_status hk_run_start_plugins(hk_run *); /* creates all of them */
const void *hk_run_query(void *run, const char *service);
void hk_warn_of_unused_services(hk_run *); /* that the scene names */

/* ---- start.c: pins and constraints of the start ---- */

hk_status hk_run_impose_start(hk_run *);

/* ---- run.c ---- */

/* Takes steps up to time t; measures and outputs get the frames before t. May be called again with a later t.
 * HK_NOT_FINITE and HK_NOT_CONVERGED: the run diverged; HK_INTERRUPTED: the state is that of the time of
 * interruption. */
hk_status hk_run_advance(hk_run *, double t, hk_error *error);
/* Closes the outputs; a second call does nothing. The run's data stay readable until hk_run_destroy, and the output
 * folder is the run's until then or until hk_run_write_summary. */
hk_status hk_run_close(hk_run *, hk_error *error);
bool hk_run_interrupted_again(void *run); /* since then */
void hk_run_summary(hk_run *, hk_summary *);
/* Writes the final (or last good) state as a table; hk_run_save (saving.c) writes all that a continued run needs. */
hk_status hk_run_write_state(hk_run *, const char *path, hk_error *error);

/* Queries for script callbacks and for results. Indices of the view are particle indices. */
const hk_view *hk_run_view(hk_run *);
double hk_run_end(const hk_run *); /* s, duration or --until */
bool hk_run_index(const hk_run *, uint32_t id, uint32_t *index);
void hk_run_energy(hk_run *, double *kinetic, double *potential, double *work);
/* The force of force k alone on all particles (n x 3, N) at the state; 0 where it does not act now. */
hk_status hk_run_forces(hk_run *, size_t k, double *force, hk_error *error);
hk_status hk_run_force(hk_run *, const char *label, uint32_t id, double force[3], hk_error *error);
/* The number of equations of a constraint; HK_BAD_PARAM: no constraint has this label. */
hk_status hk_run_equations(hk_run *, const char *label, size_t *count, hk_error *error);
/* Their multipliers at the state, N: the force of an equation, in the direction in which g grows. */
hk_status hk_run_constraint_forces(hk_run *, const char *label, double *force, hk_error *error);
hk_status hk_run_bar_forces(hk_run *, const hk_pair_forces *into, hk_error *error); /* hk_frame.bar_forces */
/* The largest strain by magnitude, C over the rest value of an element; label NULL: of all forces with elements. */
hk_status hk_run_strain(hk_run *, const char *label, double *largest, hk_error *error);

/* ---- frame.c: figures, measures, on_frame, outputs ---- */

hk_status hk_run_frame(void *run);
hk_frame hk_run_output_frame(hk_run *); /* the last frame with what outputs may ask beside its figures */
hk_status hk_run_name_forces(hk_run *); /* once the plugins have been made */

/* ---- write_summary.c: the last file ---- */

/* After hk_run_close: where the run has written files, summary.json comes beside them, the summary as JSON (NULL: as it
 * is now), and the output folder is let go of. A second call writes it again, unless another run has begun there. */
hk_status hk_run_write_summary(hk_run *, const hk_summary *, hk_error *error);

/* ---- saving.c: the checkpoints that outputs ask for ---- */

hk_status hk_run_save(hk_run *, const char *path, hk_error *error);
hk_status hk_run_framed(void *run);       /* after a frame */
hk_status hk_run_begin_saving(hk_run *);  /* once the plugins have started */
const void *hk_run_checkpoints(hk_run *); /* "checkpoint/1" */
void hk_run_end_saving(hk_run *);

/* ---- comparison_run.c: the scene of a run, run again with other options ---- */

typedef struct hk_scene_loader { /* functions that open the scene of a run a second time */
  /* HK_OK: `again` is a run of the same scene, opened with these options. */
  hk_status (*open)(void *context, const hk_run_options *, hk_run **again, hk_error *);
  /* Called once after `open`, also after a failed one (`again` is then NULL): destroys the second run and its scene. */
  void (*close)(void *context, hk_run *again);
  void *context;
} hk_scene_loader;

typedef struct hk_comparison_run {
  const char *method;  /* its integrator */
  double tol;          /* of an adaptive method */
  double reserve;      /* of a reference: what it leaves of the accuracy, for its own error */
  double perturbation; /* of a reference: of the start, relative to the extent */
  hk_trajectory trajectory;
  double reach;           /* m, see hk_record */
  double energy_defect;   /* J, energy that is missing or too much, see hk_energy_defect */
  double kinetic;         /* J, the largest */
  size_t steps;           /* that it took or took back, also where it failed */
  double step;            /* longest step relative to that of the first run */
  double missed;          /* m, what its own steps may have missed of encounters */
  double swings, fastest; /* 1/s: a frequency that its scene has, and one above which it has none */
  double damped, damping; /* 1/s: that one is damped by so much at least, and none by more than the latter */
} hk_comparison_run;

/* Runs the scene of `whole` until t = `until`, s. The caller frees the trajectory, also after a failure, when it has
 * the frames up to there. */
hk_status hk_comparison_run_take(const hk_scene_loader *, const hk_run_options *, const hk_run *whole, double until,
                                 hk_comparison_run *, hk_error *error);
double hk_energy_defect(const hk_summary *); /* J, the energy drift; an excess is positive */
/* Options of a run that another one is compared with: from a start off by 1e-14 of the extent, with the positions at
 * its frames, without outputs, messages and kept states. */
hk_run_options hk_comparison_run_options(const hk_run_options *first, uint64_t seed);

/* ---- reference.c: a run with an independent method, an adaptive one of high order ---- */

typedef enum hk_effort {
  HK_EFFORT_LEAST,  /* a fifth of the run's own cost, or some hundredths of a second: nobody has asked for it */
  HK_EFFORT_SMALL,  /* less than half the run's own cost, or some hundredths of a second */
  HK_EFFORT_MEDIUM, /* the same, or some tenths of a second */
  HK_EFFORT_LARGE   /* several times the run's cost; where a cheaper check leaves doubts */
} hk_effort;

typedef struct hk_reference {
  double relative;  /* the accuracy relative to the motion; the tolerance is far below it */
  double dt_most;   /* s, its longest step; INFINITY: the method's choice */
  double frequency; /* 1/s, the largest of the scene, where it is known; 0 */
  hk_effort effort;
  bool coarse; /* a coarser reference will do where a strict one takes too many steps */
  /* 0: the whole run. Otherwise this part of its frames, or fewer, at least one beyond the start, where the steps that
   * it may take are used up. */
  double beginning;
} hk_reference;

/* True: an adaptive method, explicit or else implicit, has integrated the scene of `whole` to its end, or over the
 * beginning that was wanted. False: it would
 * take more than the effort, or the scene is not to be integrated by a method that chooses its steps. */
bool hk_reference_take(const hk_scene_loader *, const hk_run_options *first, const hk_run *whole, const hk_reference *,
                       hk_comparison_run *);

/* Whether so many runs like `whole` cost no more than a reference may (counted in evaluations, never by a clock). */
bool hk_reference_affords(const hk_run *whole, double runs, hk_effort);

/* ---- unused_options.c ---- */

void hk_warn_of_unused_options(hk_run *); /* which have no effect on this run */

/* ---- no_effect.c ---- */

void hk_warn_of_no_effect(hk_run *); /* parts of the scene; once the plugins have started */

/* ---- runtime_estimate.c: how long a run will take ---- */

/* To be called before the first step. Prints, where a run will take longer than 10 s, how long, by steps that another
 * run of the scene takes; and where steps of an explicit method would come by the ten million, how long those of an
 * implicit method would take. `first`: the options of `whole`. */
void hk_runtime_estimate(const hk_scene_loader *, const hk_run_options *first, hk_run *whole);

/* ---- verify.c: the comparison of a run with others, see there ---- */

/* Compares `whole`, a run that reached its end, with other runs of its scene: with half the step where an accuracy is
 * asked for or `half` says so, and with an independent method. Fills the estimates of the summary, and changes its
 * verdict. HK_OK, or the failure of the run with half the step: the verdict is then `inaccurate` where an accuracy was
 * asked for. `first`: the options of `whole`. */
hk_status hk_verify(const hk_scene_loader *, const hk_run_options *first, bool half, hk_run *whole, hk_summary *summary,
                    hk_error *error);

/* After hk_verify has called `whole` inaccurate: runs the scene with the step or the tolerance that would do, and
 * judges that run as it would be (up to three of them, each with what the one before asks for). They cost no more than
 * the run and its comparisons did; where surfaces are in contact, whose errors follow no order, eight times as much, up
 * to 100 s. What was found is in the judgement of `whole`. */
void hk_remedy_try(const hk_scene_loader *, const hk_run_options *first, hk_run *whole, hk_summary *);

#endif
