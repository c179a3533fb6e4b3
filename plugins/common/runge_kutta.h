/* Explicit Runge-Kutta methods from their tableaux. */
#ifndef HK_RUNGE_KUTTA_H
#define HK_RUNGE_KUTTA_H

#include "core/plugin.h"

enum { HK_RK_STAGES = 7 };

typedef struct hk_tableau {
  int stages;
  double c[HK_RK_STAGES];
  double a[HK_RK_STAGES][HK_RK_STAGES]; /* strictly lower */
  double b[HK_RK_STAGES];
} hk_tableau;

extern const hk_tableau hk_dormand_prince; /* order 5; the seventh stage is f at the end (FSAL) */

/* One step of h from s->t: X_new = X + h sum b_i k_i. `k` has room for `stages` vectors and one more for the stages'
 * states; stages from `first` on are evaluated, earlier ones are taken from k. X is not touched (but for pins). */
hk_status hk_rk_stages(const hk_tableau *, hk_system *s, double h, double *k, int first);
void hk_rk_advance(const hk_tableau *, const hk_system *s, double h, const double *k, double *X);
/* |R(z)| for the two eigenvalues z of h times the oscillator's matrix, the larger. */
double hk_rk_amplification(const hk_tableau *, double hw, double hg);

#endif
