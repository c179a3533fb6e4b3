/* Anisotropic kernels of particles (Yu and Turk 2013, ACM Trans. Graphics 32, article 5): their centres, drawn towards
 * the mean of their neighbours (equation 6), and their axes, by the weighted covariance of the neighbours' places
 * (equations 9 to 16): where a liquid ends a kernel is flat along its surface.
 *
 * Weights are w = 1 - (d/reach)^3 of the neighbours within reach. The covariance C is taken in units of that of a full
 * liquid, 0.15 reach^2 in each direction (the integral of w d_c^2 over that of w), in which the paper's k_s is 1; its
 * eigenvalues s1 >= s2 >= s3 are the kernel's axes in parts of reach, of which none is below s1 / k_r, and s1 not below
 * k_n. A particle with N_eps neighbours or fewer has a ball of k_n reach.
 *
 * Means lie within the liquid, by 0.4 spacings along a face, and would make it smaller. What all neighbours move by is
 * put back, the step of Vollmer, Mencl and Mueller 1999 (Computer Graphics Forum 18, section 4, with alpha = beta = 0):
 * with m the way from a particle to the mean, its centre is x + lambda (m - sum w m / sum w). What differs from one
 * particle to the next is smoothed as before. */
#ifndef HK_PARTICLE_KERNELS_H
#define HK_PARTICLE_KERNELS_H

#include "plugins/common/particle_surface/particle_field.h"

typedef struct hk_particle_kernels { /* a zeroed one is empty; memory is the host's */
  double (*centre)[3];               /* n x 3, m */
  hk_particle_kernel *kernel;        /* n */
} hk_particle_kernels;

/* Options that are complete. HK_BAD_PARAM, HK_NOT_FINITE, HK_NO_MEMORY as hk_particle_field_open; to be freed also
 * after a failure. */
hk_status hk_particle_kernels_make(hk_particle_kernels *, const hk_host *, const double (*x)[3], size_t n,
                                   const hk_particle_surface_options *);
void hk_particle_kernels_free(hk_particle_kernels *, const hk_host *);

#endif
