/* The stable neo-Hookean material, as functions of the deformation gradient F (3 x 3, row-major): see neo_hookean.c. */
#ifndef HK_NEO_HOOKEAN_H
#define HK_NEO_HOOKEAN_H

typedef struct hk_neo_hookean {
  double mu, lambda; /* Pa, of the energy: not Lame's, which they follow from */
} hk_neo_hookean;

enum { HK_NEO_HOOKEAN_VALUES = 10 };

/* The material that is, for small strains, Hooke's law of Young's modulus E, Pa, and Poisson's ratio nu, 0 to < 0.5. */
hk_neo_hookean hk_neo_hookean_of(double E, double nu);

double hk_neo_hookean_energy(hk_neo_hookean, const double F[9]);               /* J/m^3; 0 at rest */
void hk_neo_hookean_stress(hk_neo_hookean, const double F[9], double P[9]);    /* P = dW/dF, Pa */
void hk_neo_hookean_hessian(hk_neo_hookean, const double F[9], double H[81]);  /* d^2 W/dF^2, Pa, row-major */
void hk_neo_hookean_definite(hk_neo_hookean, const double F[9], double H[81]); /* its part that is not negative */
/* An upper bound of the eigenvalues of H less those of lambda (dJ/dF)(dJ/dF)^T, Pa. */
double hk_neo_hookean_bound(hk_neo_hookean, const double F[9]);

/* W = mu/2 sum of C^2, up to a constant: C and its derivatives, 10 x 9. */
void hk_neo_hookean_values(hk_neo_hookean, const double F[9], double C[10], double dC[90]);

#endif
