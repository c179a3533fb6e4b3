/* Particles as spheres: radii and angular velocities, from parameters and channels. */
#ifndef HK_SPHERES_H
#define HK_SPHERES_H

#include "plugins/common/grains/spins.h"

typedef struct hk_spheres {
  double radius;            /* m; NAN: from the channel */
  const char *radii, *spin; /* names of channels, or NULL */
  const hk_channel *radius_channel, *spin_channel;
  const hk_spins *spins; /* NULL: they do not turn */
  double number;         /* of this force among those that turn particles */
} hk_spheres;

/* In `create`: finds the channels, and joins those that turn particles. HK_BAD_PARAM: a channel is not there or of
 * another size, or no radius is given; HK_FAILED: there is no service spins/1. */
hk_status hk_spheres_open(hk_spheres *, const hk_view *view);
/* In `topology`: HK_BAD_PARAM as hk_spheres_check. */
hk_status hk_spheres_topology(const hk_spheres *, const hk_view *view);
typedef struct hk_radii {
  double smallest, largest; /* m; INFINITY and 0 where there are no particles */
} hk_radii;

hk_radii hk_spheres_measure(const hk_spheres *, const hk_view *view);
hk_status hk_spheres_check(const hk_spheres *, const hk_view *view); /* HK_BAD_PARAM: a radius is not positive */

static inline double hk_sphere_radius(const hk_spheres *s, const hk_view *view, size_t i) {
  return s->radius_channel ? view->y[s->radius_channel->offset * view->n + i] : s->radius;
}

/* dy += torque / inertia for the spins of the particles that the view's force acts on; torque: n x 3, N m. */
void hk_spheres_turn(const hk_spheres *, const hk_view *view, const double *torque, double *dy);
void hk_spheres_keep_spin(const hk_spheres *, const hk_view *view, double *spin); /* copies the spins, n x 3 */
/* kg, the least of the masses of two spheres together, m M/(m + M); with `fixed`, of one against a wall. INFINITY:
 * there are none. */
double hk_spheres_least_mass(const hk_view *view, bool fixed);
/* s, in which the fastest goes a quarter of the smallest radius, so that no contact is passed by unseen. */
double hk_spheres_longest_step(const hk_spheres *, const hk_view *view);

/* rad/s; NULL: spheres do not turn. */
static inline const double *hk_sphere_spin(const hk_spheres *s, const hk_view *view, size_t i) {
  return s->spin_channel ? view->y + s->spin_channel->offset * view->n + 3 * i : NULL;
}

/* kg m^2, of a solid sphere */
static inline double hk_sphere_inertia(const hk_spheres *s, const hk_view *view, size_t i) {
  double R = hk_sphere_radius(s, view, i);
  return 0.4 * view->model->mass[i] * R * R;
}

/* J, of the rotation of particle i; 0 where another force has it. */
static inline double hk_sphere_rotation(const hk_spheres *s, const hk_view *view, size_t i) {
  if (!s->spin_channel || s->spins->owner(s->spins->self)[i] != s->number) return 0;
  const double *w = hk_sphere_spin(s, view, i);
  return hk_sphere_inertia(s, view, i) / 2 * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
}

#endif
