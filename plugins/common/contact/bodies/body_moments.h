/* Rolling and spinning friction: moments on rigid bodies where they touch, at most a length times the normal impulse,
 * against their relative spin across the normal (rolling) and along it (spinning): Coulomb's law of 1785 for rollers,
 * and of a contact with the extent a, spinning = 2/3 mu a of even pressure (Johnson 1985, Contact mechanics, chapter
 * 8). Both sides get opposite moments, so that the angular momentum of two bodies is kept. */
#ifndef HK_BODY_MOMENTS_H
#define HK_BODY_MOMENTS_H

#include "core/plugin.h"
#include "plugins/common/contact/impulses/impact.h"

/* One side of an impact. */
typedef struct hk_body_moment_side {
  const uint32_t *carrier; /* 4 of a rigid body; NULL: it is none */
  double weight[3][4];     /* of a couple's forces for each axis the parts on the carriers, 1/m, with the sum 0 */
} hk_body_moment_side;

/* Of one impact. */
typedef struct hk_body_moments {
  hk_body_moment_side side[2]; /* moments are on the first, and opposite ones on the second */
  double rolling, spinning;    /* m */
  double way[3];               /* rad, how far the first has turned since the impact against the second */
  double rest[3];              /* rad/s, the spin of a side that is no body, as part of the second's */
  double moment[2][3];         /* of places and of speeds, along the axes; kg m^2, N m s */
  double axis[3][3];           /* across n, twice, and n */
  double push[3][3];           /* the direction of a couple's forces, for each axis */
  double inverse_inertia[3];
} hk_body_moments;

static inline bool hk_body_moments_any(const hk_body_moments *m) { return m->side[0].carrier || m->side[1].carrier; }

/* Sets axes, directions and weights at x for the normal n. */
void hk_body_moments_set(hk_body_moments *, const double *x, const double n[3]);
/* The rates of turning about the axes by y, n x 3, less those by `from` (NULL: 0), and less `rest` or plus `way`. */
void hk_body_moments_rates(const hk_body_moments *, bool speeds, const double *y, const double *from, double out[3]);
/* The changes of the moments of a level that the rates and the normal impulse ask for; they are added. */
void hk_body_moments_solve(hk_body_moments *, bool speeds, const double rates[3], double push, double change[3]);

#endif
