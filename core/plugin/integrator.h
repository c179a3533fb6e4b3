/* Integrators, and the system dX/dt = f(X, t) as they see it. */
#ifndef HK_PLUGIN_INTEGRATOR_H
#define HK_PLUGIN_INTEGRATOR_H

#include "core/plugin/model.h"

typedef struct hk_system hk_system;
struct hk_fused;
struct hk_tile_step;

enum { /* hk_integrator.flags */
       HK_IMPLICIT = 1,
       HK_ADAPTIVE = 2,
       HK_SYMPLECTIC = 4,
       HK_NEEDS_JACOBIAN = 8,
       HK_REVERSIBLE = 16,    /* a run with reversed velocities returns to the start */
       HK_NEEDS_SOLVER = 32,  /* solves linear systems; HK_NEEDS_JACOBIAN implies it */
       HK_SPLITS_FORCES = 64, /* evaluates parts of the sum of forces: not possible with one-sided constraints, whose
                                 acting equations depend on the whole sum */
       HK_LIMITS_MOVES = 128, /* moves within hk_contact_table.step_limit; the host checks the steps of other methods,
                                 on the straight line, and halves those that are not safe */
       HK_USES_SPARE = 512    /* uses hk_system.spare */
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
  const void *method; /* constant data, a table of coefficients, say: given to every function that takes a `method` */
  /* Advances s->X from s->t by one step, h or shorter, never beyond t_stop; fixed-step methods take h exactly. The host
   * moves s->t. After HK_NOT_CONVERGED s->X must be unchanged, since the host may try a smaller step; after any other
   * failure the run ends. */
  hk_status (*step)(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out);
  void (*reset)(void *self, hk_reason why); /* history and cached forces are invalid; NULL: the method keeps none */
  /* Largest growth factor (spectral radius) of one step on z'' = -(g + i b) z' - w^2 z for complex z, as a function of
   * hw = h w, hg = h g and hb = h b, with the parameters of `self`: an oscillator, damped at the rate g, whose velocity
   * a field turns at the rate b of either sign, as v x B and Coriolis do. NAN where hb is not 0: not stated; where
   * velocities turn, an explicit method's largest stable step is then not known, and its step is chosen for accuracy.
   * On y' = -k y, a channel, it is growth(0, h k, 0) (never below 1: x'' = -g x' keeps a constant). NULL: not stated.
   */
  double (*growth)(const void *self, const void *method, double hw, double hg, double hb);
  const hk_facet *facets; /* core/plugin/facets: tile, split, constrained, adaptive, stages; NULL: none */
} hk_integrator;

/* X = (x, v, y): x is n x 3, v is n x 3 at X + 3n, y follows: the channels, and last the work done on the scene by pins
 * and non-conservative forces (J), which is integrated like a channel so that the energy balance has the method's
 * order. Every evaluation first imposes the pins of time t on the x and v it is given. */
struct hk_system {
  const hk_host *host; /* the integrator's own */
  const hk_model *model;
  double t;       /* s, the time of X */
  double *X;      /* size doubles */
  size_t n, size; /* size = 6n + number of y, the latter at least 1 */
  double tol;     /* relative tolerance asked for (adaptive methods), > 0 */
  /* a = dv/dt (n x 3, m/s^2) with pins and constraint forces, and dy = dy/dt. x and v: n x 3. */
  hk_status (*accelerations)(hk_system *, double t, double *x, double *v, const double *y, double *a, double *dy);
  hk_status (*rates)(hk_system *, double t, double *X, double *dX); /* the whole f(X, t) */
  void (*impose)(hk_system *, double t, double *x, double *v);      /* imposes the pins of time t on x and v */
  void (*filter)(hk_system *, double *vector);                      /* n x 3: zeroes the directions that pins forbid */
  /* For methods with HK_USES_SPARE: size doubles that a method may use within a step. Exchanged with X by `exchange`
   * when they are the new state, so that nothing is copied and X is as it was if the step fails. */
  double *spare;
  void (*exchange)(hk_system *);
  /* `accelerations`, and several steps, fused with what the method does before and after (facets/tile.h). */
  hk_status (*fused)(hk_system *, double t, double *x, double *v, const double *y, double *a, double *dy,
                     const struct hk_fused *);
  hk_status (*tile)(hk_system *, struct hk_tile_step *step, size_t count);
  struct hk_linear_table *linear;          /* facets/linear.h; for methods with HK_NEEDS_JACOBIAN or HK_NEEDS_SOLVER */
  struct hk_constraint_table *constraint;  /* facets/constrained.h; NULL: the scene has no constraints */
  const struct hk_contact_table *contact;  /* facets/moves.h; NULL: no force of the scene has contact */
  struct hk_split_table *split;            /* facets/split.h; never NULL */
  const struct hk_system_queries *queries; /* the engine's own, not for methods */
};

#endif
