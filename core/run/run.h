/* A run: a scene in motion. Opening makes the state and starts the plugins, advancing takes steps, closing ends the
 * outputs; a run that failed or was interrupted keeps its last good state. */
#ifndef HK_RUN_H
#define HK_RUN_H

#include "core/base/error.h"
#include "core/scene/scene.h"
#include <signal.h>

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
  int progress;                             /* 0: quiet, 1: lines, 2: one line on a terminal */
  const volatile sig_atomic_t *interrupted; /* NULL: cannot be */
} hk_run_options;

typedef struct hk_plugin_time {
  const char *kind, *name, *label;
  double seconds;
} hk_plugin_time;

typedef struct hk_summary {
  const char *scene, *integrator;
  const char *solver;         /* of linear systems; NULL: none was needed */
  bool solver_chosen;         /* by hooke, for the forces and the number of unknowns */
  char solver_libraries[160]; /* as hk_solver.describe says; "" when it does not, or no system was solved */
  hk_verdict verdict;
  char reason[1024];  /* why it is not ok; "" otherwise */
  double t, end, fps; /* s, s, 1/s: reached, meant to be reached, frames */
  size_t n, steps, force_evaluations, jacobian_evaluations, factorizations, linear_iterations, frames;
  double dt_min, dt_max, dt_limit; /* s; limit: largest stable step of the linearised scene at the start, NAN unknown */
  bool dt_chosen;
  double wall_s, step_wall_s, start_wall_s;                    /* start: from opening to the first step */
  double energy_first, energy_last, energy_work, energy_drift; /* J, J, J, relative; NAN: not known */
  double kinetic_max;
  double momentum_drift;       /* relative to the largest sum of m |v|; NAN: momentum is not conserved by the scene */
  double constraint_violation; /* m */
  double max_strain;           /* NAN: no elements */
  double exact_error;          /* m, RMS at the end; NAN: no exact solution */
  double accuracy;             /* m, asked for; NAN: none */
  double verify_difference;    /* m, RMS difference to half the step from a disturbed start (verify.h); NAN */
  size_t plugins;
  hk_plugin_time *plugin;
  size_t measures;
  const char *const *measure_name;
  const double *measure;
  size_t warnings;
  char **warning;
} hk_summary;

typedef struct hk_run hk_run;

hk_status hk_run_open(hk_scene *, const hk_run_options *, hk_run **run, hk_error *error);
/* Steps to time t (frames on the way are shown to measures and outputs). May be called again with a later t.
 * HK_NOT_FINITE and HK_NOT_CONVERGED: diverged; HK_INTERRUPTED: the state is where it stopped. */
hk_status hk_run_advance(hk_run *, double t, hk_error *error);
/* Closes outputs; once. The run's data stay readable until hk_run_destroy. */
hk_status hk_run_close(hk_run *, hk_error *error);
void hk_run_destroy(hk_run *);

/* For callbacks of scripts and for results. Indices of the view are particle indices. */
const hk_view *hk_run_view(hk_run *);
double hk_run_end(const hk_run *);                               /* s, duration or --until */
bool hk_run_index(const hk_run *, uint32_t id, uint32_t *index); /* false: no such particle now */
double hk_run_measure(const hk_run *, const char *name);         /* last value */
hk_status hk_run_energy(hk_run *, double *kinetic, double *potential, double *work);
hk_status hk_run_force(hk_run *, const char *label, uint32_t id, double force[3], hk_error *error);
hk_status hk_run_strain(hk_run *, const char *label, double *largest, hk_error *error); /* (l - L)/L, by magnitude */
void hk_run_summary(hk_run *, hk_summary *); /* pointers valid until the run is destroyed */
double hk_run_extent(const hk_run *);        /* m, longest side of the box around the particles; 1 when there is none */
/* Final (or last good) state, "id,x,y,z,vx,vy,vz,mass", 17 digits. */
hk_status hk_run_write_state(hk_run *, const char *path, hk_error *error);
/* Everything that goes on: state, ids, plugin fields, random streams. */
hk_status hk_run_save(hk_run *, const char *path, hk_error *error);

#endif
