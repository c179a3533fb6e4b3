/* Spectral radius of a small matrix. */
#ifndef HK_SPECTRAL_H
#define HK_SPECTRAL_H

enum { HK_SPECTRAL_MAX = 10 };

/* Of the n x n matrix M (row-major, n <= HK_SPECTRAL_MAX), to a relative error of about 1e-7. */
double hk_spectral_radius(int n, const double *M);

#endif
