/* How fast a linear recurrence grows: the largest root of a small polynomial. */
#ifndef HK_GROWTH_FACTOR_H
#define HK_GROWTH_FACTOR_H

enum { HK_GROWTH_FACTOR_MAX = 12 };

/* The largest |1 + u| over the roots u of sum c_k u^k, degree <= HK_GROWTH_FACTOR_MAX. Characteristic polynomials in
 * u = lambda - 1 keep what lies next to lambda = 1 apart, where those in lambda have double roots: the slow modes of a
 * scene come out to rounding. */
double hk_polynomial_growth(int degree, const double *c);

#endif
