/* f(X, t), which integrators see as an hk_system. */
#ifndef HK_EVALUATE_H
#define HK_EVALUATE_H

#include "core/engine/blocks/blocks.h"

/* ---- evaluations.c: how far apart the times are at which a run evaluated its functions of time ---- */

enum { HK_PENDING = 256, HK_CELLS = 32768 };

typedef struct hk_evaluations {
  float *
      distance; /* s, per cell, HK_CELLS: the longest between two neighbouring times; 0: none; NULL: nothing is noted */
  double cell;  /* s, length of a cell */
  double last;  /* s, last time of accepted steps; NAN: none */
  size_t pending;
  double time[HK_PENDING]; /* s, of the step under way */
} hk_evaluations;

bool hk_evaluations_open(hk_evaluations *, double end); /* false: no memory */
void hk_evaluations_close(hk_evaluations *);
/* Where times are noted, `distance`. */
void hk_evaluations_note(hk_evaluations *, double t);   /* the functions are evaluated at t */
void hk_evaluations_accept(hk_evaluations *, double t); /* a step to t is accepted */
/* The distance in s near t, where it is known. */
double hk_evaluations_distance(const hk_evaluations *, double t, double otherwise);

/* ---- f(X, t) ---- */

typedef struct hk_dynamics hk_dynamics;
typedef struct hk_constraints hk_constraints;         /* core/numerics/constraints */
typedef struct hk_implicit_matrix hk_implicit_matrix; /* core/numerics/implicit */
typedef struct hk_saddle_point hk_saddle_point;
typedef struct hk_asked_solver hk_asked_solver; /* core/numerics/matrix */
typedef struct hk_body_list hk_body_list;       /* core/numerics/constraints */

typedef struct hk_counts {
  size_t evaluations, jacobians, factorizations, linear_iterations;
  size_t special_factorizations; /* of those, by solvers for matrices of a kind */
} hk_counts;

/* What keeps the constraints of a scene (core/numerics/constraints). */
typedef struct hk_constraint_calls {
  hk_status (*update)(hk_dynamics *); /* at the start of a step: constraints may change their equations */
  /* `a` is F/m with pins on entry, and includes constraint forces on return. What they do as time passes, with all else
   * at rest, is added to `power`, W. */
  hk_status (*accelerate)(hk_dynamics *, double t, const double *x, const double *v, double *a, double *power);
  /* After a step of h s to x and v, before `project`. *part: the part of it, in (0, 1), at which a one-sided equation
   * is first met; 1: none is. */
  hk_status (*impact)(hk_dynamics *, double t, double *x, double *v, double h, double *part);
  hk_status (*project)(hk_dynamics *, double t, double *x, double *v); /* after a step: brings x and v onto them */
  bool (*may_strike)(const hk_dynamics *);                             /* some equation is one-sided */
  bool (*jumped)(hk_dynamics *);        /* since this was last asked: the histories of methods are void */
  void (*forget)(hk_dynamics *);        /* what is kept from one step to the next */
  hk_status (*topology)(hk_dynamics *); /* after births and deaths */
} hk_constraint_calls;

/* Functions evaluate at the X and t that they are given; they read `state` for masses, pins and sizes and never write
 * it. */
struct hk_dynamics {
  hk_system system; /* first member: a function that gets the system finds the dynamics by a cast */
  hk_split_table split;
  hk_system_queries queries;
  hk_state *state;
  hk_pins *pins;
  hk_plugins *plugins;
  hk_shared *shared;
  hk_error *error;
  /* forces */
  hk_view *force_view; /* one per force, with its own host and selection */
  bool *force_acts;    /* one per force: the time lies between its `from` and `to` */
  bool *takes;         /* one per force: split.takes */
  hk_force_info *force_info;
  hk_element_list *element_list;
  hk_elements *offered; /* room for the lists of one force */
  hk_publication *publication;
  const hk_tuples **join; /* the parameters HK_EDGES of constraints */
  hk_tiles tiles;
  double *unaccounted; /* n x 3, the F of one force alone; NULL: the host computes no force's work */
  bool updates, limits, listens,
      demands;       /* a force has `update`, `step_limit`, `accepted` or `evolve`, `longest_step` */
  double *predicted; /* n x 3, predicted positions after the next step, scratch; NULL: no force has `update` or
                        `step_limit` */
  bool lost; /* plugins may have lists of other particles than the state: a remapping failed, and none is asked again */
  bool has_timed;
  double timed_at;            /* s, time of the last values of timed parameters; NAN: none */
  hk_evaluations evaluations; /* of paths and timed parameters */
  hk_counts count;
  /* Installed by the run where the scene needs it */
  const hk_constraint_calls *constrain; /* NULL: the scene has no constraints */
  /* Told when the blocks of a Jacobian change, or, with `particles`, all of them do; NULL: nobody keeps any. */
  void (*blocks_changed)(hk_dynamics *, bool particles);
  /* of core/numerics alone */
  hk_linear_table linear;
  hk_constraints *constraints; /* NULL: the scene has none */
  hk_implicit_matrix *matrix;  /* NULL: no Jacobian was asked for */
  hk_saddle_point *saddle;     /* NULL: no constraints, or the method solves no linear systems */
  hk_instance *solver;         /* NULL: the run solves no linear systems, or those of `special` alone */
  hk_instance *special;        /* the solver for matrices of a kind, which is preferred where it fits; or NULL */
  hk_plugin_spec *solver_spec, *special_spec; /* specs of solvers that the run has chosen */
  hk_asked_solver *asked;                     /* what plugins solve systems of their own with; NULL: none does */
  hk_body_list *bodies;                       /* particles that constraints join; NULL: no plugin asks for them */
};

/* ---- system.c ---- */

/* The parts live as long as the dynamics. Plugins are created, not started. */
hk_status hk_dynamics_open(hk_dynamics *, hk_state *, hk_pins *, hk_plugins *, hk_shared *);
hk_status hk_dynamics_start(hk_dynamics *); /* starts the plugins */
hk_status hk_dynamics_begin(hk_dynamics *); /* at the start state: which forces act at its time, their elements */
/* Updates selections and acting forces; to be called after the forces have started or changed. */
void hk_dynamics_refresh(hk_dynamics *);
/* Updates pins, plugins and matrices after births, deaths or a state from a file; the state must have adopted its new
 * particles. */
hk_status hk_dynamics_remap(hk_dynamics *, const uint32_t *map, size_t n_old);
void hk_dynamics_close(hk_dynamics *);

/* ---- elements.c: the elements and published fields of forces, collected in the model ---- */

size_t hk_force_element_lists(const hk_plugin *); /* 0: it offers no elements */
hk_status hk_joins_refresh(hk_dynamics *);        /* the pairs that constraints join. HK_NO_MEMORY */
hk_status hk_elements_refresh(hk_dynamics *); /* HK_FAILED: a list contradicts itself; the message names the force */
/* The fields that plugins publish: before they start, and again when they have, for services come in between. */
hk_status hk_publications_list(hk_dynamics *);
bool hk_force_acts_at(const hk_instance *, double t);
/* view of force k at any X */
hk_view hk_force_view_at(const hk_dynamics *, size_t k, double t, const double *X, size_t n);

/* ---- accelerations.c ---- */

hk_status hk_dynamics_set_time(hk_dynamics *, double t); /* of pins, which are not imposed, and timed parameters */
hk_status hk_dynamics_impose(hk_dynamics *, double t, double *x, double *v);
void hk_dynamics_take_all(hk_dynamics *); /* evaluations include all forces again */
hk_status hk_evaluate_accelerations(hk_system *, double t, double *x, double *v, const double *y, double *a,
                                    double *dy);
void hk_evaluate_exchange(hk_system *); /* see hk_system.exchange */
/* dy += the rate that the scene states for channel k of the particles from `first` on */
hk_status hk_evaluate_rate(hk_dynamics *, size_t k, double t, const double *y, double *dy, size_t first);
hk_status hk_evaluate_resize(hk_dynamics *); /* adapts the memory to the number of particles */
/* See hk_system.fused and hk_system.tile. */
hk_status hk_evaluate_fused(hk_system *, double t, double *x, double *v, const double *y, double *a, double *dy,
                            const hk_fused *);
hk_status hk_evaluate_several(hk_system *, hk_tile_step *, size_t count);
/* Whether tiles of several steps are possible at present, and worth while; how many steps one should have at most, as
 * forces without parts may take long. Results do not depend on that number. */
bool hk_evaluate_takes_several(const hk_dynamics *);
size_t hk_evaluate_several_most(const hk_dynamics *);
/* Whether all particles are gone through once more in every evaluation for force k, as it has no parts. */
bool hk_evaluate_is_apart(const hk_dynamics *, size_t k);

/* ---- force_queries.c: energies, forces and blocks of one state, apart from the evaluation of f ---- */

bool hk_query_uncoupled(hk_system *, const double *x, const double *v, size_t begin, size_t end, double *F,
                        double (*K)[9], double (*D)[9]); /* see hk_system_queries */

/* J, sum of the forces with an energy; NAN after a remapping that failed. */
double hk_query_potential(hk_dynamics *, double t, const double *X);
bool hk_query_has_energy(const hk_dynamics *); /* the work done on the scene is known */
/* F of force k alone at X, of n particles (n x 3, from 0). The run's error does not change. False: the force failed. */
bool hk_query_force(hk_dynamics *, size_t k, const double *X, size_t n, double *F);
/* largest by magnitude; label NULL: of all forces */
double hk_query_strain(const hk_dynamics *, const char *label, bool *found);

/* ---- force_calls.c: functions that call all forces, for contact and matrix-free methods ---- */

hk_status hk_forces_update(hk_system *, double t, const double *X, const double *x_to);
hk_status hk_forces_settle(hk_dynamics *); /* an update at the present positions, after a change that is not a step */
double hk_forces_step_limit(hk_system *, double t, const double *X, const double *dx);
double hk_forces_longest_step(hk_dynamics *);          /* s, at the present state, where forces demand one */
hk_status hk_forces_accepted(hk_dynamics *, double h); /* to be called at the end of an accepted step */
/* Internal variables move to the end of a step of h s at the present state, after `accepted`; h = 0: where forces begin
 * to act. What the forces report is summed; blocks that change are told of. */
hk_status hk_forces_evolve(hk_dynamics *, double h, hk_evolution *sum);
hk_status hk_forces_potential(hk_system *, double t, const double *X, double *joule);
bool hk_forces_stiffness(hk_system *, hk_stiffness_part, bool stiffening, double (*block)[6]);

#endif
