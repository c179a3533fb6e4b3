/* Derivatives of the steps that a run has taken: how the state at its end depends on its start and on parameters.
 *
 * The method states its step as linear combinations of accelerations (core/plugin/facets/stages.h), so that the
 * derivative of a step follows from that of the accelerations, by K = -dF/dx and D = -dF/dv. Forwards it carries a
 * tangent, the change of the state with one parameter; backwards an adjoint, the change of one number of the last state
 * with the state before (Griewank and Walther, Evaluating Derivatives, 2008, chapters 3 and 12). Both are the
 * derivative of the discrete steps, not a discretisation of the derivative: they agree with each other up to rounding.
 * The work in X is not differentiated.
 *
 * While the run goes on only times and lengths of its steps are kept. Afterwards they are taken again, which has to
 * lead to the same end: whatever acts on the run beside its accelerations is found so. The adjoint needs the points of
 * all evaluations in reverse order: of N steps the states of about sqrt N are kept, and the steps between two of them
 * taken once more, with all points on a tape; of a short run, and where steps are dear and the points take up to
 * HK_TAPE_WHOLE, all are on the tape at once. */
#ifndef HK_SENSITIVITY_H
#define HK_SENSITIVITY_H

#include "core/engine/loop/loop.h"

/* Bytes of a tape that is worth more than sqrt N steps: memory beyond the cache costs as much as steps taken again. */
enum { HK_TAPE_MOST = 1 << 20 };
/* Bytes of a tape that holds all steps of a run, where to take one again costs more than that. */
enum { HK_TAPE_WHOLE = 1 << 25 };
/* Bytes of derivatives by parameters that are kept for further adjoints: each is two evaluations of the scene, which
 * take ten times as long as to read it from memory. */
enum { HK_SHARED_MOST = 1 << 23 };

typedef struct hk_taken_step {
  double t, h;            /* s, its begin and its length */
  bool fresh;             /* the first stage is evaluated, whatever the step before has left */
  bool linear, projected; /* of methods with linear steps: it is one; its factorization failed (linearised.h) */
} hk_taken_step;

/* A point at which a step evaluates: x and v, n x 3 each, one behind the other. */
typedef struct hk_stage_point {
  double t;
  double *X, *a; /* 6n and 3n numbers */
} hk_stage_point;

/* x, v and the acceleration that the next step begins with, n x 3 each, of the state or of a tangent, and for methods
 * of two steps x and v at the begin of the step before, and where steps are linear the positions of the last
 * linearisation; of an adjoint the derivatives by these. With constraints the
 * acceleration of the state is that of the step's end, by them as well, and behind it are the multipliers that v' took.
 * hk_sensitivity.wide numbers. */
typedef double hk_carried;

/* A function of time, linear between values at equally spaced knots and constant beyond them. */
typedef struct hk_knots {
  size_t count;      /* 2 or more */
  double begin, end; /* s */
  double *slope;     /* count: the adjoint's derivative by each value */
} hk_knots;

/* How the scene changes with a parameter: two further runs of it, at their start, whose parameter is larger and smaller
 * by `by`. Their accelerations at the same x and v are compared, with an error of by^2/6 times the third derivative by
 * the parameter. */
typedef struct hk_varied {
  hk_dynamics *more, *less;
  double by;
  /* NULL: a number. Otherwise a function of time on which accelerations depend, and the start does not: all of it is
   * larger and smaller by `by`. For the adjoint alone. */
  const hk_knots *knots;
} hk_varied;

/* Adds to L, 6n, the derivatives by x and v of what a number takes from the state X at t: at the start and at the end
 * of every step, the last one first. A failure ends the adjoint with it. */
typedef hk_status hk_adjoint_source(void *context, double t, const double *X, double *L);

typedef struct hk_implicit_stage hk_implicit_stage; /* implicit_stage.h */
typedef struct hk_linearised hk_linearised;         /* linearised/linearised.h */
typedef struct hk_projection hk_projection;         /* projection.h */

typedef struct hk_sensitivity {
  hk_loop *loop;
  hk_dynamics *dynamics;
  const hk_stages_facet *method;
  size_t n, steps, room;
  size_t stages; /* of a step, at most */
  size_t wide;   /* numbers that are carried from step to step: 9n, 15n, or 18n */
  size_t each;   /* numbers of the tape that a step takes: 9n a stage, and with constraints their own */
  hk_taken_step *step;
  double reached;      /* s, the end of the last step */
  bool no_memory;      /* for the list of steps */
  hk_loop_hooks hooks; /* those of the run, which are called as before */
  double *start;       /* x and v before the first step */
  size_t stride;       /* a state is kept every so many steps */
  hk_carried *kept;    /* before steps 0, stride, 2 stride, ... */
  /* Of the steps from `first` on, `taped` of them, the points at which they were evaluated: 9n numbers a stage. What an
   * adjoint goes through backwards, and what does not have to be taken again where it is there. */
  double *tape;
  size_t first, taped;
  /* da/dp of all parameters at all points, 3n numbers each, where the tape holds the whole run: adjoints of further
   * numbers take them from the first one. Of the parameters `shared_of`; NULL: there are none. */
  double *shared;
  const hk_varied *shared_of;
  size_t shared_count;
  uint64_t shared_chained; /* a bit for each of them that the chain rule finds in part (adjoint.c) */
  bool *exact;             /* one per force: its Jacobian is that of the force */
  bool all_exact;          /* others are differentiated by differences, which have no transpose */
  const char *inexact;     /* label of one that is not */
  double extent, speed; /* the largest on the way: of a place from the first particle's start, m; of a velocity, m/s */
  double off;           /* by which part of its size the scene ends elsewhere where the steps are taken again */
  hk_adjoint_source *source; /* of a number that is no function of the last state alone: an integral; NULL: none */
  void *source_context;
  hk_stage_point point[HK_MOST_STAGES];
  hk_implicit_stage *implicit; /* NULL: the method has no implicit stage */
  hk_projection *projection;   /* NULL: the scene has no constraints */
  hk_linearised *linearised;   /* NULL: the method has no linear steps */
  double *scratch;             /* 15n, of products and differences; behind it the points of a step that is not taped */
} hk_sensitivity;

/* ---- recording.c ---- */

/* At the start of a run: refuses in one sentence what cannot be differentiated, and keeps its steps from here on.
 * *made is to be closed, before the run, after a failure as well. */
hk_status hk_sensitivity_open(hk_loop *, hk_sensitivity **made, hk_error *);
/* Ends the record, and takes the steps again. HK_FAILED: they do not lead to the same end. */
hk_status hk_sensitivity_finish(hk_sensitivity *, hk_error *);
void hk_sensitivity_close(hk_sensitivity *);
/* Bytes that the states take which an adjoint of so many steps keeps at a time; `each` and `wide` of a record. Where
 * `finish` finds that steps are dear, all points of the run, of HK_TAPE_WHOLE bytes at most. */
double hk_sensitivity_bytes(size_t steps, size_t each, size_t wide);
/* Of this record, after `finish` as it has found. */
double hk_sensitivity_kept_bytes(const hk_sensitivity *);

/* ---- tangent.c, adjoint.c: after `finish` ---- */

/* Called at the start and after every step, with the state at t and the tangents of all parameters (x, v: 6n each,
 * `wide` apart). A failure ends the tangents with it. */
typedef hk_status hk_sensitivity_watch(void *context, double t, const double *X, const double *tangents);

/* The derivatives of the states by each parameter. */
hk_status hk_sensitivity_tangents(hk_sensitivity *, const hk_varied *, size_t count, hk_sensitivity_watch *,
                                  void *context, hk_error *);
/* X: on entry the derivative of a number by x and v at the end (6n), on return that by x and v at the start; slope: of
 * that number by each parameter through all steps and the start, of one with knots by all its values together.
 * HK_FAILED: a force has no exact Jacobian. */
hk_status hk_sensitivity_adjoint(hk_sensitivity *, double *X, const hk_varied *, size_t count, double *slope,
                                 hk_error *);

/* ---- segment.c ---- */

/* The steps first to last - 1 from X (6n) at the begin of the first, between two knots that follow each other; X is put
 * onto the constraints first, which is all that no steps do. On
 * return X is the state at their end; J, NULL: not wanted, has the derivatives of that by every number of X, and then
 * by the values of every function of time at both knots: (6n + 2 controls) x 6n. A method that carries an acceleration
 * over evaluates it anew at `first`: where forces depend on velocities that is not quite the run. */
hk_status hk_sensitivity_segment(hk_sensitivity *, size_t first, size_t last, double *X, const hk_varied *,
                                 size_t controls, double *J, hk_error *error);

/* ---- curvature.c ---- */

/* hk_sensitivity_segment, and the second derivatives H by the same columns, squared, of the sum of weight (6n) times
 * the numbers of X at the end. Those by two controls are left out where forces are linear in them. moves, 6n: numbers
 * of X by which J and H are wanted, for others they are not; NULL: all. Differences of exact Jacobians leave a part of
 * about 1e-7 of H, of forces without them 1e-6. Memory is that of all points, (6n)^2 numbers each. */
hk_status hk_sensitivity_curvature(hk_sensitivity *, size_t first, size_t last, double *X, const hk_varied *,
                                   size_t controls, const bool *moves, const double *weight, double *J, double *H,
                                   hk_error *error);

/* Adds the derivative by a function of time at t to those by its values at the knots beside. */
void hk_knots_note(const hk_knots *, double t, double slope);

/* ---- retake.c ---- */

/* Takes the steps first to last - 1 from Z to Z, and has their points on the tape, which has room for `stride`. */
hk_status hk_sensitivity_record(hk_sensitivity *, size_t first, size_t last, hk_carried *Z);
/* Takes step i from Z to Z once more, by its points where they are on the tape. */
hk_status hk_sensitivity_repeat(hk_sensitivity *, size_t step, hk_carried *Z);
/* The points of a step that is on the tape. */
void hk_sensitivity_rewind(hk_sensitivity *, size_t step);
/* Points are no longer those of the tape. */
void hk_sensitivity_untape(hk_sensitivity *);
/* X (6n): where the same steps end in a scene beside, from its own start. */
hk_status hk_sensitivity_replay(hk_sensitivity *, hk_dynamics *, double *X);
/* Takes a step from Z to Z, and keeps its points. */
hk_status hk_sensitivity_step(hk_sensitivity *, const hk_taken_step *, hk_carried *Z);

/* ---- stages.c ---- */

/* The stages of a step. */
const hk_stages_facet *hk_sensitivity_method(const hk_sensitivity *, const hk_taken_step *);
/* Sets the x and v of stage k of a step from Z, by the accelerations in `a` of the stages before; its own terms, where
 * it is implicit, are left out. */
void hk_sensitivity_stage(const hk_sensitivity *, const hk_taken_step *, size_t k, const hk_carried *Z,
                          double *const a[HK_MOST_STAGES], double *X);
void hk_sensitivity_arrive(const hk_sensitivity *, const hk_taken_step *, double *const a[HK_MOST_STAGES],
                           hk_carried *Z);
/* Changes of the state that are carried through steps taken again, for tangents and for segments. */
typedef struct hk_carried_changes {
  size_t count, apart;                                 /* changes; numbers of one */
  hk_carried *dZ;                                      /* of the state */
  double *stage;                                       /* of the stage's x and v, and room */
  double *a[HK_MOST_STAGES];                           /* of the stages' accelerations: 3n, and room */
  const struct hk_projection_slopes *by;               /* of constraints, projection.h; NULL: none */
  hk_status (*accelerations)(void *context, size_t k); /* sets a[k] by `stage` and whatever else changes it */
  void *context;
} hk_carried_changes;

/* Through a step that was taken again, with constraints or without, but for linear ones. */
hk_status hk_carried_changes_step(hk_sensitivity *, const hk_taken_step *, hk_carried_changes *);
/* Whether stage k is evaluated, not carried over. */
bool hk_sensitivity_evaluates(const hk_sensitivity *, const hk_taken_step *, size_t k);
hk_status hk_sensitivity_evaluate(hk_dynamics *, double t, double *X, double *a); /* at X (6n) */

/* ---- products.c: the derivative of the accelerations at a point ---- */

/* m/s^2 of N, and what pins leave of it; of riders nothing. */
void hk_sensitivity_divide(const hk_sensitivity *, double *a);
/* a = (da/dx) dx + (da/dv) dv of count changes (6n each, `apart` numbers from each other; a: 3n, likewise). by: of each
 * what changes beside in the forces that it covers, and the masses; NULL: nothing. */
typedef struct hk_force_changes hk_force_changes; /* force_slopes.h */
hk_status hk_sensitivity_products(hk_sensitivity *, const hk_stage_point *, size_t count, size_t apart,
                                  const double *dX, const hk_force_changes *by, double *a);
/* A: da/dx and da/dv, 3n rows of 6n numbers. */
hk_status hk_sensitivity_jacobian(hk_sensitivity *, const hk_stage_point *, double *A);
/* dX = (da/dx, da/dv)^T u: 6n numbers of 3n. Adds to the slopes, if there are any, the derivatives of u.a by them. Of
 * the forces that are not in `without`; NULL: all. */
typedef struct hk_force_slopes hk_force_slopes; /* force_slopes.h */
hk_status hk_sensitivity_transposed(hk_sensitivity *, const hk_stage_point *, const double *u, double *dX,
                                    hk_force_slopes *, const bool *without);
/* da/dp, 3n, as far as it is by the forces that are not in `without`; NULL: all. */
hk_status hk_sensitivity_by_parameter(hk_sensitivity *, const hk_stage_point *, const hk_varied *, const bool *without,
                                      double *a);
void hk_sensitivity_start(const hk_varied *, size_t n, double *dX); /* d(x, v)/dp of the start */

#endif
