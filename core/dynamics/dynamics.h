/* f(X, t) and its matrices, which integrators see as an hk_system. */
#ifndef HK_DYNAMICS_H
#define HK_DYNAMICS_H

#include "core/parts/parts.h"

typedef struct hk_constraints hk_constraints;         /* constraints.h */
typedef struct hk_implicit_matrix hk_implicit_matrix; /* implicit_matrix.h */
typedef struct hk_saddle_point hk_saddle_point;       /* saddle_point.c */

typedef struct hk_counts {
  size_t evaluations, jacobians, factorizations, linear_iterations;
} hk_counts;

/* Functions evaluate at the X and t that they are given; they read `state` for masses, pins and sizes and never write
 * it. */
typedef struct hk_dynamics {
  hk_system system; /* first member: a function that gets the system finds the dynamics by a cast */
  const hk_scene *scene;
  hk_state *state;
  hk_pins *pins;
  hk_plugins *plugins;
  hk_shared *shared;
  hk_error *error;
  /* forces */
  hk_view *force_view; /* one per force, with its own host and selection */
  bool *force_acts;    /* one per force: the time lies between its `from` and `to` */
  bool *takes;         /* one per force: system.takes */
  bool *takes_kept;    /* one per force: scratch */
  hk_force_info *force_info;
  hk_element_list *element_list;
  hk_elements *offered; /* room for the lists of one force */
  hk_publication *publication;
  const hk_tuples **join; /* the parameters HK_EDGES of constraints */
  hk_parts parts;
  double *unaccounted;                    /* n x 3, the F of one force alone; NULL: the host computes no force's work */
  bool updates, limits, listens, demands; /* a force has `update`, `step_limit`, `accepted`, `longest_step` */
  double *predicted; /* n x 3, predicted positions after the next step, scratch; NULL: no force has `update` or
                        `step_limit` */
  bool has_timed;
  double timed_at;            /* s, time of the last values of timed parameters; NAN: none */
  hk_evaluations evaluations; /* of paths and timed parameters */
  hk_counts count;
  /* linear systems */
  hk_constraints *constraints; /* NULL: the scene has none */
  hk_implicit_matrix *matrix;  /* NULL: no Jacobian was asked for */
  hk_saddle_point *saddle;     /* NULL: no constraints, or the method solves no linear systems */
  hk_instance *solver;         /* NULL: the run solves no linear systems, or those of `special` alone */
  hk_instance *special;        /* the solver for matrices of a kind, which is preferred where it fits; or NULL */
  hk_plugin_spec *solver_spec, *special_spec; /* specs of solvers that the run has chosen */
} hk_dynamics;

/* ---- system.c ---- */

/* The parts live as long as the dynamics. Plugins are created, not started. */
hk_status hk_dynamics_open(hk_dynamics *, const hk_scene *, hk_state *, hk_pins *, hk_plugins *, hk_shared *);
/* Updates selections and acting forces; to be called after the forces have started or changed. */
void hk_dynamics_refresh(hk_dynamics *);
/* Updates pins, plugins and matrices after births, deaths or a state from a file; the state must have adopted its new
 * particles. */
hk_status hk_dynamics_remap(hk_dynamics *, const uint32_t *map, size_t n_old);
void hk_dynamics_close(hk_dynamics *);
void hk_dynamics_take_all(hk_dynamics *); /* evaluations include all forces again */

/* ---- impose.c: imposes the pins and timed parameters of a time ---- */

hk_status hk_dynamics_set_time(hk_dynamics *, double t); /* those of the time, which are not imposed yet */
hk_status hk_dynamics_impose(hk_dynamics *, double t, double *x, double *v);

/* ---- elements.c: the elements and published fields of forces, collected in the model ---- */

size_t hk_force_element_lists(const hk_force *); /* 0: it offers no elements */
hk_status hk_elements_refresh(hk_dynamics *);    /* HK_FAILED: a list contradicts itself; the message names the force */
/* The fields that plugins publish: before they start, and again when they have, for services come in between. */
hk_status hk_publications_list(hk_dynamics *);
bool hk_force_acts_at(const hk_instance *, double t);
/* view of force k at any X */
hk_view hk_force_view_at(const hk_dynamics *, size_t k, double t, const double *X, size_t n);

/* ---- evaluate.c ---- */

hk_status hk_evaluate_accelerations(hk_system *, double t, double *x, double *v, const double *y, double *a,
                                    double *dy);
/* dy += the rate that the scene states for channel k of the particles from `first` on */
hk_status hk_evaluate_rate(hk_dynamics *, size_t k, double t, const double *y, double *dy, size_t first);
hk_status hk_evaluate_resize(hk_dynamics *); /* adapts the memory to the number of particles */
hk_status hk_evaluate_pass(hk_system *, double t, double *x, double *v, const double *y, double *a, double *dy,
                           const hk_pass *);                       /* see hk_system */
hk_status hk_evaluate_wave(hk_system *, hk_level *, size_t count); /* see hk_system */
bool hk_evaluate_waves(const hk_dynamics *); /* whether waves are possible at present, and worth while */

/* ---- probe.c: energies, forces and blocks of one state, apart from the evaluation of f ---- */

bool hk_probe_alone(hk_system *, const double *x, const double *v, size_t begin, size_t end, double *F, double (*K)[9],
                    double (*D)[9]); /* see hk_system */

double hk_probe_potential(hk_dynamics *, double t, const double *X); /* J, sum of the forces with an energy */
bool hk_probe_has_energy(const hk_dynamics *);                       /* the work done on the scene is known */
/* F of force k alone at X, of n particles (n x 3, from 0). The run's error does not change. False: the force failed. */
bool hk_probe_force(hk_dynamics *, size_t k, const double *X, size_t n, double *F);
/* largest by magnitude; label NULL: of all forces */
double hk_probe_strain(const hk_dynamics *, const char *label, bool *found);

/* ---- sweep.c: functions that call all forces, for contact and matrix-free methods ---- */

hk_status hk_sweep_update(hk_system *, double t, const double *X, const double *x_to);
hk_status hk_sweep_settle(hk_dynamics *); /* an update at the present positions, after a change that is not a step */
double hk_sweep_limit(hk_system *, double t, const double *X, const double *dx);
double hk_sweep_longest_step(hk_dynamics *);          /* s, at the present state; INFINITY: no limit */
hk_status hk_sweep_accepted(hk_dynamics *, double h); /* to be called at the end of an accepted step */
hk_status hk_sweep_potential(hk_system *, double t, const double *X, double *joule);
hk_status hk_sweep_product(hk_system *, double t, const double *X, const double *dx, const double *dv, double *dF);
bool hk_sweep_stiffness(hk_system *, hk_stiffness_part, bool stiffening, double (*block)[6]);

/* ---- constraint.c. `a` is F/m with pins on entry, and includes constraint forces on return ---- */

hk_status hk_constraints_open(hk_dynamics *);
/* At the state, once it is projected: which equations follow from others, which touch. */
hk_status hk_constraints_review(hk_dynamics *);
void hk_constraints_close(hk_dynamics *);
/* What they do as time passes, with all else at rest, is added to `power`, W. */
hk_status hk_constraints_accelerate(hk_dynamics *, double t, const double *x, const double *v, double *a,
                                    double *power);
/* At the start of a step: constraints may change their equations. */
hk_status hk_constraints_update(hk_dynamics *);
/* Brings x onto g(x) = 0 and v onto J v + g_t = 0 (mass-weighted Newton); part of every step. */
hk_status hk_constraints_project(hk_dynamics *, double t, double *x, double *v);
void hk_constraints_forget(hk_dynamics *); /* what is kept from one step to the next */
/* Whether contact began or ended, equations changed or velocities jumped since this was last asked: the histories of
 * methods are void. */
bool hk_constraints_jumped(hk_dynamics *);
hk_status hk_constraints_violation(hk_dynamics *, double *violation); /* m, of the state */
hk_status hk_constraints_topology(hk_dynamics *);

/* ---- constraint_forces.c: multipliers of the state, N for equations in metres; J^T lambda acts on the particles ----
 */

hk_status hk_constraint_multipliers(hk_dynamics *, double *lambda); /* of all; an evaluation, of which nothing stays */
void hk_constraint_range(const hk_dynamics *, size_t k, size_t *begin, size_t *end); /* equations of constraint k */
/* N, the force of constraint k on a particle, by J of the last evaluation. */
void hk_constraint_force_on(const hk_dynamics *, size_t k, const double *lambda, size_t particle, double F[3]);

/* ---- jacobian.c, implicit_matrix.c, saddle_point.c ---- */

hk_status hk_saddle_point_open(hk_dynamics *); /* in a scene with constraints, whose method solves linear systems */
void hk_saddle_point_close(hk_dynamics *);
const hk_instance *hk_saddle_point_solver(const hk_dynamics *); /* NULL: it is the scene's own kind, or not needed */

hk_status hk_jacobian_assemble(hk_system *, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D);
void hk_jacobian_topology(hk_dynamics *); /* other particles: makes the pattern and the factors invalid */
void hk_jacobian_renew(hk_dynamics *);    /* other blocks: the next assembly builds a new pattern */
void hk_jacobian_close(hk_dynamics *);
hk_status hk_implicit_combine(hk_system *, double m, double d, double k, hk_matrix *A);
hk_status hk_implicit_solver_flags(hk_system *, unsigned *flags);
hk_status hk_implicit_factorize(hk_system *, const hk_matrix *A);
hk_status hk_implicit_solve(hk_system *, const double *b, double *x, hk_solve_info *info);
hk_status hk_implicit_solve_along(hk_system *, const double *b, const double *u, double *x, hk_solve_info *info);
hk_status hk_implicit_solve_columns(hk_system *, const double *b, double *x, size_t columns);

/* ---- linear_system.c: the scene's solver, or one chosen by the forces, the size and the flags of the installed
 * solvers ---- */

/* Lets the pattern of the Jacobian decide on the solver, before the first step. */
hk_status hk_solver_settle(hk_dynamics *);
/* Creates and starts the solver before the first step. `named` NULL: the solver is chosen. */
hk_status hk_solver_open(hk_dynamics *, const hk_plugin_spec *named);
/* One that takes indefinite matrices, for the saddle points of implicit steps with constraints; the caller destroys it
 * and then the spec, which is NULL where the scene's solver is of that kind. */
hk_status hk_solver_indefinite(hk_dynamics *, hk_instance **solver, hk_plugin_spec **spec);
/* The solver of the last systems; NULL: there were none. */
const hk_instance *hk_solver_in_use(const hk_dynamics *);

#endif
