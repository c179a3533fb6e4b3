/* Methods in scenes with constraints. */
#ifndef HK_PLUGIN_CONSTRAINED_H
#define HK_PLUGIN_CONSTRAINED_H

#include "core/plugin/integrator.h"

/* hk_system.constraint */
typedef struct hk_constraint_table {
  size_t equations;       /* number of constraint equations that acted in the last evaluation */
  bool holonomic;         /* there are equations, and in this step all that act are equalities */
  bool takes_constraints; /* whether accelerations include constraint forces; true when a step begins */
  /* Brings x and v (n x 3) onto the constraints of time t, as the host does after every step; for methods that keep a
   * history of their own. One-sided ones are left to the host. */
  hk_status (*project)(hk_system *, double t, double *x, double *v);
  /* Brings x onto g(x, t) = 0 by x += W J^T l, with J at (`from`, s->t), the start of the step of length h, and
   * v += W J^T l / h. HK_NOT_CONVERGED: the step is too long; x and v have changed. `from` is n x 3 with its velocities
   * behind it, as in X. The work of what moves with time is added to *work, J. */
  hk_status (*shake)(hk_system *, double t, double *from, double h, double *x, double *v, double *work);
  /* Brings v onto J v + g_t = 0 by v += W J^T l, with J at (x, t); l is an impulse of half a step. */
  hk_status (*rattle)(hk_system *, double t, double *x, double h, double *v, double *work);
  /* As `shake`, of a part of a step, which starts from `from` at the time t_from, and whose h is of either sign. */
  hk_status (*shake_from)(hk_system *, double t_from, double *from, double t, double h, double *x, double *v,
                          double *work);
} hk_constraint_table;

/* The number of equations that acted in the last evaluation. */
static inline size_t hk_system_equations(const hk_system *s) { return s->constraint ? s->constraint->equations : 0; }

#define HK_CONSTRAINED_ID "constrained/1"

typedef struct hk_constrained_facet {
  size_t size;
  const char *refused; /* one sentence that says why the method cannot be used with constraints; NULL: it can */
  bool keeps; /* in a step that is holonomic it ends on g = 0 and J v + g_t = 0, by `shake` and `rattle`; the host does
                 not project it where no equation is one-sided */
} hk_constrained_facet;

#endif
