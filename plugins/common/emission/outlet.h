/* Where an emitter emits its particles, and which way they leave. */
#ifndef HK_EMISSION_OUTLET_H
#define HK_EMISSION_OUTLET_H

#include "core/plugin.h"
#include "plugins/common/emission/draw.h"

typedef enum hk_outlet_shape {
  HK_OUTLET_POINT,
  HK_OUTLET_LINE,
  HK_OUTLET_DISC,
  HK_OUTLET_SPHERE,
  HK_OUTLET_BALL,
  HK_OUTLET_TRIANGLES
} hk_outlet_shape;

typedef enum hk_outlet_places { HK_OUTLET_RANDOM, HK_OUTLET_EVEN } hk_outlet_places;

typedef struct hk_outlet {
  int shape;          /* hk_outlet_shape */
  int places;         /* hk_outlet_places */
  double position[3]; /* m, the point, one end of the line, the centre */
  double end[3];      /* m, the other end of the line */
  double radius;      /* m, of disc, sphere and ball */
  double direction[3];
  double cone; /* degrees, the largest angle about the direction */
  hk_tuples triangles;
  double *area; /* of the triangles up to each one, m^2; NULL without triangles */
  size_t areas;
} hk_outlet;

/* Makes `direction` a unit vector and adds up the areas. */
hk_status hk_outlet_open(hk_outlet *, const hk_host *, const hk_view *);
/* To be called after births and deaths: triangles may have died. */
void hk_outlet_topology(hk_outlet *, const hk_view *);
void hk_outlet_close(hk_outlet *, const hk_host *);

/* The place of a birth `age` s before the time of `view`, the velocity of that place (of a triangle), and the direction
 * in which the particle leaves. Always draws five numbers. With even places that of birth k, of those at the rate or of
 * those in bursts, is the k-th of Kronecker's sequence {1/2 + k/f}, {1/2 + k/f^2}, ... with f^(d+1) = f + 1 in d
 * dimensions (Niederreiter 1992, Random number generation and quasi-Monte Carlo methods, section 3.2, for any
 * irrationals; these by Roberts 2018, The unreasonable effectiveness of quasirandom sequences): any stretch of a jet of
 * constant rate then has nearly the same number of particles, where random ones differ by the root of it. */
void hk_outlet_draw(const hk_outlet *, const hk_view *view, double age, uint64_t k, hk_draw *, double position[3],
                    double velocity[3], double direction[3]);

#endif
