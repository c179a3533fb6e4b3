/* Integrators, and the system dX/dt = f(X, t) as they see it. */
#ifndef HK_PLUGIN_INTEGRATOR_H
#define HK_PLUGIN_INTEGRATOR_H

#include "core/plugin/force.h"
#include "core/plugin/solver.h"
#include "core/plugin/widest.h"

typedef struct hk_system hk_system;

enum { /* hk_integrator.flags */
       HK_IMPLICIT = 1,
       HK_ADAPTIVE = 2,
       HK_SYMPLECTIC = 4,
       HK_NEEDS_JACOBIAN = 8,
       HK_REVERSIBLE = 16,    /* a run with reversed velocities returns to the start */
       HK_NEEDS_SOLVER = 32,  /* calls factorize and solve; HK_NEEDS_JACOBIAN implies it */
       HK_SPLITS_FORCES = 64, /* evaluates parts of the sum of forces by `takes`: not possible with one-sided
                                constraints, whose acting equations depend on the whole sum */
       HK_LIMITS_MOVES = 128, /* reaches its new state by moves within hk_system.step_limit; the host checks the steps
                               of other methods, on the straight line, and halves those that are not safe */
       HK_KEEPS_CONSTRAINTS = 256, /* in a holonomic scene its steps end on g = 0 and J v + g_t = 0, by hold_positions
                                      and hold_velocities; the host does not project them */
       HK_USES_SPARE = 512         /* uses hk_system.spare */
};

typedef enum hk_reason { /* the reason why the host calls `reset` */
                         HK_PARTICLES_CHANGED,
                         HK_STATE_CHANGED, /* a corrector, an event or a release changed x, v or the forces */
                         HK_STEP_CHANGED,  /* the next h differs from the last (fixed-step methods) */
                         /* The run shall be able to go on from here: what no saved field holds is void (factors, the
                            history of a library), what fields hold stays. For methods that solve linear systems. */
                         HK_CHECKPOINT
} hk_reason;

typedef struct hk_step {
  double h;      /* s, the step taken */
  double h_next; /* s, the step proposed next; fixed-step methods do not set it */
  double error;  /* error estimate relative to the tolerance (1 = just met), or NAN when there is none */
} hk_step;

/* A method for dX/dt = f(X, t). It accesses the scene through hk_system only. */
typedef struct hk_integrator {
  size_t size;
  int order;
  int stages; /* evaluations of f per step */
  unsigned flags;
  /* Largest growth factor (spectral radius) of one step on x'' = -g x' - w^2 x, as a function of hw = h w, hg = h g,
   * with the parameters of `self`;
   * on y' = -k y, a channel, it is amplification(0, h k) (which is never below 1: x'' = -g x' keeps a constant). */
  double (*amplification)(const void *self, double hw, double hg);
  /* Advances s->X from s->t by one step, h or shorter, never beyond t_stop; fixed-step methods take h exactly. The host
   * moves s->t. After HK_NOT_CONVERGED s->X must be unchanged, since the host may try a smaller step; after any other
   * failure the run ends. */
  hk_status (*step)(void *self, hk_system *s, double t_stop, double h, hk_step *out);
  void (*reset)(void *self, hk_reason why); /* history and cached forces are invalid; NULL: the method keeps none */
  /* One sentence that says why the method cannot be used with constraints; NULL: it can. */
  const char *without_constraints;
  /* As `amplification`, on z'' = -(g + i b) z' - w^2 z for complex z = x + i y: a particle in a plane whose velocity a
   * field turns at the rate b, as v x B and Coriolis do; hb = h b of either sign. With hb = 0 it is
   * `amplification`. NULL: not stated; where velocities turn, an explicit method's largest stable step is then not
   * known, and its step is chosen for accuracy. */
  double (*rotation)(const void *self, double hw, double hg, double hb);
  /* For methods that take a part of the forces in shorter steps of their own: chooses that part at s->X and sets
   * s->aside. The host calls it before every estimate of the largest stable step, which is then that of the rest. May
   * allocate, and must do nothing where the part is still right. NULL: the method has none. */
  hk_status (*divide)(void *self, hk_system *s);
  /* As `rotation` in a step of h, of the rest's modes (1/s) with the part set aside beside them, if they lower the
   * limit. NULL: they do not. */
  double (*growth)(const void *self, double h, double w, double g, double b);
  /* hk_system.tol of an adaptive method where nobody asks for one: what its order makes worth while. 0: 1e-6. */
  double tolerance;
  /* For methods of fixed steps with one evaluation each and HK_USES_SPARE: takes *count steps of h at once by
   * hk_system.wave, as `step` would one after another; or sets *count to 0 where it cannot at present. t[k]: s, the end
   * of step k. The first step goes from s->X, which must not be changed, to s->spare, the others work there in place;
   * the host makes it X. If it fails, `reset` is called. The host calls it where nobody needs the states between the
   * steps; there are then neither channels nor constraints. NULL: the host calls `step`. */
  hk_status (*march)(void *self, hk_system *s, const double *t, double h, size_t *count);
} hk_integrator;

/* The part of the forces that a method has set aside (hk_integrator.divide). */
typedef struct hk_aside {
  void *self;
  /* Takes the part's accelerations at x and v (n x 3) out of a, m/s^2. */
  void (*remove)(const void *self, const hk_system *, const double *x, const double *v, double *a);
  /* Takes its share out of the blocks of hk_system.stiffness_bound. */
  void (*remove_bound)(const void *self, const hk_system *, hk_stiffness_part part, double (*block)[6]);
} hk_aside;
/* What a method does with particles before and after an evaluation, while they are in the cache: see hk_system.pass.
 * Both get the particles begin to end - 1, from several threads at once. They must not read or write the x and v of
 * others. */
typedef struct hk_pass {
  void *context;
  void (*prepare)(void *context, size_t begin, size_t end); /* writes x and v; may read a; NULL: they are there */
  void (*finish)(void *context, size_t begin, size_t end);  /* a is complete, and no force reads x and v any more */
} hk_pass;

/* One of several steps that are taken at once: an evaluation as `pass` makes it. */
typedef struct hk_level {
  double t;
  double *x, *v, *a; /* n x 3 */
  hk_pass pass;
  double power; /* W, of pins and forces whose work is counted: the rate of the last entry of X; set by the host */
} hk_level;

enum { HK_LEVELS = 32 }; /* at most */

/* ---- The system ------------------------------------------------------------------------------------------------ */

/* Data of one force for methods that split the sum of forces. */
typedef struct hk_force_info {
  const char *label;
  unsigned flags; /* hk_force.flags */
  bool jacobian, elements;
  bool gradient; /* whether the force is the gradient of its energy, with no other part */
} hk_force_info;

/* X = (x, v, y): x is n x 3, v is n x 3 at X + 3n, y follows: the channels, and last the work done on the scene by pins
 * and non-conservative forces (J), which is integrated like a channel so that the energy balance has the method's
 * order. Every evaluation first imposes the pins of time t on the x and v it is given. */
struct hk_system {
  const hk_host *host; /* the integrator's own */
  const hk_model *model;
  double t;       /* s, the time of X */
  double *X;      /* size doubles */
  size_t n, size; /* size = 6n + number of y, the latter at least 1 */
  unsigned flags; /* HK_DEPENDS_ON_... of all forces together */
  double tol;     /* relative tolerance asked for (adaptive methods), > 0 */
  /* a = dv/dt (n x 3, m/s^2) with pins and constraint forces, and dy = dy/dt. x and v: n x 3. */
  hk_status (*accelerations)(hk_system *, double t, double *x, double *v, const double *y, double *a, double *dy);
  hk_status (*rates)(hk_system *, double t, double *X, double *dX); /* the whole f(X, t) */
  hk_status (*energy)(hk_system *, double t, const double *X, double *kinetic, double *potential);
  void (*impose)(hk_system *, double t, double *x, double *v); /* imposes the pins of time t on x and v */
  void (*filter)(hk_system *, double *vector);                 /* n x 3: zeroes the directions that pins forbid */
  /* K = -dF/dx, D = -dF/dv at (t, x, v), 3x3 blocks with one common pattern that holds the whole diagonal; not
   * filtered, without masses. `want`: HK_WANT_...; K->symmetric says whether the blocks are symmetric. Valid until the
   * next call. */
  hk_status (*jacobian)(hk_system *, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D);
  /* Factorizes A, as `combine` made it, by the scene's solver. In a scene with constraints, b is a force and x
   * satisfies J x = J M^-1 b beside A x + J^T lambda = b, J being that of the last evaluation. The host calls `analyze`
   * when the pattern (row_start, column) has changed. */
  hk_status (*factorize)(hk_system *, const hk_matrix *A);
  hk_status (*solve)(hk_system *, const double *b, double *x, hk_solve_info *info);
  /* A = m M + d D + k K of the last `jacobian`, with the pins: A = S (m M + d D + k K) S + s (I - S), where S is
   * `filter` and s a number of the size of the diagonal, so that the solution for a filtered right-hand side satisfies
   * the pins (up to rounding on slides: filter it). Valid until the next call. */
  hk_status (*combine)(hk_system *, double m, double d, double k, hk_matrix *A);
  /* The flags HK_SOLVES_... of the scene's solver, which is already chosen: the direct one for symmetric matrices,
   * unless a force has an unsymmetric Jacobian only, or the scene is very large. With constraints: one for indefinite
   * matrices. */
  hk_status (*solver_flags)(hk_system *, unsigned *flags);
  hk_status (*solve_columns)(hk_system *, const double *b, double *x, size_t columns); /* as hk_solver's */
  /* The forces in the scene's order, and which of them evaluations, energies and Jacobians include. All are included
   * when a step begins; a method that splits the sum sets `takes` before its calls. */
  size_t forces;
  const hk_force_info *force;
  bool *takes;
  bool takes_channels; /* whether evaluations include the channels' own rates */
  size_t equations;    /* number of constraint equations that acted in the last evaluation */
  /* Whether a force has `update` or `step_limit`: methods then call the next two functions before every move. */
  bool contact;
  /* Calls hk_force.update of all acting forces, from X to the positions x_to (n x 3); before a line search. K, D, A and
   * the factors remain valid; the next `jacobian` has the new pattern. */
  hk_status (*update)(hk_system *, double t, const double *X, const double *x_to);
  /* The minimum over all acting forces, in (0, 1], for the displacement dx (n x 3); to be called after `update`. */
  double (*step_limit)(hk_system *, double t, const double *X, const double *dx);
  /* The potential energy in J at time t of the included forces that have an energy, also of those with timed
   * parameters. */
  hk_status (*potential)(hk_system *, double t, const double *X, double *joule);
  /* dF = (dF/dx) dx + (dF/dv) dv of the included forces (n x 3), by a force's `product` or else by its blocks; K and D
   * of the last `jacobian` are then invalid. */
  hk_status (*product)(hk_system *, double t, const double *X, const double *dx, const double *dv, double *dF);
  /* block[i] as in hk_force.stiffness_bound, summed over the acting forces that state one. `stiffening`: of those with
   * HK_STIFFENS only. False: an acting force that depends on x states no bound, and the blocks are not
   * touched; of HK_DAMPING_WHOLE: one that depends on v states none, and the blocks are those of the others. */
  bool (*stiffness_bound)(hk_system *, hk_stiffness_part part, bool stiffening, double (*block)[6]);
  /* As `solve`, with J x = J u (u: n x 3): for methods whose right-hand side is not a residual of forces. */
  hk_status (*solve_along)(hk_system *, const double *b, const double *u, double *x, hk_solve_info *info);
  /* Brings x and v (n x 3) onto the constraints of time t, as the host does after every step; for methods that keep a
   * history of their own. One-sided ones are left to the host. */
  hk_status (*project)(hk_system *, double t, double *x, double *v);
  /* Where every particle stands alone: F (n x 3, or NULL) and the blocks K and D of the particles begin to end - 1 at x
   * and v (n x 3), with the time's parameters as `impose` left them; K[0] is that of `begin`. False: a force couples
   * particles, has no blocks, or fails, or there are constraints. */
  bool (*alone)(hk_system *, const double *x, const double *v, size_t begin, size_t end, double *F, double (*K)[9],
                double (*D)[9]);
  /* For methods that keep constraints in their own steps (HK_KEEPS_CONSTRAINTS). */
  bool holonomic;         /* there are constraints, all of them equalities */
  bool takes_constraints; /* whether accelerations include constraint forces; true when a step begins */
  /* Brings x onto g(x, t) = 0 by x += W J^T l, with J at (`from`, s->t), the start of the step of length h, and
   * v += W J^T l / h. HK_NOT_CONVERGED: the step is too long; x and v have changed. `from` is n x 3 with its velocities
   * behind it, as in X. The work of what moves with time is added to *work, J. */
  hk_status (*hold_positions)(hk_system *, double t, double *from, double h, double *x, double *v, double *work);
  /* Brings v onto J v + g_t = 0 by v += W J^T l, with J at (x, t); l is an impulse of half a step. */
  hk_status (*hold_velocities)(hk_system *, double t, double *x, double h, double *v, double *work);
  /* Removes from velocities (n x 3) the part that constraints forbid at X, v -= W J^T (J W J^T)^-1 J v. NULL: there are
   * none that could. */
  hk_status (*tangent)(hk_system *, double *vector);
  /* Set by the method in `divide`, and valid as long as the method; NULL: nothing is set aside. */
  const hk_aside *aside;
  /* Given to the forces with `jacobian` (hk_blocks); a method that sets them sets them to NULL again after it. */
  const double *linearised, *reached;
  /* `accelerations`, with what the method does before and after: block by block in one pass over the particles where
   * the forces offer parts (core/plugin/parts.h), else in passes on all threads. y is complete when it is called. If it
   * fails, a is void, and some particles may not have been prepared or finished. */
  hk_status (*pass)(hk_system *, double t, double *x, double *v, const double *y, double *a, double *dy,
                    const hk_pass *);
  /* For methods with HK_USES_SPARE: size doubles that a method may use within a step. Exchanged with X by `exchange`
   * when they are the new state, so that nothing is copied and X is as it was if the step fails. */
  double *spare;
  void (*exchange)(hk_system *);
  /* For `march`: the evaluations of `count` levels, at most HK_LEVELS, as if they were made by `pass` one after
   * another. Block by block level k prepares what level k - 1 has finished. If it fails, all are void. */
  hk_status (*wave)(hk_system *, hk_level *level, size_t count);
};

#endif
