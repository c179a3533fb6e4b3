/* Explicit Runge-Kutta methods with embedded estimates of their error, which choose their steps. The last stage of the
 * tableau is f at the end of the step, and the first one of the next step.
 *
 * A step is accepted when its error (step_control.h) is at most `tol`. The length of the next step is computed from the
 * last two errors, and where a force jumps that finds all at rest, by step_control.h (Hairer, Norsett and Wanner,
 * Solving ODEs I, II.4; Hairer and Wanner II, IV.2). */
#ifndef HK_EMBEDDED_H
#define HK_EMBEDDED_H

#include "plugins/common/integrate/runge_kutta.h"
#include "plugins/common/integrate/step_control.h"

/* hk_integrator.method. The error estimate is h times the sum of weights and slopes. With a second one the error is
 * e^2/sqrt(e^2 + e'^2/100) of the two, Hairer, Norsett and Wanner's (10.17) in II.10. */
typedef struct hk_embedded {
  const hk_tableau *tableau;
  double weight[HK_RK_STAGES], second[HK_RK_STAGES];
  bool has_second;
  double order;               /* the error goes with h^order */
  double safety, least, most; /* of the factor by which h changes */
  double beta;                /* exponent of the PI control */
} hk_embedded;

typedef struct hk_embedded_state { /* an instance */
  int64_t primed;                  /* whether `first` is the slope at X */
  int64_t started;                 /* whether a step has been taken */
  int64_t wait;                    /* after a jump of a force (step_control.h) */
  double proposal;                 /* s, proposed length of the next step */
  double last_error;               /* error of the last step, for the PI control */
  hk_scales scales;
  double *first; /* slope at X */
  double *k;     /* slopes, then the state of a stage */
  double *error; /* shaped as X */
} hk_embedded_state;

/* The fields of an instance. */
#define HK_EMBEDDED_FIELDS(stages)                                                                                     \
  {                                                                                                                    \
    {"primed", .integer = HK_AT(hk_embedded_state, primed)},                                                           \
        {"started", .integer = HK_AT(hk_embedded_state, started)},                                                     \
        {"wait", .integer = HK_AT(hk_embedded_state, wait)},                                                           \
        {"proposal", .number = HK_AT(hk_embedded_state, proposal)},                                                    \
        {"last_error", .number = HK_AT(hk_embedded_state, last_error)},                                                \
        {"speed", .number = HK_AT(hk_embedded_state, scales.speed)},                                                   \
        {"acceleration", .number = HK_AT(hk_embedded_state, scales.acceleration)},                                     \
        {"first", .state = HK_AT(hk_embedded_state, first), .width = 1},                                               \
        {"stages", .state = HK_AT(hk_embedded_state, k), .width = (stages) + 1, .flags = HK_SCRATCH},                  \
        {"error", .state = HK_AT(hk_embedded_state, error), .width = 1, .flags = HK_SCRATCH}, {                        \
      0                                                                                                                \
    }                                                                                                                  \
  }

hk_status hk_embedded_step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out);
void hk_embedded_reset(void *self, hk_reason why);
double hk_embedded_growth(const void *self, const void *method, double hw, double hg, double hb);

#endif
