/* Explicit Runge-Kutta methods from their tableaux, in Nystroem's form: as dx/dt = v, a stage's slope of x follows from
 * the accelerations of earlier stages, so only (a, dy) of a stage is stored and every sum over stages is one pass. Up
 * to rounding this is the Runge-Kutta method applied to the whole X. */
#ifndef HK_RUNGE_KUTTA_H
#define HK_RUNGE_KUTTA_H

#include "core/plugin.h"

enum { HK_RK_STAGES = 13 };

typedef struct hk_tableau {
  int stages;
  double c[HK_RK_STAGES];
  double a[HK_RK_STAGES][HK_RK_STAGES]; /* strictly lower triangular; c holds the row sums */
  double b[HK_RK_STAGES];
} hk_tableau;

extern const hk_tableau hk_dormand_prince; /* order 5; the seventh stage is f at the end (FSAL) */

/* The i-th slope: a (n x 3), then dy; the next slope follows it. `k` is a field of a field `state` of width stages + 1,
 * which holds all slopes and, last, the state of the stage evaluated latest, shaped as X. */
double *hk_rk_slope(const hk_system *, double *k, int i);
double *hk_rk_stage_state(const hk_tableau *, const hk_system *, double *k);

/* Evaluates the stages from `first` on; the slopes of earlier ones are read from k. s->X changes by its pins only. */
hk_status hk_rk_stages(const hk_tableau *, hk_system *s, double h, double *k, int first);
/* into = X + h sum weight_i (slope i) over `count` stages; into may be X. The weights have the sum `total`. */
void hk_rk_combine(const hk_tableau *, const hk_system *s, double h, double *k, const double *weight, int count,
                   double total, const double *X, double *into);
/* ---- A method that is a tableau and no more: hk_integrator.method is its hk_tableau, with HK_USES_SPARE ---- */

typedef struct hk_runge_kutta {
  double *k; /* see hk_rk_slope */
} hk_runge_kutta;

/* The fields of an instance of hk_runge_kutta. */
#define HK_RK_FIELDS(stages)                                                                                           \
  {                                                                                                                    \
    {"stages", .state = HK_AT(hk_runge_kutta, k), .width = (stages) + 1, .flags = HK_SCRATCH}, { 0 }                   \
  }

/* hk_integrator.step: s->X changes only after all stages have succeeded. */
hk_status hk_rk_step(void *self, const void *tableau, hk_system *s, double t_stop, double h, hk_step *out);
/* hk_integrator.growth: the larger |R(z)| for the two eigenvalues z of h times the oscillator's matrix. */
double hk_rk_growth(const void *self, const void *tableau, double hw, double hg, double hb);

#endif
