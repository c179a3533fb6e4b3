/* How accurate a run was: figures of its frames, its summary, and the verdict with its reason. */
#ifndef HK_JUDGE_H
#define HK_JUDGE_H

#include "core/loop/loop.h"

typedef struct hk_plugin_time {
  const char *kind, *name, *label;
  double seconds;
} hk_plugin_time;

typedef struct hk_judgement {
  hk_verdict verdict;
  char reason[1024];     /* why it is not ok; "" otherwise */
  hk_snapshot last_good; /* the last state whose energy was plausible */
  hk_frame last_frame;   /* its figures; measures point into `measure` */
  double *measure;       /* one per measure of the scene */
  const char **measure_name;
  bool energy_converges; /* the energy drift was seen to vanish with the step (verify.c) */
  /* under_resolved.c */
  double *slope[2]; /* the state's accelerations and channel rates at the two ends of a step */
  bool sampling;    /* between before and after */
  size_t samples;
  double *unresolved;          /* m, one per sample */
  hk_plugin_time *plugin_time; /* of the last summary */
} hk_judgement;

hk_status hk_judgement_open(hk_judgement *, const hk_scene *, hk_error *error);
void hk_judgement_close(hk_judgement *);

/* ---- figures.c: energies and momenta of a frame, and the error against a known solution ---- */

/* Fills judgement->last_frame and the record; keeps the state when it is a good one. `caller` is handed to measures. */
hk_status hk_figures_take(hk_loop *, hk_judgement *, const void *caller);
/* m, RMS over the particles whose positions the scene's `exact` gives; NAN: there is none, or it failed (a warning). */
double hk_figures_exact_error(hk_loop *);
/* m, how far the exact solution takes the particles from their start by `end`, RMS, at most; NAN: not known. */
double hk_figures_exact_motion(hk_loop *, double end);

/* ---- under_resolved.c: what implicit steps do not resolve. Before and after the step to look at ---- */

void hk_under_resolved_before(hk_loop *, hk_judgement *);
void hk_under_resolved_after(hk_loop *, hk_judgement *, double h);
double hk_under_resolved_error(hk_judgement *); /* m, the median of the samples; 0: there are none */

/* ---- under_sampled.c ---- */

bool hk_varies_between_steps(hk_loop *); /* a function of time changes between the steps that were taken */

/* ---- summary.c: the figures of a run ---- */

typedef struct hk_summary {
  const char *scene, *integrator;
  const char *solver;         /* of linear systems; NULL: none was needed */
  const char *solver_choice;  /* "chosen for the forces and the size"; "": the script or the user named it */
  char solver_libraries[160]; /* as hk_solver.describe says; "" when it does not, or no system was solved */
  hk_verdict verdict;
  const char *verdict_name;
  char reason[1024];  /* why it is not ok; "" otherwise */
  double t, end, fps; /* s, s, 1/s: reached, meant to be reached, frames */
  size_t n, steps, frames, rejected_steps;
  size_t force_evaluations, jacobian_evaluations, factorizations, linear_iterations;
  double dt_min, dt_max, dt_limit; /* s; limit: largest stable step of the linearised scene at its least, NAN unknown */
  bool dt_chosen;
  char step[128]; /* dt_min, dt_max and dt_limit in words; "" before the first step */
  double wall_s, step_wall_s, start_wall_s, steps_per_s;       /* start: from opening to the first step */
  double energy_first, energy_last, energy_work, energy_drift; /* J, J, J, relative; NAN: not known */
  double kinetic_max;
  double momentum_drift;       /* relative to the largest sum of m |v|; NAN: momentum is not conserved by the scene */
  double constraint_violation; /* m */
  double max_strain;           /* NAN: no elements */
  double exact_error;          /* m, RMS at the end; NAN: no exact solution */
  double accuracy;             /* m, asked for; NAN: none */
  double verify_difference;    /* m, RMS difference to half the step from a perturbed start; NAN: not verified */
  size_t plugins;
  const hk_plugin_time *plugin; /* valid until the next summary of the run */
  size_t measures;
  const char *const *measure_name;
  const double *measure;
  size_t warnings;
  char **warning;
} hk_summary;

/* What only the run knows. */
typedef struct hk_asked {
  double end;        /* s */
  double accuracy;   /* m; NAN: none */
  double opened_at;  /* s, wall */
  bool ignore_exact; /* judge as if the scene had no exact solution */
} hk_asked;

/* Pointers in it are valid until the run is destroyed, those of plugins until the next summary. */
void hk_summary_take(hk_loop *, hk_judgement *, const hk_asked *, hk_summary *);
const char *hk_verdict_name(hk_verdict); /* "ok", "inaccurate", "diverged", "interrupted" */

/* ---- figure_table.c: every figure of a summary once, from which text, JSON and Lua are made ---- */

typedef enum hk_figure_type {
  HK_FIGURE_TEXT,   /* const char *; NULL: there is none */
  HK_FIGURE_BUFFER, /* char[] */
  HK_FIGURE_COUNT,  /* size_t */
  HK_FIGURE_NUMBER  /* double; NAN: not known */
} hk_figure_type;

typedef struct hk_figure {
  const char *group; /* the object that it stands in, "energy"; NULL: the summary itself */
  const char *key;
  hk_figure_type type;
  size_t offset; /* in hk_summary */
  /* In the text report: the label of the line that it begins, or NULL: it goes on with the line before; and a printf
   * format for the figure. NULL: it does not stand there. */
  const char *label, *format;
} hk_figure;

extern const hk_figure hk_figure_table[]; /* a NULL key ends it */

/* ---- verdict.c, diagnosis.c ---- */

/* At the end: ok or inaccurate, and why. `accuracy` as asked, NAN: none. */
void hk_judge(hk_loop *, hk_judgement *, const hk_asked *);
/* A run that diverged: names step, time, particle and force; returns the status. */
hk_status hk_diagnose(hk_loop *, hk_judgement *, hk_status cause);

#endif
