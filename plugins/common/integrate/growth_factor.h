/* The growth factor of a linear recurrence: the largest modulus of the roots of its characteristic polynomial. */
#ifndef HK_GROWTH_FACTOR_H
#define HK_GROWTH_FACTOR_H

enum { HK_GROWTH_FACTOR_MAX = 12 };

/* The largest |1 + u| over the roots u of sum c_k u^k, degree <= HK_GROWTH_FACTOR_MAX. In u = lambda - 1 roots next to
 * lambda = 1 remain distinct, where a polynomial in lambda has a double root up to rounding: so the growth factor of
 * the slow modes of a scene is accurate to rounding. */
double hk_polynomial_growth(int degree, const double *c);

#endif
