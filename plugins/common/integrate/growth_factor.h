/* The growth factor of a linear recurrence: the largest modulus of the roots of its characteristic polynomial. */
#ifndef HK_GROWTH_FACTOR_H
#define HK_GROWTH_FACTOR_H

enum { HK_GROWTH_FACTOR_MAX = 12 };

/* The largest |1 + u| over the roots u of sum c_k u^k, degree <= HK_GROWTH_FACTOR_MAX. In u = lambda - 1 roots next to
 * lambda = 1 remain distinct, where a polynomial in lambda has a double root up to rounding: so the growth factor of
 * the slow modes of a scene is accurate to rounding. */
double hk_polynomial_growth(int degree, const double *c);

/* The same for complex coefficients, which the recurrence of a rotating oscillator has (hk_integrator.rotation). */
double hk_complex_polynomial_growth(int degree, const double _Complex *c);

/* One step of backward differences of order 2, X' = 4/3 X - 1/3 X_before + 2/3 h f(X'), on x'' = -w^2 x - g x'. With
 * u = lambda - 1 the recurrence (3 lambda^2 - 4 lambda + 1)/2 = z lambda^2, for x and v together, becomes
 * (u + 3/2 u^2)^2 + h g (u + 3/2 u^2) (1 + u)^2 + (h w)^2 (1 + u)^4 = 0. */
double hk_bdf2_growth(double hw, double hg);

/* The roots z of z^2 + d z + hw^2 = 0: h times the rates of x'' = -w^2 x - (d/h) x'. The first has the larger modulus.
 */
void hk_oscillator_roots(double hw, double _Complex d, double _Complex root[2]);

#endif
