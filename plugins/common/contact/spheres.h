/* Particles as spheres: radii and angular velocities, from parameters and channels. */
#ifndef HK_SPHERES_H
#define HK_SPHERES_H

#include "core/plugin.h"

typedef struct hk_spheres {
  double radius;            /* m; NAN: from the channel */
  const char *radii, *spin; /* names of channels, or NULL */
  const hk_channel *radius_channel, *spin_channel;
  double smallest, largest; /* m, when hk_spheres_measure was called last */
} hk_spheres;

/* Finds the channels. HK_BAD_PARAM: one is not there or of another size, or no radius is given. */
hk_status hk_spheres_open(hk_spheres *, const hk_view *view);
/* HK_BAD_PARAM: a radius is not positive. */
hk_status hk_spheres_measure(hk_spheres *, const hk_view *view);

static inline double hk_sphere_radius(const hk_spheres *s, const hk_view *view, size_t i) {
  return s->radius_channel ? view->y[s->radius_channel->offset * view->n + i] : s->radius;
}

/* rad/s; NULL: spheres do not turn. */
static inline const double *hk_sphere_spin(const hk_spheres *s, const hk_view *view, size_t i) {
  return s->spin_channel ? view->y + s->spin_channel->offset * view->n + 3 * i : NULL;
}

/* kg m^2, of a solid sphere */
static inline double hk_sphere_inertia(const hk_spheres *s, const hk_view *view, size_t i) {
  double R = hk_sphere_radius(s, view, i);
  return 0.4 * view->model->mass[i] * R * R;
}

#endif
