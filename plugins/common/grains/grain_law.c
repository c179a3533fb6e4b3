/* The damping that gives a coefficient of restitution: e falls from 1 to 0 as z rises, so it is found by bisection. */
#include "plugins/common/grains/grain_law.h"

static const double nearly_one = 1e-6; /* where 1 - z^2 is less, the limit of the quotient is exact to rounding */

/* 2 acos(z)/sqrt(1 - z^2), continued above 1. */
double hk_grain_duration(double z) {
  if (fabs(1 - z) < nearly_one) return 2 * (1 - (z - 1) / 3);
  return z < 1 ? 2 * acos(z) / sqrt(1 - z * z) : 2 * acosh(z) / sqrt(z * z - 1);
}

static double restitution_of(double z) { return exp(-z * hk_grain_duration(z)); }

double hk_grain_damping(double restitution) {
  double low = 0, high = 1;
  if (restitution >= 1) return 0;
  while (restitution_of(high) > restitution) high *= 2;
  for (int k = 0; k < 100; k++) { /* more than a double has bits */
    double middle = (low + high) / 2;
    if (restitution_of(middle) > restitution)
      low = middle;
    else
      high = middle;
  }
  return high;
}

double hk_grain_collision(const hk_grain_law *law, double mass) {
  double along = hk_grain_duration(law->damping) / sqrt(law->stiffness / mass);
  if (!(law->friction > 0 && law->tangential > 0)) return along;
  return fmin(along, M_PI / sqrt(law->yielding * law->tangential / mass));
}

hk_grain_bound hk_grain_stiffness(const hk_grain_law *law, hk_stiffness_part part, double mass) {
  double k = law->stiffness, across = law->friction > 0 ? law->tangential : 0, q = law->yielding;
  if (part != HK_DAMPING_WHOLE) return (hk_grain_bound){k, q * across};
  /* What slips is pushed across by mu times the dashpot along: u.D u has mu c u_n u_t <= mu c (u_n^2 + u_t^2)/2. */
  double c = 2 * law->damping * sqrt(k * mass), coupling = law->friction * c / 2;
  return (hk_grain_bound){c + coupling, fmax(q * 2 * law->damping * sqrt(across * mass / q), coupling)};
}
