/* Viscous stress by the rate of Green's strain: see viscosity.c. */
#ifndef HK_VISCOSITY_H
#define HK_VISCOSITY_H

typedef struct hk_viscosity {
  double mu, lambda; /* Pa s */
} hk_viscosity;

enum { HK_STRAIN_VALUES = 6 };

/* Resists stretching at a rate by `damping`, Pa s, as Young's modulus resists stretching, with Poisson's ratio nu. */
hk_viscosity hk_viscosity_of(double damping, double nu);

/* The stress P, Pa, for the rate of F, 1/s; returns P : dF/dt, the power lost per volume, W/m^3. */
double hk_viscosity_stress(hk_viscosity, const double F[9], const double rate[9], double P[9]);
/* Derivatives of P by F (`turning`: with the unsymmetric part; `definite`: 0) and by the rate of F, 9 x 9 each. */
void hk_viscosity_derivatives(hk_viscosity, const double F[9], const double rate[9], int turning, int definite,
                              double K[81], double D[81]);

/* The strain E = (F^T F - 1)/2 as six numbers, the sum of whose squares is |E|^2, and their derivatives, 6 x 9. */
void hk_strain_values(const double F[9], double C[6], double dC[54]);
/* tr E and its derivative. */
void hk_strain_trace(const double F[9], double *C, double dC[9]);

#endif
