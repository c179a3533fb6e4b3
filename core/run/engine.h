/* A run from the inside: what the parts of the engine share. Only core/ includes this.
 *
 *   choose.c       what the command line changes in the scene
 *   state.c        the vector X, ids and masses
 *   population.c   births and deaths
 *   pins.c         imposing and filtering
 *   system.c       f(X, t): the sum of forces, what integrators see
 *   constraint.c   multipliers
 *   constraint_matrix.c  the matrix of the multipliers
 *   jacobian.c     K and D in blocks
 *   implicit.c     the matrix of an implicit step; the scene's solver
 *   linear.c, block_matrix.c  a solver with its matrix; patterns of blocks
 *   step.c         the choice of the step
 *   loop.c         the order of a step, frames and events
 *   energy.c       energy, momentum, strain
 *   resolve.c      what implicit steps do not resolve
 *   unseen.c       what changes in time between the steps
 *   verdict.c      what went wrong and where
 *   run.c          opening and closing
 *   folder.c       the output folder
 *   save.c         state files and checkpoints
 *   summary.c      the figures of a run */
#ifndef HK_ENGINE_H
#define HK_ENGINE_H

#include "core/base/error.h"
#include "core/run/run.h"
#include "core/scene/scene.h"
#include "core/stability/spectrum.h"
#include "core/stability/largest_step.h"
#include <stdio.h>

typedef struct hk_pin_state {
  const hk_pin_spec *spec;
  bool released;
  size_t count;
  uint32_t *index;
  double *origin; /* count x 3, start positions */
} hk_pin_state;

typedef struct hk_constraints hk_constraints;         /* constraint.c */
typedef struct hk_implicit_matrix hk_implicit_matrix; /* jacobian.c */
typedef struct hk_folder hk_folder;                   /* folder.c */

/* What makes the state: X with who is in it. Also kept as the last good one. */
typedef struct hk_snapshot {
  double t;
  size_t n, size, capacity; /* capacity of X in doubles, and of id and mass in particles: as large as needed */
  double *X;
  uint32_t *id;
  double *mass;
} hk_snapshot;

struct hk_run {
  hk_system system; /* first member: services given a system find the run */
  hk_scene *scene;
  hk_run_options options;
  hk_error error; /* where host->fail writes */
  double end;     /* s */

  /* state.c */
  hk_model model;
  double *mass, *inverse_mass;
  uint32_t *id, *group;
  uint8_t *pin;
  uint32_t next_id;
  size_t width; /* channel numbers per particle: size = (6 + width) n + 1 */
  hk_channel *channel;
  hk_element_list *element_list;
  uint32_t (*edge)[2];
  uint32_t (*triangle)[3];
  double *X;
  hk_view view;        /* of X at system.t, for everyone but forces */
  hk_view *force_view; /* one per force, with its own host and selection */
  bool *force_acts;    /* one per force: inside its from..to in this segment */

  /* pins.c */
  size_t pins;
  hk_pin_state *pin_state;
  bool has_paths, has_slides, has_timed;
  double imposed_t; /* NAN: none */

  /* system.c */
  size_t evaluations, jacobians, factorizations, linear_iterations;
  bool *takes;               /* one per force: system.takes */
  hk_force_info *force_info; /* one per force: system.force */
  bool solver_chosen;        /* the scene names none */
  uint64_t *chunk_bad;       /* one word per chunk of particles: not finite */
  double *slope[2];          /* resolve.c: n x 3 each, with the channels' rates behind */
  double *works_unaccounted; /* n x 3, the F of one force alone; NULL: none has to be */

  hk_constraints *constraints;  /* NULL: the scene has none */
  hk_implicit_matrix *assembly; /* NULL until a Jacobian is asked for */
  hk_folder *folder;
  FILE *measures_file;
  double progress_at;

  /* step.c, loop.c */
  const hk_integrator *method;
  hk_spectrum spectrum;
  double dt_suggested;  /* s, from the last estimate */
  size_t estimate_cost; /* evaluations */
  double dt;            /* s, no step is longer; adaptive methods: what they would take next */
  double dt_limit;      /* s, largest stable step; INFINITY: none, NAN: not known */
  double limit_now;     /* the same, as last estimated; dt_limit is the least so far */
  double dt_beyond;     /* s, the longest step taken above the limit of its time; 0: none */
  bool dt_chosen, growth_expected;
  double growth_rate;
  size_t estimated_at; /* evaluations when the limit was last estimated */
  double last_h;
  size_t frame, steps; /* frames shown, steps taken */
  double dt_min, dt_max;
  double *x_before;        /* n x 3, for correctors that want it */
  bool resumed;            /* went on from a checkpoint */
  bool emitted;            /* sources have been asked for the coming step */
  bool corrected, sourced; /* the energy balance is not known */
  double worst_error;      /* largest error estimate relative to tol of accepted steps */

  /* energy.c */
  double energy_first, kinetic_max, momentum_first[3], momentum_scale;
  hk_frame last_frame; /* the last frame's figures */
  double *measure;
  const char **measure_name;
  double violation_max, strain_max;
  bool energy_converges; /* its drift was seen to vanish with the step */
  bool sampling;         /* resolve.c: between begin and end */
  size_t samples;
  double *unresolved; /* m, one per look, see resolve.c */

  /* verdict.c */
  hk_snapshot last_good;
  hk_verdict verdict;
  char reason[1024];
  size_t warnings;
  char **warning;

  /* times, s */
  double opened_at, first_step_at, loop_s, output_s;
  size_t outputs_open;
  bool closed;
  hk_plugin_time *plugin_time; /* of the last summary */
};

double hk_clock(void); /* s, monotonic */

/* choose.c: the integrator and solver asked for, with their parameters; what is left out. */
hk_status hk_overrides_apply(hk_run *);

/* state.c */
hk_status hk_state_open(hk_run *);
void hk_state_close(hk_run *);
void hk_state_publish(hk_run *); /* the model's pointers follow the run's arrays */
void hk_state_view(hk_run *);    /* refreshes view, force views and system after X, n or t changed */
void hk_state_perturb(hk_run *); /* options.perturb: free particles, at random */
hk_status hk_state_emit(hk_run *, double h, bool *changed);
hk_status hk_state_start_file(hk_run *); /* save.c: after the plugins' start, what scene->start_file says */
void hk_elements_refresh(hk_run *);

/* pins.c */
hk_status hk_pins_open(hk_run *);
void hk_pins_close(hk_run *);
hk_status hk_pins_impose(hk_run *, double t, double *x, double *v); /* also sets time-dependent parameters */
void hk_pins_filter(const hk_run *, double *vector);
double hk_pins_power(const hk_run *, const double *F, const double *v); /* W, of what moves pinned particles */
void hk_pins_remap(hk_run *, const uint32_t *map);
bool hk_pins_release(hk_run *); /* true: something was let go at this time */

/* system.c */
hk_status hk_system_open(hk_run *);
void hk_system_close(hk_run *);
hk_status hk_system_resize(hk_run *);
void hk_system_take_all(hk_run *); /* evaluations are of the whole f again */
double hk_system_potential(hk_run *, double t, const double *X);
double hk_system_kinetic(const hk_run *, const double *X);
bool hk_system_has_energy(const hk_run *); /* the work that comes in is known */

/* constraint.c. `a` holds F/m filtered on entry, with constraint forces on return. */
hk_status hk_constraints_open(hk_run *);
void hk_constraints_close(hk_run *);
hk_status hk_constraints_accelerate(hk_run *, double t, const double *x, const double *v, double *a);
/* Brings x onto g(x) = 0 and v onto J v = 0 (mass-weighted Newton); part of every step. */
hk_status hk_constraints_project(hk_run *, double t, double *x, double *v);
double hk_constraints_violation(hk_run *);
hk_status hk_constraints_topology(hk_run *); /* particles were born or died */

/* jacobian.c */
hk_status hk_jacobian_assemble(hk_system *, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D);
void hk_jacobian_topology(hk_run *); /* the pattern is void */
void hk_jacobian_close(hk_run *);

/* implicit.c */
hk_status hk_implicit_combine(hk_system *, double m, double d, double k, hk_matrix *A);
hk_status hk_implicit_solver_flags(hk_system *, unsigned *flags);
hk_status hk_implicit_factorize(hk_system *, const hk_matrix *A);
hk_status hk_implicit_solve(hk_system *, const double *b, double *x, hk_solve_info *info);
hk_status hk_implicit_solve_columns(hk_system *, const double *b, double *x, size_t columns);
/* The scene's solver, or the one that suits it, started; its instance. */
hk_status hk_solver_get(hk_run *, hk_instance **solver);
/* summary.c: the libraries of the solver that has started, of the constraints' otherwise; "": none or not known */
void hk_solver_libraries(const hk_run *, char *text, size_t size);

/* step.c */
hk_status hk_step_estimate(hk_run *);               /* the spectrum and the limit, whatever the method */
hk_status hk_step_choose(hk_run *);                 /* dt from the scene, the options or the stable limit */
hk_status hk_step_reestimate(hk_run *, bool event); /* again when it could have shrunk */

/* loop.c */
hk_status hk_loop_to(hk_run *, double t);
hk_status hk_loop_frame(hk_run *); /* shows the present state */

/* energy.c */
hk_status hk_frame_figures(hk_run *, hk_frame *frame);
double hk_strain_largest(hk_run *, const char *label, bool *found);
double hk_exact_error(hk_run *);

/* resolve.c: what an implicit step does not resolve. Begin before the step to look at, end after it. */
void hk_under_resolved_begin(hk_run *);
void hk_under_resolved_end(hk_run *, double h);
double hk_under_resolved_error(hk_run *); /* m, the median of the frames */
void hk_under_resolved_close(hk_run *);

/* unseen.c */
bool hk_varies_between_steps(hk_run *); /* a function of time changes between the steps that were taken */

/* verdict.c */
hk_status hk_diagnose(hk_run *, hk_status cause); /* names step, time, particle and force; returns the status */
void hk_judge(hk_run *);                          /* at the end: ok or inaccurate, and why */
hk_status hk_snapshot_take(hk_run *, hk_snapshot *);
void hk_snapshot_free(hk_snapshot *);
void hk_run_warn(hk_run *, const char *format, ...) HK_PRINTF(2, 3);

/* folder.c: the run's output folder, made when the first file is asked for. */
hk_status hk_folder_open(hk_run *);
void hk_folder_close(hk_run *);
hk_status hk_folder_path(hk_shared *, const char *name, char *buffer, size_t size);

/* measures.c: measures.csv, one row per frame. */
hk_status hk_measures_open(hk_run *);
hk_status hk_measures_write(hk_run *);
hk_status hk_measures_close(hk_run *);

/* progress.c */
void hk_progress(hk_run *, bool last);

#endif
