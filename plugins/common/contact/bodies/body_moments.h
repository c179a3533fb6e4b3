/* Rolling and spinning friction: moments on a rigid body where it touches, at most a length times the normal impulse,
 * against its spin across the normal (rolling) and along it (spinning): Coulomb's law of 1785 for rollers, and of a
 * contact with the extent a, spinning = 2/3 mu a of even pressure (Johnson 1985, Contact mechanics, chapter 8). */
#ifndef HK_BODY_MOMENTS_H
#define HK_BODY_MOMENTS_H

#include "core/plugin.h"
#include "plugins/common/contact/impulses/impact.h"

/* Of one impact, of the first side's body against what is no body. */
typedef struct hk_body_moments {
  const uint32_t *carrier;  /* 4, NULL: there are none */
  double rolling, spinning; /* m */
  double way[3];            /* rad, how far it has turned since the impact against what it touches */
  double rest[3];           /* rad/s, the spin of that */
  double moment[2][3];      /* of places and of speeds, along the axes; kg m^2, N m s */
  double axis[3][3];        /* across n, twice, and n */
  double push[3][3];        /* the direction of a couple's forces, for each axis */
  double weight[3][4];      /* and of these the parts on the carriers, 1/m, with the sum 0 */
  double inverse_inertia[3];
} hk_body_moments;

/* Sets axes, directions and weights at x for the normal n. */
void hk_body_moments_set(hk_body_moments *, const double *x, const double n[3]);
/* The rates of turning about the axes by y, n x 3, less those by `from` (NULL: 0), and less `rest` or plus `way`. */
void hk_body_moments_rates(const hk_body_moments *, bool speeds, const double *y, const double *from, double out[3]);
/* The changes of the moments of a level that the rates and the normal impulse ask for; they are added. */
void hk_body_moments_solve(hk_body_moments *, bool speeds, const double rates[3], double push, double change[3]);

#endif
