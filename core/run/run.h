/* A run: a scene in motion. Opening makes the state and starts the plugins, advancing takes steps, closing ends the
 * outputs; a run that failed or was interrupted keeps its last good state. A scene may have several runs, side by side
 * or one after the other. */
#ifndef HK_RUN_H
#define HK_RUN_H

#include "core/report/report.h"
#include "core/storage/storage.h"

typedef struct hk_run_options {
  const char *integrator; /* "name" or "name:parameter=value,..." replaces the scene's choice; NULL: keep */
  const char *solver;     /* the same; "auto": chosen */
  double dt, tol, until;  /* NAN: the scene's */
  double accuracy;        /* m, of the positions at the end (RMS); NAN: the scene's; 0: none is asked for */
  size_t step_limit;      /* HK_INTERRUPTED after so many steps; 0: none */
  double perturb;         /* start positions are off by up to this part of the scene's extent in every direction */
  uint64_t perturb_seed;
  size_t refine;     /* r > 0: n steps between two cuts become 2rn + 1: finer, and never in step with the first run */
  double dt_most;    /* s, longest step of an adaptive method; 0: any */
  bool ignore_exact; /* judge without the scene's exact solution, as one without it is judged */
  size_t without_count;
  const char *const *without; /* labels of what is left out of the scene */
  const char *out;            /* NULL: "out/NAME" */
  bool no_output;
  int progress; /* negative: not even warnings; 0: quiet, 1: lines, 2: one line on a terminal */
  const volatile sig_atomic_t *interrupted; /* NULL: cannot be */
  int threads;                              /* 0: the scene's */
  long allocations;                         /* plugins get so many; 0: any number. For tests of what happens then */
} hk_run_options;

typedef struct hk_run {
  const hk_scene *scene;
  hk_run_options options;
  hk_error error; /* where host->fail writes */
  hk_warnings warnings;
  hk_shared shared;
  hk_overrides overrides;
  hk_plugins plugins;
  hk_plugin_spec **service_spec; /* of services that plugins asked for */
  size_t services;
  hk_state state;
  hk_pins pins;
  hk_dynamics dynamics;
  hk_step_choice step;
  hk_loop loop;
  hk_record record;       /* what a verdict rests on; saved whole in checkpoints */
  hk_judgement judgement; /* verdict, reason, last good state */
  hk_asked asked;
  hk_progress progress;
  hk_folder *folder;
  FILE *measures;
  size_t outputs_open;
  bool resumed; /* went on from a checkpoint */
  bool closed;
} hk_run;

/* ---- open.c ---- */

hk_status hk_run_open(hk_scene *, const hk_run_options *, hk_run **run, hk_error *error);
void hk_run_destroy(hk_run *);

/* ---- run.c ---- */

/* Steps to time t (frames on the way are shown to measures and outputs). May be called again with a later t.
 * HK_NOT_FINITE and HK_NOT_CONVERGED: diverged; HK_INTERRUPTED: the state is where it stopped. */
hk_status hk_run_advance(hk_run *, double t, hk_error *error);
/* Closes outputs; once. The run's data stay readable until hk_run_destroy. */
hk_status hk_run_close(hk_run *, hk_error *error);
void hk_run_summary(hk_run *, hk_summary *);
/* Final (or last good) state as a table; everything that goes on, as a checkpoint. */
hk_status hk_run_write_state(hk_run *, const char *path, hk_error *error);
hk_status hk_run_save(hk_run *, const char *path, hk_error *error);

/* For callbacks of scripts and for results. Indices of the view are particle indices. */
const hk_view *hk_run_view(hk_run *);
double hk_run_end(const hk_run *); /* s, duration or --until */
bool hk_run_index(const hk_run *, uint32_t id, uint32_t *index);
double hk_run_measure(const hk_run *, const char *name); /* last value; NAN: there is none of that name */
void hk_run_energy(hk_run *, double *kinetic, double *potential, double *work);
hk_status hk_run_force(hk_run *, const char *label, uint32_t id, double force[3], hk_error *error);
/* C over the rest value, the largest by magnitude; label NULL: of all forces with elements. */
hk_status hk_run_strain(hk_run *, const char *label, double *largest, hk_error *error);

/* ---- frame.c: figures, measures, on_frame, outputs ---- */

hk_status hk_run_frame(void *run);

/* ---- verify.c: the cheapest honest error bar, for any scene: the run again, with less than half the step (n steps of
 * a frame become 2n + 1, so that what is in step with the first run is not with the second; an adaptive method: a tenth
 * of the tolerance and at most half its longest step), from start positions perturbed by 1e-10 of the scene's extent.
 * The first shows what the step costs: a method of order 1 is off by twice the difference, one of a higher order by
 * less, and twice the difference is held against the accuracy. The second shows a motion that nobody can know, such as
 * a strut that is balanced on its buckling load ---- */

typedef struct hk_reopen { /* how the scene of a run is opened a second time */
  /* HK_OK: `again` is a run of the same scene, opened with these options. */
  hk_status (*open)(void *context, const hk_run_options *, hk_run **again, hk_error *);
  /* Called once after `open`, even a failed one (`again` is NULL then): destroys the run and what it was made of. */
  void (*close)(void *context, hk_run *again);
  void *context;
} hk_reopen;

/* Fills `verify_difference` of the summary of `whole`, a run that went to its end; where an accuracy is asked for and
 * twice the difference is above it, the verdict becomes `inaccurate` and the reason says so. It also does when the
 * second run fails: then the difference is NAN, and `error` has the cause. `run` are the options of the first run. */
hk_status hk_verify(const hk_reopen *, const hk_run_options *run, hk_run *whole, hk_summary *summary, hk_error *error);

#endif
