/* Numbers of particles at other places, such as the velocity of a vertex of their surface. */
#ifndef HK_PARTICLE_AVERAGE_H
#define HK_PARTICLE_AVERAGE_H

#include "plugins/common/particle_surface/particle_options.h"

typedef struct hk_particle_values {
  const double (*x)[3]; /* n x 3, m */
  size_t n;
  const double *value; /* n x width */
  size_t width;
} hk_particle_values;

/* to (count x width): at each place the average of the particles within the options' reach of it, weighted by
 * (1 - d^2/reach^2)^3; 0 where there is none. Places lie in the box of the particles and their reach, as vertices of
 * their surface do. HK_BAD_PARAM, HK_NOT_FINITE, HK_NO_MEMORY as hk_particle_surface_find. */
hk_status hk_particle_average(const hk_host *, const hk_particle_values *, const hk_particle_surface_options *,
                              const double (*place)[3], size_t count, double *to);

#endif
