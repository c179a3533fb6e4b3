/* Diagonally implicit Runge-Kutta methods from their tableaux: stages X_i = X + h sum a_ij k_j, k_i = f(t + c_i h,
 * X_i), each solved by newton.h. The slope k_i of an implicit stage is computed without an evaluation, as the change of
 * X by the stage's own term divided by h a_ii, which equals f there up to the algebraic error. A method whose first
 * stage is explicit uses the last slope of the step before (stiffly accurate methods end on their last stage). Hairer
 * and Wanner, Solving ODEs II, IV.6; Kennedy and Carpenter 2016, NASA/TM-2016-219173. */
#ifndef HK_DIRK_H
#define HK_DIRK_H

#include "plugins/common/implicit/newton.h"
#include "plugins/common/integrate/step_control.h"

enum { HK_DIRK_STAGES = 6, HK_DIRK_STATES = HK_DIRK_STAGES + 2 };

typedef struct hk_dirk_tableau {
  int stages;
  double c[HK_DIRK_STAGES];
  double a[HK_DIRK_STAGES][HK_DIRK_STAGES]; /* lower triangle; equal on the diagonal, or 0 in the first stage */
  double b[HK_DIRK_STAGES];                 /* equal to the last row of a: stiffly accurate */
  double error[HK_DIRK_STAGES];             /* b minus the weights of the embedded method */
  int error_order;                          /* the estimate is O(h^(error_order + 1)) */
} hk_dirk_tableau;

extern const hk_dirk_tableau hk_tr_bdf2;
extern const hk_stages_facet hk_tr_bdf2_stages; /* the same, of methods that begin with a step of it */
extern const hk_param hk_dirk_params[], hk_dirk_adaptive_params[]; /* of instances that are, or begin with, hk_dirk */
extern const hk_field hk_dirk_fields[];

typedef struct hk_dirk {
  hk_newton newton;
  /* fields */
  int64_t primed, started, wait; /* wait: after a jump of a force (step_control.h) */
  double proposal, last_error;
  hk_scales scales;
  double *slope; /* saved, a field `state`: slope of the last stage of the last step */
  double *k;     /* scratch, HK_DIRK_STATES states: slopes, then x*, v*, y* and X of a stage */
} hk_dirk;

/* Computes a step of h from s->X into the returned X, which is scratch memory; s->X changes by its pins only. `limit`:
 * m/s, algebraic error allowed in v; below 0: as for a fixed step. The tableau's `error` is not used. */
hk_status hk_dirk_stages(hk_dirk *, const hk_dirk_tableau *, hk_system *s, double h, double limit, double **X_new);

/* ---- Members of an hk_integrator whose instance is an hk_dirk, or begins with one, and whose `method` an
 * hk_dirk_tableau ---- */

/* A step of h. */
hk_status hk_dirk_step(void *self, const void *tableau, hk_system *s, double t_stop, double h, hk_step *out);
/* A step chosen so that its error meets s->tol. */
hk_status hk_dirk_adaptive_step(void *self, const void *tableau, hk_system *s, double t_stop, double h, hk_step *out);
void hk_dirk_reset(void *self, hk_reason why);
/* The larger |R(z)| for the two eigenvalues z of h times the oscillator's matrix. */
double hk_dirk_growth(const void *self, const void *tableau, double hw, double hg, double hb);

#endif
